"""Refined grids: points flown pass by pass, and the values of all points from those flown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import STARTS
from vibeam.maps.axes import shape_of
from vibeam.maps.block import DTYPES, Block, Grid, Values
from vibeam.maps.motions import READ, at_one_place
from vibeam.maps.quadtree import UNFLOWN, Quadtree
from vibeam.system.ended import Ended

PERIODS, MOTIONS = ("period", "rest", "ended"), ("period", "impacts_per_period", "ended", *READ)
NO_IMPACT, FAILED = 1000, 2000  # labels; of a motion with impacts: its period
PARTS, LEAST = 8, 64  # blocks of a pass at least, and points of one of these
FLOWN = "flown"


def label_quantities(grid: Grid) -> tuple[str, ...]:
    """Quantities that decide a label: of starts what tells motions apart, else the period."""
    return MOTIONS if all(axis.key in STARTS for axis in grid.axes[-2:]) else PERIODS


def labels_of(grid: Grid, values: Mapping[str, NDArray[Any]]) -> NDArray[np.int64]:
    """Labels of points (points,), by the numbers of ``label_quantities``."""
    if label_quantities(grid) == PERIODS:
        from vibeam.figures.motion_classes import RESTING

        idle = (values["period"] < 0) | (values["rest"] > RESTING)
        labels = np.where(idle, NO_IMPACT, values["period"])
        return np.where(values["ended"] == Ended.COMPLETE.code, labels, FAILED + values["ended"]).astype(np.int64)
    labels = FAILED + values["ended"].astype(np.int64)
    for number, (_, points, _) in enumerate(at_one_place(dict(values))):
        labels[points] = number
    return labels


def quadtree_of(grid: Grid) -> Quadtree:
    """Quadtree over the last two axes."""
    *outer, rows, columns = shape_of(grid.axes)
    return Quadtree((prod(outer), rows, columns), grid.refine)


class Passes:
    """Passes over a refined grid in blocks of up to ``size`` points: each follows from the numbers of those before."""

    def __init__(self, grid: Grid, size: int) -> None:
        self.grid, self.size, self.tree = grid, size, quadtree_of(grid)
        self._flown = np.zeros(prod(self.tree.shape), dtype=bool)
        self._values: Values = {}
        self._count = 0

    def first(self) -> list[Block]:
        """Blocks of the coarse grid."""
        return self._blocks(self.tree.coarse())

    def following(self, found: Iterable[tuple[Block, Values]]) -> list[Block]:
        """Blocks of the next pass, after all of the pass before; none at the end."""
        for block, values in found:
            assert block.points is not None
            self._flown[block.points] = True
            for name in label_quantities(self.grid):
                kept = self._values.setdefault(name, np.empty(self._flown.size, DTYPES.get(name, float)))
                kept[block.points] = values[name][:, 0, 0]
        labels = np.full(self._flown.size, UNFLOWN, dtype=np.int64)
        labels[self._flown] = labels_of(self.grid, {name: each[self._flown] for name, each in self._values.items()})
        return self._blocks(self.tree.ahead(labels))

    def _blocks(self, points: NDArray[np.int64]) -> list[Block]:
        size = min(self.size, max(LEAST, ceil(len(points) / PARTS)))
        parts = [points[at : at + size] for at in range(0, len(points), size)]
        found = []
        for part in parts:
            found.append(Block(self.grid, self._count, self._count + len(part), part))
            self._count += len(part)
        return found


def over_grid(grid: Grid, known: Iterable[tuple[Block, Values]], names: Iterable[str]) -> Values:
    """Values (1, axis 1, axis 2, …) of all points, and which were ``flown``.

    What decides the label is that of a flown corner of the cell; any other number of a point that was not flown is NaN.
    """
    blocks = list(known)
    parts = [block.points for block, _ in blocks if block.points is not None]
    points = np.concatenate([np.zeros(0, dtype=np.int64), *parts])
    total, shape = prod(shape_of(grid.axes)), (1, *shape_of(grid.axes))
    flown, place = np.zeros(total, dtype=bool), np.full(total, -1)
    flown[points], place[points] = True, np.arange(len(points))
    sources, copied = quadtree_of(grid).sources(flown), label_quantities(grid)
    rows = np.where(sources < 0, -1, place[sources])
    found: Values = {FLOWN: flown.reshape(shape).astype(np.uint8)}
    for name in names:
        own = np.concatenate([values[name][:, 0, 0] for _, values in blocks]) if blocks else np.zeros(0)
        which = rows if name in copied else place
        blank = {"ended": Ended.NOT_RUN.code, "period": 0}.get(name, 0 if name in DTYPES else np.nan)
        each = np.full((total, *own.shape[1:]), blank, dtype=DTYPES.get(name, float))
        each[which >= 0] = own[which[which >= 0]]
        found[name] = each.reshape(*shape, *own.shape[1:])
    return found
