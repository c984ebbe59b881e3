"""Ball in a shaken cavity: the flights of the case against the closed form, to all digits."""

from __future__ import annotations

import json
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

import vibeam
from tests.independent import cavity

CASE = Path(__file__).parents[2] / "cases" / "rigs" / "ball_in_cavity.toml"
BY_HAND = json.loads(Path(cavity.__file__).with_suffix(".json").read_text())


def settled(frequency: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Phases, relative speeds (m/s) and flights as shares of the period of the last impacts, by flight."""
    case = vibeam.load(CASE)
    drive = vibeam.Drive(2 * np.pi * frequency, 7.895683520871487 / (2 * np.pi * frequency) ** 2)
    path = vibeam.simulate(case.system("ball"), drive, 400 / frequency)
    times = path.impact_times[-5:]
    return np.mod(times * drive.omega, 2 * np.pi), np.abs(path.impact_velocities[-4:]), np.diff(times) * frequency


@pytest.mark.parametrize("frequency", [9, 10, 11])
def test_speeds_and_flights_are_those_by_hand(frequency: int) -> None:
    """Speeds to 1e-14 of round-off; flights are differences of times of 400 periods, so to 1e-12."""
    _, speeds, flights = settled(float(frequency))
    assert speeds == pytest.approx(BY_HAND[f"speed_{frequency}"], rel=1e-14)
    assert max(flights) == pytest.approx(BY_HAND[f"longer_flight_{frequency}"], rel=1e-12)


def test_the_published_phase_and_speed() -> None:
    """At d/B = 1.5 and R = 0.65 the phase is 1.90713687 and the speed 1.88591372 BΩ."""
    phases, speeds, _ = settled(10.0)
    assert min(phases) == pytest.approx(BY_HAND["phase_10"] + np.pi, rel=1e-11)
    assert round(BY_HAND["phase_10"] + np.pi, 8) == 1.90713687
    assert round(BY_HAND["relative_speed_10"], 8) == 1.88591372
    assert speeds / (0.002 * 20 * np.pi) == pytest.approx(BY_HAND["relative_speed_10"], rel=1e-14)


def test_symmetry_is_lost_where_the_closed_form_says() -> None:
    """Just above both flights are alike; just below they differ, by the square root of the distance."""
    lost = BY_HAND["symmetry_lost_Hz"]
    assert max(settled(lost * 1.01)[2]) == pytest.approx(0.5, abs=1e-9)
    near, far = (max(settled(lost * (1 - part))[2]) - 0.5 for part in (0.01, 0.04))
    assert far / near == pytest.approx(2.0, rel=0.05)


def test_the_stored_numbers_are_those_of_the_program() -> None:
    assert cavity.predicted() == BY_HAND
    mp.mp.dps = 30
    phase, speed = cavity.symmetric(cavity.symmetry_lost())
    q = mp.pi * mp.sin(phase) / speed
    assert abs(q + 1 + cavity.R) < 1e-15  # R is that of a case, 0.65 to 53 bits
