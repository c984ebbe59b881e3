"""Closed-form motions over a sweep: against the orbits, the linear response, and flights."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from stand_in import RIG

import vibeam
from vibeam.casefile.read import load
from vibeam.periodic.motions import FREE, HARDER, SOFTER, closed_amplitudes, closed_curve, unsuited


def driven(name: str, points: int, **settings: Any) -> tuple[Any, np.ndarray, np.ndarray]:
    """System of the beam, drive frequencies and amplitudes."""
    case = load(RIG.with_name(f"{name}.toml"), set={"sweep.frequency.points": points} | settings)
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    return case.system("beam"), omega, np.broadcast_to(case.amplitude(omega), omega.shape)


@pytest.mark.parametrize("output", ["sensor", "contact"])
@pytest.mark.parametrize("name", ["dtu_neutral", "dtu_loose", "dtu_tight"])
def test_amplitudes_are_those_of_the_stable_orbits(name: str, output: str) -> None:
    """Orbits are certified clear of the stop in between, one at a time, and their extremes flown."""
    system, omega, base = driven(name, 7)
    found = closed_amplitudes(system, omega, base, output)
    for point, drive in enumerate(map(vibeam.Drive, omega, base)):
        stable = [each.amplitude(output) for each in vibeam.orbits(system, drive) if each.stable]
        ours = found[point, [HARDER, SOFTER]]
        assert sorted(ours[np.isfinite(ours)]) == pytest.approx(sorted(stable), rel=1e-11)
    assert np.isfinite(found[:, HARDER]).any()
    assert np.isnan(closed_amplitudes(system, omega, base, output, (SOFTER,))[:, [HARDER, FREE]]).all()


def test_the_motion_that_never_touches_is_one_of_them() -> None:
    system = vibeam.ImpactSystem.from_modes([2.0, 9.0], 0.05, [1.0, 0.4], [1.0, 0.3], gap=10.0)
    omega = np.array([1.0, 3.0])
    found = closed_amplitudes(system, omega, np.ones(2), "contact")
    h = sum(c * omega**2 / (own**2 - omega**2 + 0.1j * own * omega) for own, c in ((2, 1), (9, 0.12)))
    assert found[:, FREE] == pytest.approx(np.abs(h), rel=1e-12)
    assert np.isnan(found[:, [HARDER, SOFTER]]).all()
    touching = closed_amplitudes(replace(system, gap=0.3), omega, np.ones(2), "contact")
    assert np.isnan(touching[:, FREE]).all()


def test_the_peak_is_the_highest_of_the_whole_grid() -> None:
    system, omega, base = driven("dtu_loose", 121)
    curve, whole = closed_curve(system, omega, base, "sensor"), closed_amplitudes(system, omega, base, "sensor")
    assert len(curve.which) == 16
    assert curve.peak == pytest.approx(np.nanmax(whole), rel=1e-12)
    assert curve.amplitude == pytest.approx(whole[curve.which], rel=1e-12, nan_ok=True)


def test_systems_without_closed_forms_have_none() -> None:
    system, omega, base = driven("dtu_neutral", 3, **{"stop.second_gap": "1 mm"})
    assert unsuited(system) == "no closed-form motions with a second stop"
    assert np.isnan(closed_amplitudes(system, omega, base, "sensor")).all()
    undamped = vibeam.ImpactSystem.from_modes([2.0], 0.0, [1.0], [1.0], gap=10.0)
    assert np.isnan(closed_amplitudes(undamped, np.ones(1), np.ones(1), "contact")).all()  # keeps what disturbed it
