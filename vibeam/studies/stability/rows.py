"""Rows of the map: the boundaries along the case's own line, the points of all, the shares of each model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries
from vibeam.periodic.orbit_map import OrbitMap
from vibeam.studies.stability.axes import Driving
from vibeam.system.impact_system import ImpactSystem

NAMES = {
    Kind.FOLD: "fold",
    Kind.GRAZING: "grazing",
    Kind.TOUCHING: "second touch",
    Kind.DOUBLING: "period doubling",
    Kind.NEIMARK_SACKER: "Neimark–Sacker",
}

BRANCHES = ("harder", "softer")


@dataclass(frozen=True)
class Crossing:
    """Boundary at the case's own gap and drive: frequency in Hz, impact velocity in m/s, the largest multipliers."""

    fidelity: str
    periods: int
    boundary: str
    motion: str
    frequency: float
    velocity: float
    multipliers: str


@dataclass(frozen=True)
class CurvePoint:
    """One point of a boundary curve: Hz, m, m/s; ``clear``: its motion keeps clear of the stop between impacts.

    ``drive``: its level, in the SI unit of the key that says it; of a list over frequency the share of that.
    """

    fidelity: str
    periods: int
    boundary: str
    motion: str
    curve: int
    frequency: float
    gap: float
    drive: float
    velocity: float
    clear: bool


@dataclass(frozen=True)
class Share:
    """Share of a map with a motion, an admissible one, a stable admissible one: 0 … 1."""

    fidelity: str
    periods: int
    exists: float
    admissible: float
    stable: float


def crossings(
    name: str, system: ImpactSystem, drive: Driving, span: tuple[float, float], periods: int
) -> Iterator[Crossing]:
    """Boundaries of the fidelity ``name`` within ``span`` (rad/s), at its own gap and drive."""
    if drive.own == 0:
        return
    for each in boundaries(system, drive.own, span, periods, kinds=tuple(NAMES), per_level=drive.per_level):
        if each.clear:
            place = (each.omega / (2 * np.pi), each.velocity)
            yield Crossing(name, periods, NAMES[each.kind], BRANCHES[each.branch], *place, _shown(each))


def _shown(each: Boundary) -> str:
    """Dominant multipliers: the largest, and its conjugate or the next."""
    if not len(each.multipliers):
        return ""
    largest = each.multipliers[0]
    twin = f"{largest.real:.4g} ± {abs(largest.imag):.4g}i"
    return twin if abs(largest.imag) > 1e-9 * abs(largest) else f"{largest.real:.4g}"


def curve_points(name: str, orbits: OrbitMap, drive: float) -> Iterator[CurvePoint]:
    """Points of all boundary curves of one model's map; ``drive``: its own level."""
    for number, curve in enumerate(orbits.curves):
        boundary, motion = NAMES[curve.kind], "both" if curve.kind is Kind.FOLD else BRANCHES[curve.branch]
        levels = curve.value if orbits.over == "amplitude" else np.full(len(curve), drive)
        for omega, gap, level, velocity, clear in zip(
            curve.omega, curve.gap, levels, curve.velocity, curve.clear, strict=True
        ):
            place = (float(omega) / (2 * np.pi), float(gap), float(level), float(velocity), bool(clear))
            yield CurvePoint(name, orbits.periods, boundary, motion, number, *place)


def share(name: str, orbits: OrbitMap) -> Share:
    """Shares of one model's map."""
    flags = (np.isfinite(orbits.velocity), orbits.admissible, orbits.stable)
    return Share(name, orbits.periods, *(float(each.any(axis=2).mean()) for each in flags))
