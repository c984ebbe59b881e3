"""Stability maps by shooting, against the closed forms of the same system."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.maps.models import MOST, usual_points
from vibeam.maps.shot_lines import ShotLine
from vibeam.periodic.orbit_map import orbit_points

PLAIN = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=0.02, restitution=0.5)
FAR = replace(PLAIN, second_gap=50.0)  # a second stop that nothing reaches: no closed form knows it

SOFT = """
title = "an oscillator with a linear stop"
[sdof]
natural_frequency = "1 rad/s"
damping_ratio = 0.05
[stop]
gap = 1e-4
law = "linear"
stiffness = 40.0
damping = 0.5
[drive]
amplitude = 0.5e-3
[sweep]
frequency = { from = "2.0 rad/s", to = "2.4 rad/s", points = 5 }
direction = "up"
settle = 200
hold = 50
[fidelity.soft]
reduction = "static_mode"
"""


def test_points_of_a_line_have_the_motions_of_closed_forms() -> None:
    omega = np.linspace(1.9, 3.0, 7)
    shot = ShotLine([(FAR, vibeam.Drive(each, 0.1)) for each in omega], 1)
    shot.fill([])
    velocity, admissible, stable = shot.points()
    known = orbit_points(PLAIN, 1, omega, np.full(7, 0.1), np.full(7, 0.02))
    held = known.admissible[:, 0]
    assert held[[0, -1]].all()  # both ends of the line too
    np.testing.assert_allclose(velocity[held, 0], known.velocity[held, 0], rtol=1e-10)
    np.testing.assert_array_equal(stable[held, 0] > 0, known.stable[held, 0])
    assert (admissible[held, 0] > 0).all()


def test_a_line_begun_from_another_needs_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    omega = np.linspace(2.0, 2.4, 5)
    first = ShotLine([(FAR, vibeam.Drive(each, 0.1)) for each in omega], 1)
    first.fill([])
    monkeypatch.setattr("vibeam.maps.shot_lines.orbits", None)
    nearby = replace(FAR, gap=0.021)
    second = ShotLine([(nearby, vibeam.Drive(each, 0.1)) for each in omega], 1)
    second.fill(first.motions)
    known = orbit_points(replace(PLAIN, gap=0.021), 1, omega, np.full(5, 0.1), np.full(5, 0.021))
    np.testing.assert_allclose(second.points()[0][:, 0], known.velocity[:, 0], rtol=1e-10)


def test_maps_by_shooting_have_fewer_points_by_themselves() -> None:
    several = vibeam.load("cases/rigs/elastic_stop.toml").system("beam")
    assert usual_points([PLAIN]) == usual_points([FAR]) == MOST
    rows, columns = usual_points([several, PLAIN])
    assert rows < MOST[0]
    assert usual_points([several, several])[1] < columns < MOST[1]


def test_a_stability_map_of_a_stop_that_yields(tmp_path: Path) -> None:
    (tmp_path / "soft.toml").write_text(SOFT)
    case = vibeam.load(tmp_path / "soft.toml")
    found = vibeam.stability(case, low=0.0, high=2e-4, points=2, frequencies=3)
    assert any("by shooting" in note for note in found.notes)
    (one,) = found.maps
    system, seen = replace(case.system("soft"), gap=2e-4), 0
    for column, hertz in enumerate(found.plan.axes[-1].values):
        flown = vibeam.sweep(system, omega=[2 * np.pi * hertz], amplitude=0.5e-3, settle=400, hold=20)
        if flown.period[0] == 1 and flown.impacts_per_period[0] > 0:
            stable = one.velocity[:, 1, column][one.stable[:, 1, column]]
            assert np.min(abs(stable / flown.impact_velocity[0] - 1)) < 1e-6
            seen += 1
    assert seen


def test_a_block_is_begun_from_motions_that_other_lines_lead_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "soft.toml").write_text(SOFT)
    case = vibeam.load(tmp_path / "soft.toml")
    found = vibeam.orbits

    def at_small_gaps(system: vibeam.ImpactSystem, drive: vibeam.Drive, periods: int) -> tuple[vibeam.Orbit, ...]:
        return found(system, drive, periods) if system.gap < 1e-4 else ()

    monkeypatch.setattr("vibeam.maps.shot_lines.orbits", at_small_gaps)
    (one,) = vibeam.stability(case, low=0.0, high=4e-4, points=9, frequencies=3).maps
    assert np.isfinite(one.velocity[0, -1]).all()  # in the third block of four lines
