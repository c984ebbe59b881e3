"""Stability study (``vibeam stability``): the map of each model of a case, and the boundaries along its own line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import require_one_harmonic
from vibeam.case.source import of_source
from vibeam.exchange.faults import CaseError
from vibeam.periodic.orbit_map import OrbitMap, orbit_map
from vibeam.runs.comparison.differences import listed
from vibeam.runs.summary import ill_posed
from vibeam.solvers.averaging import slow_flow
from vibeam.studies.stability import axes
from vibeam.studies.stability.axes import Driving, StabilityAxis
from vibeam.studies.stability.rows import Crossing, CurvePoint, Share, crossings, curve_points, share
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


@dataclass(frozen=True)
class ModelMap:
    """One model: its ``fidelities``, its map, its own value of the second parameter, and the range of averaged motions.

    ``drive``: its own level. ``averaged``: least and greatest value (columns, 2) of the second parameter at each
    frequency, NaN without; None for more than one mode.
    """

    fidelities: tuple[str, ...]
    modes: int
    orbits: OrbitMap
    own: float
    drive: float
    averaged: Array | None

    @property
    def name(self) -> str:
        """Names of its fidelities."""
        return " ".join(self.fidelities)


@dataclass(frozen=True, eq=False, repr=False)
class Stability(ValueRecord):
    """Maps of a case, and the boundaries along its own line."""

    case: Case
    axis: StabilityAxis
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
        return [point for one in self.maps for point in curve_points(one.name, one.orbits, one.drive)]

    @property
    def shares(self) -> list[Share]:
        """Shares of all maps."""
        return [share(one.name, one.orbits) for one in self.maps]


@of_source
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

    ``over``: "gap" or "drive" ("frequency,gap" says the same), which is the level that the case says its drive by;
    ``low``, ``high``: as a case has them, with unit, None: chosen from the case. Fidelities that make the same model
    share a map. ValueError for invalid arguments, an unknown fidelity included; CaseError, at its line, for a drive or
    models without closed forms.
    """
    if fidelity is not None and fidelity not in case.fidelities:
        raise ValueError(f"no fidelity {fidelity!r}: there are {', '.join(case.fidelities)}")
    require_one_harmonic(case, "a stability map", [fidelity] if fidelity else ())
    grid = axes.frequencies(case, frequencies)
    models, refused = _models(case, fidelity, grid)
    first = models[0]
    over = axes.second_name(over)
    axis = axes.second_axis(case, over, low, high, first.system, first.drive)
    refused += tuple(_otherwise(each, first, axis) for each in models if over == "drive" and not each.like(first))
    models = [each for each in models if over == "gap" or each.like(first)]
    values = np.linspace(axis.low, axis.high, points)
    span = float(grid[0]), float(grid[-1])
    maps = tuple(_map(model, axis, grid, values, periods) for model in models)
    met = (each for one in models for each in crossings(one.names[0], one.system, one.drive, span, periods))
    return Stability(case, axis, maps, tuple(met), refused)


@dataclass(frozen=True)
class _MappedModel:
    """Distinct model under its own drive, with all its fidelities."""

    names: list[str]
    system: ImpactSystem
    drive: Driving
    amplitude: Array

    def moves_as(self, other: _MappedModel) -> bool:
        """Test whether it moves identically, under a drive of the same size at every frequency."""
        return self.system.moves_as(other.system) and np.array_equal(self.amplitude, other.amplitude)

    def like(self, other: _MappedModel) -> bool:
        """Test whether its drive is said by the same key."""
        return self.drive.key == other.drive.key


def _models(case: Case, fidelity: str | None, grid: Array) -> tuple[list[_MappedModel], tuple[str, ...]]:
    """Distinct models, and the reasons of the fidelities left out; CaseError, at their lines, where all are."""
    found: list[_MappedModel] = []
    refused: dict[str, list[str]] = {}
    for name in case.fidelities if fidelity is None else [fidelity]:
        system = case.system(name)
        if system.beyond_plain:
            refused.setdefault(" or ".join(system.beyond_plain), []).append(name)
            continue
        drive = Driving.of(case, name)
        model = _MappedModel([name], system, drive, drive.amplitude(grid))
        twin = next((other for other in found if model.moves_as(other)), None)
        if twin is None:
            found.append(model)
        else:
            twin.names.append(name)
    if not found:
        told = "no closed form knows {}: vibeam map and vibeam verdict fly it instead"
        wrong = [(name, told.format(why)) for why, names in refused.items() for name in names]
        raise CaseError([case.fault("fidelity", name, message=message) for name, message in wrong])
    return found, tuple(f"{listed(names)}: no map, for no closed form knows {why}" for why, names in refused.items())


def _otherwise(model: _MappedModel, first: _MappedModel, axis: StabilityAxis) -> str:
    said = "a list over frequency" if model.drive.key is None else f"its {model.drive.key}"
    return f"{listed(model.names)}: no map over the {axis.name} of {first.names[0]}, for the drive is said by {said}"


def _map(model: _MappedModel, axis: StabilityAxis, grid: Array, values: Array, periods: int) -> ModelMap:
    """Map of one model over the axis."""
    drive, system = model.drive, model.system
    given: dict[str, Any] = {"amplitude": drive.own, "gap": system.gap} | {axis.over: values}
    orbits = orbit_map(system, grid, given["amplitude"], periods, given["gap"], drive.per_level)
    own = system.gap if axis.over == "gap" else drive.own
    averaged = _averaged(model, axis.over, grid, periods)
    return ModelMap(tuple(model.names), system.size, orbits, own, drive.own, averaged)


def _averaged(model: _MappedModel, over: str, omega: Array, periods: int) -> Array | None:
    """Open interval of gaps, or of levels, with a stationary averaged motion near Ω = 2n (Δ_MAX of eq. 25)."""
    system = model.system
    try:
        flow, unit = slow_flow(system, 1.0, resonance=periods)
    except ValueError:
        return None
    per_metre = np.array([flow.gaps(float(each) / unit) for each in omega])  # both ends grow with the drive
    if over == "gap":
        static = system.gap - flow.oscillator.gap  # the gap of the stop, not from the static place
        return per_metre * model.amplitude[:, None] + static
    gap = flow.oscillator.gap
    with np.errstate(divide="ignore"):
        least = np.where(gap > 0, gap / per_metre[:, 1], gap / per_metre[:, 0])
        least = least / np.asarray(model.drive.per_level(omega))
    return np.stack([least, np.full(len(omega), np.nan)], axis=1)
