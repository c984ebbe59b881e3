"""Orbits on the brink: a hair to either side of every kind of boundary that ``vibeam.boundaries`` finds."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from motions import EPSILON, assert_lawful, judged

import vibeam
from vibeam.periodic.bifurcation_functions import Kind

ONE = vibeam.ImpactSystem.from_modes(1.0, 0.015, 1.0, 1.0, gap=0.0, restitution=0.8)
TWO = vibeam.ImpactSystem.from_modes([1.0, 4.3], [0.02, 0.01], [1.0, 0.5], [1.0, 0.4], gap=0.0, restitution=0.8)
LINES = {
    "one mode, frequency": (replace(ONE, gap=5e-4), {"amplitude": 5e-4, "omega": (1.5, 6.5)}),
    "one mode, gap": (ONE, {"amplitude": 5e-4, "omega": 1.5, "gap": (-1e-3, 6e-3)}),
    "one mode, gap, two periods": (ONE, {"amplitude": 5e-4, "omega": 3.0, "gap": (-1e-3, 8e-3), "periods": 2}),
    "two modes, frequency": (replace(TWO, gap=3e-4), {"amplitude": 5e-4, "omega": (1.5, 6.5)}),
    "two modes, amplitude": (replace(TWO, gap=-5e-4), {"amplitude": (1e-4, 5e-3), "omega": 2.2}),
    "damped, frequency": (
        replace(ONE, gap=-2e-4, zeta=np.array([0.1])), {"amplitude": 1e-3, "omega": (1.2, 5.0)},
    ),
}  # fmt: skip
OFF = [0.0, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6]


@cache
def found(name: str) -> list[vibeam.Boundary]:
    system, given = LINES[name]
    return [each for each in vibeam.boundaries(system, points=121, **given) if each.clear]


def near(name: str, each: vibeam.Boundary, off: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
    """The system and drive with the boundary's parameter moved by a share of itself."""
    place = {key: getattr(each, key) for key in ("omega", "amplitude", "gap")}
    place[each.parameter] *= 1 + off
    return replace(LINES[name][0], gap=place["gap"]), vibeam.Drive(place["omega"], place["amplitude"])


def test_all_kinds_are_among_them() -> None:
    kinds = {each.kind for name in LINES for each in found(name)}
    assert kinds >= {Kind.FOLD, Kind.GRAZING, Kind.DOUBLING, Kind.TOUCHING, Kind.NEIMARK_SACKER}


@pytest.mark.parametrize("name", LINES)
def test_flights_on_the_brink_follow_the_orbit(name: str) -> None:
    """Four spans from the orbit's own state, as closely as its multipliers let round-off grow."""
    seen = 0
    for each in found(name):
        for off in OFF:
            system, drive = near(name, each, off)
            for orbit in vibeam.orbits(system, drive, each.periods):
                if not orbit.admissible or orbit.velocity < 1e-3 * orbit.reach * drive.omega:
                    continue
                path = vibeam.simulate(system, drive, orbit.time + 3.5 * orbit.span, orbit.state, t_start=orbit.time)
                growth = max(1.0, *np.abs(orbit.multipliers)) ** 4
                strong = path.impact_velocities > 0.01 * orbit.velocity
                bar = 1e5 * EPSILON * growth * orbit.reach * drive.omega / orbit.velocity
                count = 3
                if each.kind is Kind.TOUCHING:  # the touch may be struck, as hard as the root of round-off, which grows
                    count, bar = 1, max(bar, 100 * EPSILON**0.5)
                hits = orbit.time + orbit.span * np.arange(1, 1 + count)
                assert strong.sum() >= count, (each.kind, off)
                np.testing.assert_allclose(path.impact_times[strong][:count], hits, rtol=bar)
                np.testing.assert_allclose(path.impact_velocities[strong][:count], orbit.velocity, rtol=10 * bar)
                assert_lawful(path)
                seen += 1
    assert seen >= 3


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-3])
def test_motions_on_the_brink_are_the_exact_ones(name: str, off: float) -> None:
    """From a hundredth beside the boundary's motion, against arbitrary precision, twelve impacts on."""
    for each in found(name)[:3]:
        system, drive = near(name, each, off)
        start = vibeam.State(
            np.r_[system.gap - 1.01 * drive.amplitude, np.zeros(system.size - 1)] / system.contact[0],
            np.zeros(system.size),
        )
        judged(system, drive, start, 12, least=0)
        assert_lawful(vibeam.simulate(system, drive, 40 * 2 * np.pi / drive.omega, start))
