"""Axes of a grid of case keys, and what each key decides: a number of the points, or the structure itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import is_structural

Indices = Mapping[str, NDArray[np.int64]]
Settings = Mapping[str, float]  # values of keys, SI


@dataclass(frozen=True)
class Axis:
    """One axis: a dotted key of the case and its values in SI (frequencies in Hz), in the order swept."""

    key: str
    values: tuple[float, ...]

    @property
    def structural(self) -> bool:
        """Test whether the system has to be built anew for each value."""
        return is_structural(self.key)


def shape_of(axes: Sequence[Axis]) -> tuple[int, ...]:
    """Number of values of each axis."""
    return tuple(len(axis.values) for axis in axes)


def lines_of(axes: Sequence[Axis]) -> int:
    """Number of lines: points of all axes but the last."""
    return prod(shape_of(axes)[:-1])


def indices(axes: Sequence[Axis], lines: NDArray[np.int64]) -> Indices:
    """Index along each axis of the points of some ``lines``, (lines, points of the last axis) each."""
    *above, last = axes
    size = (len(lines), len(last.values))
    places = np.unravel_index(lines, shape_of(above)) if above else ()
    found = {axis.key: np.broadcast_to(each[:, None], size) for axis, each in zip(above, places, strict=True)}
    return found | {last.key: np.broadcast_to(np.arange(size[1]), size)}


@dataclass(frozen=True)
class Combinations:
    """The distinct ``settings`` among some points, and ``which`` of them each point has."""

    settings: tuple[Settings, ...]
    which: NDArray[np.int64]


def combinations(axes: Sequence[Axis], index: Indices, keys: Sequence[str]) -> Combinations:
    """Combinations of the values of those axes whose keys are among ``keys``."""
    mine = [axis for axis in axes if axis.key in keys]
    size = next(iter(index.values())).shape
    if not mine:
        return Combinations(({},), np.zeros(size, dtype=np.int64))
    flat = np.ravel_multi_index([index[axis.key] for axis in mine], shape_of(mine))
    numbers, which = np.unique(flat, return_inverse=True)
    rows = np.array(np.unravel_index(numbers, shape_of(mine))).T
    settings = ({axis.key: axis.values[at] for axis, at in zip(mine, row, strict=True)} for row in rows)
    return Combinations(tuple(settings), which.reshape(size))


def values_at(axes: Sequence[Axis], index: Indices, key: str) -> NDArray[np.float64] | None:
    """Values of one key at the points; None where it is no axis."""
    axis = next((axis for axis in axes if axis.key == key), None)
    return None if axis is None else np.array(axis.values)[index[key]]
