"""Maps of periodic motions: boundary curves against closed forms and along rows, shades against ``orbits``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import cos, exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.periodic.contours import BoundaryCurve, Plane
from vibeam.periodic.modal_sums import sums
from vibeam.periodic.orbit_map import orbit_points, plane_boundaries
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem

B = 0.5e-3
NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.5, restitution=0.7
)
AMPLITUDES = {"one": B, "three": 0.2}
SYSTEMS = {"one": NOMINAL, "three": THREE}


@dataclass(frozen=True)
class OrbitMap:
    """Motions (rows, columns, 2) and boundaries over frequency (rad/s) and a gap or an amplitude of the drive (m)."""

    plane: Plane
    curves: tuple[BoundaryCurve, ...]

    @property
    def omega(self) -> np.ndarray:
        return self.plane.omega

    @property
    def values(self) -> np.ndarray:
        return self.plane.values

    @cached_property
    def motions(self) -> dict[str, np.ndarray]:
        columns, rows = np.meshgrid(self.omega, self.values)
        found = orbit_points(self.plane.system, 1, columns.ravel(), np.full(rows.size, self.plane.held), rows.ravel())
        return {name: getattr(found, name).reshape(*rows.shape, 2) for name in ("velocity", "admissible", "stable")}


def orbit_map(system: ImpactSystem, omega: np.ndarray, over: str, values: np.ndarray, held: float) -> OrbitMap:
    plane = Plane(system, 1, over, omega, values, held)
    return OrbitMap(plane, plane_boundaries(plane))


@cache
def mapped(name: str) -> OrbitMap:
    """The map of the system with one mode or three."""
    if name == "one":
        return orbit_map(NOMINAL, np.linspace(1.5, 3.0, 76), "gap", np.linspace(-1.3e-3, 1.31e-3, 54), B)
    return orbit_map(THREE, np.linspace(0.8, 1.8, 51), "gap", np.linspace(-0.3, 0.9, 41), 0.2)


def curves(found: OrbitMap, kind: Kind, least: int = 1) -> list[BoundaryCurve]:
    chosen = [curve for curve in found.curves if curve.kind is kind]
    assert sum(len(curve) for curve in chosen) >= least
    return chosen


def harmonic(omega: float) -> float:
    return omega**2 * B / abs(1 - omega**2 + 0.03j * omega)


def test_grazing_is_where_the_free_motion_reaches_the_stop() -> None:
    for curve in curves(mapped("one"), Kind.GRAZING, 100):
        for omega, gap, clear in zip(curve.omega, curve.gap, curve.clear, strict=True):
            assert abs(gap) == pytest.approx(harmonic(omega), rel=1e-12)
            assert clear == (gap > 0)


def test_folds_in_closed_form() -> None:
    """Δ² κ² = |H|² (Ω²G₀² + κ²) turned round: |Δ| = |H| √(1 + (Ω G₀/κ)²)."""
    beta, r, own = 0.015, 0.9, sqrt(1 - 0.015**2)
    for curve in curves(mapped("one"), Kind.FOLD, 30):
        for omega, gap in zip(curve.omega, curve.gap, strict=True):
            span = 2 * pi / omega
            e, c, s = exp(-beta * span), cos(own * span), sin(own * span) / own
            bottom = 1 - 2 * e * c + e * e
            g0, kappa = e * s / bottom, r / (1 + r) - (1 - e * (c + beta * s)) / bottom
            assert abs(gap) == pytest.approx(harmonic(omega) * sqrt(1 + (omega * g0 / kappa) ** 2), rel=1e-10)


def test_period_doubling_in_closed_form() -> None:
    """1 + tr J + det J = 0 with trace and determinant in closed form."""
    beta, r, own, seen = 0.015, 0.9, sqrt(1 - 0.015**2), 0
    for curve in curves(mapped("one"), Kind.DOUBLING, 20):
        for omega, gap, velocity in zip(curve.omega, curve.gap, curve.velocity, strict=True):
            span = 2 * pi / omega
            harder = orbits(replace(NOMINAL, gap=float(gap)), Drive(float(omega), B))[0]
            force = omega**2 * B * sin(harder.phase)
            first = (1 + r) * (force - gap) * sin(own * span) / (own * velocity)
            trace = exp(-beta * span) * (first - 2 * r * cos(own * span))
            assert 1 + trace + r**2 * exp(-2 * beta * span) == pytest.approx(0, abs=1e-8)
            seen += 1
    assert seen


def test_neimark_sacker_has_a_pair_on_the_circle() -> None:
    for curve in curves(mapped("three"), Kind.NEIMARK_SACKER, 10):
        for omega, gap in zip(curve.omega, curve.gap, strict=True):
            orbit = orbits(replace(THREE, gap=float(gap)), Drive(float(omega), 0.2))[curve.branch]
            paired = orbit.multipliers[np.abs(orbit.multipliers.imag) > 1e-3]
            assert np.abs(np.abs(paired) - 1).min() < 1e-10


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_curve_runs_where_a_boundary_is_found_along_a_row(name: str) -> None:
    """On the grid's own rows ``boundaries`` finds the same frequencies."""
    found, system, amplitude = mapped(name), SYSTEMS[name], AMPLITUDES[name]
    row = len(found.values) // 2 + 5
    here = float(found.values[row])
    ends = (float(found.omega[0]), float(found.omega[-1]))
    seen = 0
    for at in boundaries(system, amplitude, ends, gap=here, points=201):
        if at.kind is Kind.PLUS_ONE or (at.kind not in (Kind.FOLD, Kind.GRAZING) and not _matters(at.multipliers)):
            continue
        on = [c.omega[c.gap == here] for c in found.curves if c.kind is at.kind and c.branch == at.branch]
        assert np.abs(np.concatenate([*on, [np.inf]]) - at.omega).min() < 1e-10, at
        seen += 1
    assert seen


