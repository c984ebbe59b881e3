"""Stability maps (``vibeam map --picture stability``): where motions with one impact exist, keep clear, are stable."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from vibeam.case.case import Case
from vibeam.case.grid_keys import GAP, LEVELS, SHARE, MapPlan
from vibeam.case.source import of_source
from vibeam.maps.axes import own_value, points_of
from vibeam.maps.boundaries import KINDS, PlaneBoundary, along_row, boundaries_of, gaps_at_contact, level_of
from vibeam.maps.models import MOST, models_of
from vibeam.maps.plan import plan_over
from vibeam.maps.result import MapResult, StudyOfMap
from vibeam.maps.run import run_map
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary
from vibeam.runs.comparison.differences import listed
from vibeam.runs.parallel import run_parallel
from vibeam.runs.summary import ill_posed
from vibeam.solvers import SOLVERS
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import Array, Flags, ValueRecord
from vibeam_models.registry import loaded

BRANCHES = ("harder", "softer")
ALONG = 501  # places along the case's own line at which boundaries are looked for


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
    """One point of a boundary curve: Hz, SI value of the map's other key, m/s.

    ``clear``: its motion keeps clear of the stop between impacts.
    """

    fidelity: str
    periods: int
    boundary: str
    motion: str
    curve: int
    frequency: float
    value: float
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


@dataclass(frozen=True)
class ModelMap:
    """One model: its ``fidelities``, and its motions with one impact (2, rows, columns), the harder impact first.

    ``velocity`` in m/s, NaN where there is no motion. ``averaged``: least and greatest value (columns, 2) of the other
    key with a stationary averaged motion at each frequency, NaN without; None for more than one mode. ``shot``: by
    shooting, motions with any number of contacts.
    """

    fidelities: tuple[str, ...]
    modes: int
    velocity: Array
    admissible: Flags
    stable: Flags
    boundaries: tuple[PlaneBoundary, ...]
    averaged: Array | None
    shot: bool = False

    @property
    def name(self) -> str:
        """Names of its fidelities."""
        return " ".join(self.fidelities)


@dataclass(frozen=True, eq=False, repr=False)
class Stability(StudyOfMap, ValueRecord, ViewedTable):
    """Stability maps of a case's models, and the boundaries along the case's own line."""

    result: MapResult
    maps: tuple[ModelMap, ...]
    crossings: tuple[Crossing, ...]
    refused: tuple[str, ...] = ()

    @property
    def notes(self) -> list[str]:
        """Limits of maps and boundaries, in sentences: models left out, no motion, R₁ < 0."""
        from vibeam.case.fidelity import restitutions

        names = [name for one in self.maps for name in one.fidelities]
        first_mode = {name: restitutions(self.case.scene_of(name), self.case.fidelities[name])[1] for name in names}
        empty = [each.fidelity for each in self.shares if not each.exists]
        notes = [f"{listed(empty)}: no motion with impacts of this kind anywhere on the map"] if empty else []
        return [*self.refused, *notes, *ill_posed(first_mode, self.case.scene)]

    @property
    def own(self) -> float:
        """The case's own value of the map's other key."""
        return own_value(self.case, self.plan.axes[-2].key)

    @property
    def points(self) -> list[CurvePoint]:
        """All points of all boundary curves."""
        return [point for one in self.maps for point in _points(one, self.plan.periods)]

    @property
    def shares(self) -> list[Share]:
        """Shares of all maps."""
        return [
            Share(one.name, self.plan.periods, *(float(flags.any(axis=0).mean()) for flags in (
                np.isfinite(one.velocity), one.admissible, one.stable,
            )))
            for one in self.maps
        ]  # fmt: skip


@of_source
def stability(
    case: Case,
    over: str = "gap",
    low: str | float | None = None,
    high: str | float | None = None,
    points: int | None = None,
    frequencies: int | None = None,
    periods: int = 1,
    fidelities: Sequence[str] | None = None,
) -> Stability:
    """Compute maps over the case's frequencies and its gap, drive or any other key, from ``low`` to ``high``.

    ``over``: "gap", "drive" (the level that the case says its drive by; of a list over frequency its share) or a dotted
    key; ``low``, ``high``: as a case has them, with unit, None: chosen for gap and drive. Fidelities that make the same
    model share a map. ValueError for invalid arguments, an unknown fidelity included; CaseError, at its line, for a
    drive of several harmonics. A model that no closed form knows is shot at, point by point.
    ``points``, ``frequencies``: how many, None: 101 and 161, fewer of models that are shot at, for their price.

    >>> import vibeam
    >>> found = vibeam.stability("cases/dtu_neutral.toml", points=3, frequencies=5, fidelities=["sdof"])
    >>> found.maps[0].stable.shape
    (2, 3, 5)
    """
    places = points_of(over, points or MOST[0], frequencies or MOST[1]) if points or frequencies else None
    plan = plan_over(case, "stability", over, low, high, places, periods=periods, fidelities=fidelities)
    with TemporaryDirectory(prefix="vibeam-") as folder:
        return stability_of(run_map(case, plan, Path(folder) / "stability.h5"))


def stability_of(result: MapResult) -> Stability:
    """Stability of a finished map with ``picture = "stability"``."""
    models = models_of(result.case, result.plan)
    maps = run_parallel(lambda name, _: _map(result, name, models.twins[name]), models.names)
    met = (each for name in models.names for each in _crossings(result, name))
    return Stability(result, tuple(maps), tuple(met), models.notes)


def _map(result: MapResult, name: str, twins: tuple[str, ...]) -> ModelMap:
    case, plan, values = result.case, result.plan, result[name].values
    bounds = boundaries_of(case, name, plan.axes, periods=plan.periods)[0] if plan.boundaries else ()
    flags = values["admissible"] > 0, values["stable"] > 0
    system, averaged = case.system(name), _averaged(case, name, plan)
    shot = bool(system.beyond_plain)
    return ModelMap(twins, system.size, values["impact_velocity"], *flags, tuple(bounds), averaged, shot)


def _crossings(result: MapResult, name: str) -> Iterator[Crossing]:
    """Boundaries of a model over the map's frequencies, at its own gap and drive; none of one that is shot at."""
    hertz, model, periods = np.array(result.plan.axes[-1].values), result.case.model(name), result.plan.periods
    if not np.all(model.amplitude(2 * np.pi * hertz)) or model.system().beyond_plain:
        return
    for each in along_row(model, hertz, periods, points=ALONG):
        if each.clear:
            place = each.omega / (2 * np.pi), each.velocity
            yield Crossing(name, periods, KINDS[each.kind], BRANCHES[each.branch], *place, _multipliers(each))


