"""What some blocks of a map hold, the rest unknown: for a picture of a map under way."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.maps.axes import shape_of
from vibeam.maps.block import DTYPES, Block, Grid, Values
from vibeam.maps.evaluate import GridResponse
from vibeam.maps.refined import over_grid
from vibeam.maps.store.gathered import SHOWN, steps_of
from vibeam.system.ended import Ended

ASIDE = ("state", "resting")  # shown by no picture of a map under way


def partial_response(grid: Grid, known: Iterable[tuple[Block, Values | None]], most: int = SHOWN) -> GridResponse:
    """Response of the blocks that are ``known``; a point of any other is NaN and not run yet."""
    if grid.refine:
        return _refined(grid, known, most)
    steps, lines = steps_of(grid, most), np.arange(grid.lines)
    above = shape_of(grid.axes)[:-1]
    kept = np.ones(grid.lines, dtype=bool)
    for place, step in zip(np.unravel_index(lines, above) if above else (), steps, strict=False):
        kept &= place % step == 0
    rows = np.cumsum(kept) - 1
    shown = [name for name in grid.quantities if name not in ASIDE]
    values = {name: _blank(grid, name, int(kept.sum()), steps[-1]) for name in shown}
    for block, found in known:
        mine = np.flatnonzero(kept[block.first : block.last])
        for name, each in (found or {}).items() if mine.size else ():
            if name not in values:
                continue
            values[name][rows[block.first + mine]] = each[mine][:, :, :: steps[-1]]
    axes = {axis.key: np.array(axis.values)[::step] for axis, step in zip(grid.axes, steps, strict=True)}
    shape = tuple(len(each) for each in axes.values())
    made = {name: each.reshape(*shape[:-1], *each.shape[1:]) for name, each in values.items()}
    return GridResponse(
        grid.fidelity, axes, grid.ways or ("apart",),
        {name: np.moveaxis(each, len(shape) - 1, 0) for name, each in made.items()},
    )  # fmt: skip


def _refined(grid: Grid, known: Iterable[tuple[Block, Values | None]], most: int) -> GridResponse:
    """Response of a refined grid: the label of a point that is not flown yet is that of a corner of its cell."""
    there = [(block, values) for block, values in known if values is not None]
    steps, every = steps_of(grid, most), over_grid(grid, there, grid.quantities)
    where = (slice(None), *(slice(None, None, step) for step in steps))
    axes = {axis.key: np.array(axis.values)[::step] for axis, step in zip(grid.axes, steps, strict=True)}
    return GridResponse(grid.fidelity, axes, ("apart",), {name: values[where] for name, values in every.items()})


def _blank(grid: Grid, name: str, lines: int, step: int) -> NDArray[Any]:
    """Values of points that are not run yet."""
    ways, columns, *starts = grid.shape
    more = (grid.strobes,) if name == "strobes" else ()
    unknown = {"ended": Ended.NOT_RUN.code, "period": 0}.get(name, np.nan)
    return np.full((lines, ways, -(-columns // step), *starts, *more), unknown, DTYPES.get(name, float))