def _matters(multipliers: np.ndarray) -> bool:
    """No real multiplier beyond 1: such a motion has lost its stability before."""
    return not np.any((np.abs(multipliers.imag) < 1e-9) & (multipliers.real > 1 + 1e-9))


@pytest.mark.parametrize("name", SYSTEMS)
def test_neighbours_on_a_curve_lie_in_one_cell(name: str) -> None:
    found = mapped(name)
    wide, high = np.diff(found.omega).max(), np.diff(found.values).max()
    for curve in found.curves:
        assert np.all(np.abs(np.diff(curve.omega)) <= wide * (1 + 1e-9))
        assert np.all(np.abs(np.diff(curve.gap)) <= high * (1 + 1e-9))
    assert max(len(curve) for curve in found.curves) > 20


@pytest.mark.parametrize("name", SYSTEMS)
def test_shades_are_what_single_orbits_say(name: str) -> None:
    found, system, amplitude = mapped(name), SYSTEMS[name], AMPLITUDES[name]
    rng, kinds = np.random.default_rng(3), set()
    for _ in range(150):
        row, column = rng.integers(len(found.values)), rng.integers(len(found.omega))
        drive = Drive(float(found.omega[column]), amplitude)
        at = (row, column)
        there = orbits(replace(system, gap=float(found.values[row])), drive)
        assert len(there) == np.isfinite(found.motions["velocity"][at]).sum()
        for branch, orbit in enumerate(there):
            assert found.motions["velocity"][at][branch] == pytest.approx(orbit.velocity, rel=1e-13)
            assert found.motions["admissible"][at][branch] == orbit.admissible
            assert found.motions["stable"][at][branch] == (orbit.stable and orbit.admissible)
            kinds.add((orbit.admissible, orbit.stable))
    assert {(True, True), (True, False)} <= kinds


def test_a_boundary_parts_stable_from_unstable_in_flight() -> None:
    """Across the doubling curve at a gap of its own the flight keeps period 1 on one side only."""
    curve = max(curves(mapped("one"), Kind.DOUBLING), key=len)
    i = len(curve) // 2
    system = replace(NOMINAL, gap=float(curve.gap[i]))
    grid = curve.omega[i] * np.array([0.994, 1.006])
    flown = vibeam.sweep(system, omega=grid, amplitude=B, settle=1500, hold=40)
    assert isinstance(flown, vibeam.FrequencyResponse)
    assert [period == 1 for period in flown.period] == [True, False]


def test_the_map_over_the_drive_is_the_one_over_the_gap_turned() -> None:
    """All lengths scale together, so that the boundary gap over the drive is one number at a frequency."""
    grid = np.linspace(1.6, 2.9, 27)
    drive = orbit_map(NOMINAL, grid, "amplitude", np.linspace(0.2e-3, 1e-3, 33), 0.4e-3)
    gap = orbit_map(NOMINAL, grid, "gap", np.linspace(0.1e-3, 1.2e-3, 33), 0.5e-3)
    same = 0
    for one in curves(drive, Kind.DOUBLING):
        for omega, amplitude in zip(one.omega, one.amplitude, strict=True):
            for other in curves(gap, Kind.DOUBLING):
                at = np.flatnonzero(other.omega == omega)
                if len(at):
                    same += 1
                    assert other.gap[at[0]] / 0.5e-3 == pytest.approx(0.4e-3 / amplitude, rel=1e-10)
    assert same > 3


def test_boundaries_that_a_fold_cuts_off_within_a_cell_are_found() -> None:
    """Grazing is where the free motion reaches the stop, at every frequency; the fold ends there within one row."""
    case = vibeam.load(Path(__file__).parents[3] / "cases" / "dtu_tight.toml")
    system, amplitude = case.system("sdof"), case.base_amplitude
    grid, values = 2 * np.pi * np.linspace(14.9, 15.6, 19), np.linspace(-2e-4, 2e-4, 101)
    found = orbit_map(system, grid, "gap", values, amplitude)
    free = amplitude * np.abs(sums(system, grid, 1).unit)
    grazing = [curve for curve in curves(found, Kind.GRAZING) if curve.clear.all()]
    for omega, expected in zip(grid, free, strict=True):
        near = [curve.gap[np.abs(curve.omega - omega) < 1e-9] for curve in grazing]
        assert np.abs(np.concatenate(near) / expected - 1).min(initial=np.inf) < 1e-9
    touched = [curve.omega.max() for curve in found.curves if curve.kind is Kind.TOUCHING and curve.branch == 0]
    assert max(touched) > 2 * np.pi * 15.2  # up to where it meets the fold
