"""The Łódź group's rule: committed shares against orbits found one by one, each proved by the flight solver."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results" / "lodz_rule.json"
FOUND: dict[str, Any] = json.loads(RESULTS.read_text())


def stable_share(p: float, q: float, periods: int) -> float:
    """Share of a few two-mode systems with a stable, admissible motion with one impact in ``periods``."""
    has = []
    for share in (0.2, 1.0):
        for restitution in (0.5, 0.9):
            for same in (True, False):
                for gap in (0.0, 0.5):
                    has.append(stable(p, q, periods, share, restitution, same, gap))
    return float(np.mean(has))


def stable(p: float, q: float, periods: int, share: float, restitution: float, same: bool, gap: float) -> bool:
    angle = np.arctan(np.sqrt(share))
    contact = np.array([np.cos(angle), np.sin(angle)])
    load = contact if same else np.array([-np.sin(angle), np.cos(angle)])
    natural = np.array([1.0, p * q])
    swing = abs(np.sum(contact * load * p**2 / (natural**2 - p**2 + 2j * 0.05 * natural * p)))
    system = vibeam.ImpactSystem.from_modes(natural, 0.05, contact, load, gap=gap * swing, restitution=restitution)
    found = vibeam.orbits(system, vibeam.Drive(p, 1.0), periods)
    return any(orbit.stable and orbit.admissible for orbit in found)


def committed(p: float, q: float, periods: int) -> float:
    ratios = FOUND["ratios"]
    return float(FOUND[f"one_impact_in_{periods}"][ratios.index(p)][ratios.index(q)])


def test_no_motion_with_one_impact_a_period_at_four_times_the_first_frequency() -> None:
    assert [stable_share(4.0, q, 1) for q in (2.0, 3.0, 4.5)] == [0.0] * 3
    assert all(share == 0.0 for share in FOUND["one_impact_in_1"][FOUND["ratios"].index(4.0)])
    assert min(stable_share(4.0, q, 2) for q in (2.0, 4.5)) > 0.2


@pytest.mark.parametrize("even", [2.0, 4.0])
def test_a_second_frequency_between_two_harmonics_is_better_than_on_one(even: float) -> None:
    assert stable_share(2.0, even + 0.5, 1) > stable_share(2.0, even, 1) + 0.2
    assert committed(2.0, even + 0.5, 1) > committed(2.0, even, 1) + 0.2


def test_even_multiples_are_no_better_than_odd_ones() -> None:
    for periods, p in ((1, 2.0), (2, 4.0)):
        assert max(committed(p, q, periods) for q in (3.0, 5.0)) > committed(p, 4.0, periods) - 0.01
    assert abs(stable_share(2.0, 4.0, 1) - stable_share(2.0, 5.0, 1)) < 0.15
