"""Result of a map, and the shares of its classes of motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.grid_keys import MapPlan
from vibeam.maps.evaluate import GridResponse
from vibeam.observe.periodicity import Class, classes
from vibeam.system.labelled import DataNames, LabelledData, LabelledPart
from vibeam_models.arrays import ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case


@dataclass(frozen=True, eq=False, repr=False)
class MapResult(ValueRecord, LabelledData):
    """A map: quantities of each fidelity (of very many points every so many along the last two axes).

    ``points`` in all, of which ``found`` were on disk before. ``path``: its file.

    >>> import vibeam
    >>> axes = [{"key": "sweep.frequency", "values": ["14 Hz", "15 Hz"]}]
    >>> asked = {"axes": axes, "fidelities": ["sdof"], "picture": "values", "direction": "up"}
    >>> result = vibeam.run_map(vibeam.load("cases/dtu_neutral.toml", {"map.line": asked}), "line", "line.h5")
    >>> result.points, list(result.responses)
    (2, ['sdof'])
    """

    case: Case
    plan: MapPlan
    responses: Mapping[str, GridResponse]
    points: int
    found: int
    path: Path

    def __getitem__(self, fidelity: str) -> GridResponse:
        return self.responses[fidelity]

    def _parts(self) -> list[LabelledPart]:
        return [part for each in self.responses.values() for part in each._parts()]

    @property
    def _names(self) -> DataNames:
        return next(iter(self.responses.values())).of_case(self.case, self.plan.output).names


class StudyOfMap:
    """Study of a finished map, whose case and plan are those of its ``result``."""

    result: MapResult

    @property
    def case(self) -> Case:
        """Case of the map."""
        return self.result.case

    @property
    def plan(self) -> MapPlan:
        """Axes of the map, and what its picture asks for."""
        return self.result.plan


@dataclass(frozen=True)
class MapRow:
    """One fidelity swept one way, at one value of the outer axis of three: shares of the points by their motion."""

    map: str
    fidelity: str
    direction: str
    at: str
    points: int
    no_impact: float
    period_1: float
    period_2: float
    period_more: float
    not_periodic: float
    failed: float


def rows_of(result: MapResult) -> Iterator[MapRow]:
    """Rows of a map; of one that is read back every so many points, of these."""
    plan = result.plan
    outer = plan.axes[0] if len(plan.axes) > 2 else None
    for fidelity, response in result.responses.items():
        for number, way in enumerate(response.ways):
            rest = response.values.get("rest")
            period, ended = (response.values[name][number] for name in ("period", "ended"))
            resting = np.zeros(period.shape) if rest is None else rest[number]
            found = classes(period, resting, ended)
            places = [""] if outer is None else [f"{outer.key} = {value:.6g}" for value in outer.values]
            for at, part in zip(places, found if outer else [found], strict=True):
                shares = [float(np.mean(part == each)) for each in Class]
                yield MapRow(plan.name, fidelity, way, at, part.size, *shares)