def _multipliers(each: Boundary) -> str:
    """Dominant multipliers: the largest, and its conjugate or the next."""
    if not len(each.multipliers):
        return ""
    largest = each.multipliers[0]
    twin = f"{largest.real:.4g} ± {abs(largest.imag):.4g}i"
    return twin if abs(largest.imag) > 1e-9 * abs(largest) else f"{largest.real:.4g}"


def _points(one: ModelMap, periods: int) -> Iterator[CurvePoint]:
    for number, curve in enumerate(one.boundaries):
        motion = "both" if curve.kind is Kind.FOLD else BRANCHES[curve.branch]
        for at in range(len(curve.clear)):
            place = float(curve.frequency[at]), float(curve.value[at]), float(curve.velocity[at]), bool(curve.clear[at])
            yield CurvePoint(one.name, periods, curve.boundary, motion, number, *place)


def _averaged(case: Case, name: str, plan: MapPlan) -> Array | None:
    """Open interval of gaps, or of levels, with a stationary averaged motion near Ω = 2n (Δ_MAX of eq. 25)."""
    upward, omega, model = plan.axes[-2], 2 * np.pi * np.array(plan.axes[-1].values), case.model(name)
    system = model.system()
    home = next((each.gaps for each in SOLVERS.values() if each.gaps), "")
    if not home or upward.key not in (GAP, SHARE, *LEVELS):
        return None
    try:
        per_metre, gap = loaded(home)(system, omega, plan.periods)  # both ends grow with the drive
    except ValueError:
        return None
    if upward.key == GAP:
        drive = np.asarray(model.amplitude(omega)) * np.ones(len(omega))
        static = system.gap - gap  # the gap of the stop, not from the static place
        low, high = gaps_at_contact(model, (upward.values[0], upward.values[-1]))
        slope = (upward.values[-1] - upward.values[0]) / (high - low)
        return np.asarray(upward.values[0] + slope * (per_metre * drive[:, None] + static - low))
    with np.errstate(divide="ignore"):
        least = np.where(gap > 0, gap / per_metre[:, 1], gap / per_metre[:, 0])
        least = least / np.asarray(level_of(model, upward.key)(omega))
    return np.stack([least, np.full(len(omega), np.nan)], axis=1)
