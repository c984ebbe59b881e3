"""Sweeps of many systems in step: those of one after another, whatever stands beside them; what goes alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.batches.side_by_side import SystemSweep, sweep_side_by_side
from vibeam.runs.sweep import SweepPoints, SweepSettings

OMEGA = np.linspace(1.7, 2.3, 7)
COLUMNS = ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "rest", "mode_energy")


def rigs() -> list[vibeam.ImpactSystem]:
    """Three systems of one mode and three of two, each with its own output, gap and restitution."""
    found = []
    for place in range(3):
        share = 1.0 + 0.1 * place
        common = {"gap": 0.01 * place, "restitution": 0.5 + 0.1 * place}
        found.append(vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, **common))
        outputs = {"sensor": [share, 0.3]}
        two = vibeam.ImpactSystem.from_modes(
            [1.0, 6.3], [0.05, 0.02], [1.0, 0.4 * share], [1.0, 0.2], outputs=outputs, **common
        )
        found.append(two)
    return found


def sweep_of(system: vibeam.ImpactSystem, amplitude: float = 0.1, omega: np.ndarray = OMEGA) -> SystemSweep:
    output = "contact" if system.size == 1 else "sensor"
    settings = SweepSettings(settle=300, hold=8, output=output).checked(system)
    return SystemSweep(system, SweepPoints.of(omega, amplitude), settings)


def test_sweeps_in_step_are_those_of_one_after_another() -> None:
    asked = [sweep_of(each, 0.1 + 0.01 * place) for place, each in enumerate(rigs())]
    assert all(each.in_lanes for each in asked)
    for own, found in zip(asked, sweep_side_by_side(asked), strict=True):
        alone = own.alone()
        np.testing.assert_array_equal(found.period, alone.period)
        repeats = alone.period > 0
        assert repeats.sum() >= 6
        for name in COLUMNS:
            one, other = getattr(found, name)[repeats], getattr(alone, name)[repeats]
            np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-13)  # amplitudes are about 0.1


def test_a_sweep_is_the_same_to_the_bit_whatever_stands_beside_it() -> None:
    asked = [sweep_of(each) for each in rigs()]
    together = sweep_side_by_side(asked)
    for own, found in zip(asked, together, strict=True):
        (alone,) = sweep_side_by_side([own])
        np.testing.assert_array_equal(found.amplitude, alone.amplitude)
        np.testing.assert_array_equal(found.mode_energy, alone.mode_energy)


def test_states_are_carried_along_the_way_of_the_sweep() -> None:
    """Without damping enough to settle in two periods, up and down differ."""
    short = replace(sweep_of(rigs()[0]), settings=SweepSettings(settle=2, hold=1).checked(rigs()[0]))
    down = replace(short, points=SweepPoints.of(OMEGA[::-1], 0.1))
    up, back = sweep_side_by_side([short, down])
    np.testing.assert_allclose(up.amplitude, short.alone().amplitude, rtol=1e-10)
    np.testing.assert_allclose(back.amplitude, down.alone().amplitude, rtol=1e-10)
    assert not np.allclose(up.amplitude, back.amplitude[::-1], rtol=1e-3)


@pytest.mark.parametrize("change", ["drift", "wear", "options", "solver"])
def test_what_lanes_do_not_take_goes_alone(change: str) -> None:
    own = sweep_of(rigs()[0])
    changed = {
        "drift": replace(own, points=SweepPoints.of(OMEGA, 0.1, drift=0.001 * OMEGA)),
        "wear": replace(own, settings=replace(own.settings, wear=1e-6)),
        "options": replace(own, settings=replace(own.settings, solver="moreau", options={"steps": 200})),
        "solver": replace(own, settings=replace(own.settings, solver="orbit")),
    }[change]
    assert not changed.in_lanes
    if change != "options":
        one, _ = sweep_side_by_side([changed, own])
        np.testing.assert_array_equal(one.amplitude, changed.alone().amplitude)
