"""Fidelity map (``vibeam map --picture verdict``): over frequency and another key, the cheapest model that suffices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import prod, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fineness import fineness
from vibeam.case.grid_keys import MapPlan
from vibeam.case.source import of_source
from vibeam.flight.engine.threads import OutOfTime, ending_at
from vibeam.maps.axes import points_of
from vibeam.maps.boundaries import PlaneBoundary, boundaries_of
from vibeam.maps.models import models_of
from vibeam.maps.plan import plan_over
from vibeam.maps.result import MapResult
from vibeam.maps.run import Progress, run_map
from vibeam.studies.fidelity_map.judgement import (
    Codes,
    ComparedModels,
    FidelityRow,
    cheapest,
    difference,
    doubtful,
    fidelity_row,
    motions,
    relative,
    share,
)
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import Array

FIRST, GROWTH = 3, 3  # places a side of the first map under a budget, and how many times as many the next has at most
WORTH = 1.5  # times as many places as the map before it that make another one worth its time


@dataclass(frozen=True)
class PlacePoint:
    """One place of the map: Hz, SI value of the key, model that suffices, and of each way and model kind and value."""

    frequency: float
    key: float
    suffices: str
    fidelity: str
    way: str
    kind: int
    value: float
    error: float
    coexist: int


@dataclass(frozen=True, eq=False, repr=False)
class FidelityMap(ComparedModels, ViewedTable):
    """Fidelity map of a case: ``models`` by their modes, cheapest first, the finest last; arrays (rows, columns).

    ``label``: index of the cheapest model that suffices; ``differences``: of each model in kind (``judgement``);
    ``relative``: of each model in value, the way where it is larger; ``refused``: sentences on fidelities left out.
    ``thinned``: places a side that were asked for and are computed, where a budget took some; None: all are.

    >>> import vibeam
    >>> size = {"points": 2, "frequencies": 2}
    >>> found = vibeam.fidelity_map("cases/dtu_neutral.toml", fidelities=["sdof", "two_modes"], **size)
    >>> sum(found.shares.values())
    1.0
    """

    label: Codes
    differences: tuple[Codes, ...]
    relative: tuple[Array, ...]
    rows: tuple[FidelityRow, ...]
    boundaries: tuple[PlaneBoundary, ...]
    refused: tuple[str, ...] = ()
    thinned: tuple[tuple[int, int], tuple[int, int]] | None = None

    @property
    def doubtful(self) -> float:
        """Share of the places with impacts where the label hangs on the scatter of motions that do not repeat."""
        return share(doubtful(self.models, self.asked, self.frequency), self.touched)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the places with impacts where each model is the cheapest that suffices; NaN without any."""
        return {model.name: share(self.label == index, self.touched) for index, model in enumerate(self.models)}

    @property
    def points(self) -> list[PlacePoint]:
        """All motions of all models, place by place."""
        frequency, values = self.frequency, self.values
        return [
            PlacePoint(
                float(frequency[column]), float(values[row]), self.models[self.label[row, column]].name,
                model.name, way, int(model.kind[at, row, column]), float(model.value[at, row, column]),
                float(model.error[at, row, column]), int(model.count[row, column]),
            )
            for row, column in np.ndindex(self.label.shape) for model in self.models
            for at, way in enumerate(("up", "down"))
        ]  # fmt: skip


