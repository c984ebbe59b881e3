"""Stability study (``vibeam stability``): the map of each model of a case, and the boundaries along its own line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.one_harmonic import require_one_harmonic
from vibeam.orbits.orbit_map import OrbitMap, orbit_map
from vibeam.run.comparison.wording import listed
from vibeam.run.remarks import ill_posed
from vibeam.solvers.averaging.solver import slow_flow
from vibeam.studies.stability import axes
from vibeam.studies.stability.axes import Axis
from vibeam.studies.stability.rows import Crossing, CurvePoint, Share, crossings, curve_points, share

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModelMap:
    """One model: its ``fidelities``, its map, and the range of averaged motions, in the axis' SI unit.

    ``averaged``: least and greatest value (columns, 2) at each frequency, NaN without; None for more than one mode.
    """

    fidelities: tuple[str, ...]
    modes: int
    orbits: OrbitMap
    averaged: Array | None

    @property
    def name(self) -> str:
        """Names of its fidelities."""
        return " ".join(self.fidelities)


@dataclass(frozen=True)
class Stability:
    """Maps of a case, and the boundaries along its own line."""

    case: Case
    axis: Axis
    maps: tuple[ModelMap, ...]
    crossings: tuple[Crossing, ...]
    refused: tuple[str, ...] = ()

    @property
    def notes(self) -> list[str]:
        """Limits of maps and boundaries, in sentences: models left out, no motion, no boundary, R₁ < 0."""
        from vibeam.case.fidelity import restitutions

        names = [name for one in self.maps for name in one.fidelities]
        first_mode = {name: restitutions(self.case.scene_of(name), self.case.fidelities[name])[1] for name in names}
        empty = [each.fidelity for each in self.shares if not each.exists]
        notes = [f"{listed(empty)}: no motion with impacts of this kind anywhere on the map"] if empty else []
        notes += [] if self.crossings or empty else [f"no boundary at the case's own {self.axis.name}"]
        return [*self.refused, *notes, *ill_posed(first_mode)]

    @property
    def points(self) -> list[CurvePoint]:
        """All points of all boundary curves."""
        return [point for one in self.maps for point in curve_points(one.name, one.orbits)]

    @property
    def shares(self) -> list[Share]:
        """Shares of all maps."""
        return [share(one.name, one.orbits) for one in self.maps]


def stability(
    case: Case,
    over: str = "gap",
    low: str | float | None = None,
    high: str | float | None = None,
    points: int = 101,
    frequencies: int = 161,
    periods: int = 1,
    fidelity: str | None = None,
) -> Stability:
    """Compute maps over the case's frequencies and its gap (at the contact) or drive, from ``low`` to ``high``.

    ``over``: "gap" or "drive"; ``low``, ``high``: as a case has them, with unit, None: chosen from the case. Fidelities
    that make the same model share a map. ValueError for invalid arguments, an unknown fidelity included.
    """
    if fidelity is not None and fidelity not in case.fidelities:
        raise ValueError(f"no fidelity {fidelity!r}: there are {', '.join(case.fidelities)}")
    require_one_harmonic(case, "a stability map")
    models, refused = _models(case, fidelity)
    axis = axes.second_axis(case, over, low, high, next(iter(models.values()))[0])
    grid, values = axes.frequencies(case, frequencies), axis.factor * np.linspace(axis.low, axis.high, points)
    maps: list[ModelMap] = []
    met: list[Crossing] = []
    span = float(grid[0]), float(grid[-1])
    for name, (system, names) in models.items():
        amplitude = float(case.amplitude_of(name))
        given = {"amplitude": amplitude, "gap": system.gap} | {axis.over: values}
        found = orbit_map(system, grid, given["amplitude"], periods, given["gap"])
        maps.append(ModelMap(tuple(names), system.size, found, _averaged(amplitude, system, axis.over, grid, periods)))
        met += crossings(name, system, amplitude, span, periods)
    return Stability(case, axis, tuple(maps), tuple(met), refused)


def _models(
    case: Case, fidelity: str | None
) -> tuple[dict[str, tuple[ImpactSystem, list[str]]], tuple[str, ...]]:  # fmt: skip
    """Distinct systems, by the first fidelity of each, with all their fidelities; and the reasons of those left out.

    ValueError where none has one.
    """
    found: dict[str, tuple[ImpactSystem, list[str]]] = {}
    refused: dict[str, list[str]] = {}
    for name in case.fidelities if fidelity is None else [fidelity]:
        system = case.system(name)
        if system.beyond_plain:
            refused.setdefault(" or ".join(system.beyond_plain), []).append(name)
            continue
        twin = next((names for other, names in found.values() if system.moves_as(other)), None)
        if twin is None:
            found[name] = system, [name]
        else:
            twin.append(name)
    notes = tuple(f"{listed(names)}: no map, for no closed form knows {why}" for why, names in refused.items())
    if not found:
        raise ValueError("; ".join(notes))
    return found, notes


def _averaged(amplitude: float, system: ImpactSystem, over: str, omega: Array, periods: int) -> Array | None:
    """Open interval of gaps, or of amplitudes, with a stationary averaged motion near Ω = 2n (Δ_MAX of eq. 25)."""
    try:
        flow, unit = slow_flow(system, amplitude, resonance=periods)
    except ValueError:
        return None
    ends = np.array([flow.gaps(float(each) / unit) for each in omega])
    if over == "gap":
        return ends + (system.gap - flow.oscillator.gap)  # the gap of the stop, not from the static place
    gap = flow.oscillator.gap
    with np.errstate(divide="ignore"):
        least = amplitude * np.where(gap > 0, gap / ends[:, 1], gap / ends[:, 0])  # both ends grow with the drive
    return np.stack([least, np.full(len(omega), np.nan)], axis=1)