@of_source
def fidelity_map(
    case: Case,
    over: str = "gap",
    low: str | float | None = None,
    high: str | float | None = None,
    points: int = 61,
    frequencies: int = 61,
    accuracy: str | float = "1 %",
    quantity: str = "amplitude",
    fidelities: Sequence[str] | None = None,
    *,
    out: str | Path | None = None,
    fresh: bool = False,
    progress: Progress | bool | None = None,
    budget: float | None = None,
    frequency_accuracy: str | float | None = None,
) -> FidelityMap:
    """Compute the fidelity map of a case over its frequencies and another of its keys.

    ``over``: "gap", "drive", "restitution" or any dotted key; ``low``, ``high``: its range, as a case has it, with unit
    (None: chosen, for gap and drive). ``accuracy`` of ``quantity`` ("amplitude" of the sweep's output or "reach" of the
    contact) against the fidelity with most modes, ``frequency_accuracy`` of where its branches end (None: a fifth).
    ``fidelities``: which, also where they change the rig; None: all that do not. ``out``, ``fresh``, ``progress``: as
    in ``run_map``; without ``out`` no file is kept. ``budget``: CPU seconds that the map may take: maps of 3 by 3
    places and more are computed, each foreseen by the one before it, and the last that ends in time is the answer.

    ValueError for arguments or a case that make no sense, fewer than two models included; CaseError for values of the
    key that the case may not have; StoreError for a file of another map.

    >>> import vibeam
    >>> size = {"points": 2, "frequencies": 2}
    >>> found = vibeam.fidelity_map("cases/dtu_neutral.toml", fidelities=["sdof", "two_modes"], **size)
    >>> found.label.shape, [model.name for model in found.models]  # the cheapest first
    ((2, 2), ['sdof', 'two_modes'])
    """
    plan = plan_over(
        case, "verdict", over, low, high, points_of(over, points, frequencies), accuracy=accuracy,
        fidelities=fidelities, quantity=quantity, frequency_accuracy=frequency_accuracy,
    )  # fmt: skip
    if budget is None:
        with _kept(out) as path:
            return fidelity_map_of(run_map(case, plan, path, fresh=fresh, progress=progress))
    if out is not None:
        raise ValueError("budget: the places that it leaves differ from run to run, so no file is kept: leave out away")
    return _within(case, plan, budget, progress)


@contextmanager
def _kept(out: str | Path | None) -> Iterator[Path]:
    """The file of a map: ``out``, or one that is gone in the end."""
    if out is not None:
        yield Path(out)
        return
    with TemporaryDirectory(prefix="vibeam-") as folder:
        yield Path(folder) / "verdict.h5"


def _within(case: Case, plan: MapPlan, budget: float, progress: Progress | bool | None) -> FidelityMap:
    """The map on as many places as the budget allows: maps of more and more, each foreseen by the one before it."""
    deadline, result = process_time() + budget, None
    full = [len(axis.values) for axis in plan.axes]
    size = [min(FIRST, count) for count in full]
    while True:
        begun = process_time()
        try:
            with ending_at(process_time, deadline), _kept(None) as path:
                result = run_map(case, _thinned(plan, size), path, progress=progress)
        except OutOfTime:
            break
        place = (process_time() - begun) / prod(size)
        larger = _larger(size, full, max(deadline - process_time(), 0.0) / place)
        if size == full or prod(larger) < min(WORTH * prod(size), prod(full)):
            break
        size = larger
    if result is None:
        raise ValueError(f"{size[0]} x {size[1]} places of a fidelity map take longer than {budget:g} s: allow more")
    found = fidelity_map_of(result)
    made = found.label.shape
    return found if list(made) == full else replace(found, thinned=((full[0], full[1]), (made[0], made[1])))


def _larger(size: Sequence[int], full: list[int], places: float) -> list[int]:
    """Places a side of a map of about so many in all: all, or at most ``GROWTH`` times as many a side as now."""
    if places >= prod(full):
        return full
    share = sqrt(places / prod(full))
    return [max(now, min(count, GROWTH * now, int(share * count))) for now, count in zip(size, full, strict=True)]


def _thinned(plan: MapPlan, counts: Sequence[int]) -> MapPlan:
    """The same ranges in fewer places."""
    axes = [
        replace(axis, values=tuple(np.linspace(axis.values[0], axis.values[-1], count).tolist()))
        for axis, count in zip(plan.axes, counts, strict=True)
    ]
    return replace(plan, axes=tuple(axes))


def fidelity_map_of(result: MapResult) -> FidelityMap:
    """Fidelity map of a finished map with ``picture = "verdict"``."""
    case, plan = result.case, result.plan
    flown = [
        motions(name, case.system(name).size, dict(each.values), plan.quantity)
        for name, each in result.responses.items()
    ]
    compared = ComparedModels(result, tuple(sorted(flown, key=lambda each: fineness(case, each.name, each.modes))))
    models, finest = compared.models, compared.finest
    drawn = flown if plan.boundaries else []
    bounds = [boundaries_of(case, model.name, plan.axes)[0] for model in drawn]  # in turn: small arrays, one lock
    return FidelityMap(
        result, models, cheapest(models, compared.asked, compared.frequency),
        tuple(difference(model, finest) for model in models), tuple(relative(model, finest) for model in models),
        tuple(fidelity_row(model, compared) for model in models),
        tuple(boundary for each in bounds for boundary in each), models_of(case, plan).notes,
    )  # fmt: skip
