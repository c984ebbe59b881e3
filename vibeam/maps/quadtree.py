"""Quadtree over a plane of points: which to fly next where labels differ, and whose label the others have.

At level 0 every 2^N-th point of both axes is flown, and the last ones. A cell is the closed rectangle between
neighbouring stations of a level; it is divided where points in it that were flown, also those on its sides that a
neighbour brought, have different labels. So an island of another label is missed where no station meets it and no
divided cell touches it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Flags

Ints = NDArray[np.int64]


UNFLOWN = -1  # label


@dataclass(frozen=True)
class Quadtree:
    """Planes of ``shape`` (planes, rows, columns); ``levels``: how often a cell is halved at most."""

    shape: tuple[int, int, int]
    levels: int

    def stations(self, level: int) -> tuple[Ints, Ints]:
        """Rows and columns of a level: every 2^(levels − level)-th, and the last."""
        step = 2 ** (self.levels - level)
        rows, columns = (np.append(np.arange(0, size - 1, step), size - 1) for size in self.shape[1:])
        return rows, columns

    def coarse(self) -> Ints:
        """Points of level 0, flat."""
        wanted = np.zeros(self.shape, dtype=bool)
        wanted[np.ix_(np.arange(self.shape[0]), *self.stations(0))] = True
        return np.flatnonzero(wanted)

    def ahead(self, labels: Ints) -> Ints:
        """Points to fly next, flat, by the labels (points,) of those flown; none: all cells are decided."""
        known = labels.reshape(self.shape)
        wanted = np.zeros(self.shape, dtype=bool)
        for level in range(self.levels):
            rows, columns = self.stations(level)
            cells = _corners(known != UNFLOWN, rows, columns) & _differing(known, rows, columns)
            finer = self.stations(level + 1)
            places = np.ix_(np.arange(self.shape[0]), *finer)
            wanted[places] |= _touched(cells, rows, columns, *finer)
        return np.flatnonzero(wanted & (known == UNFLOWN))

    def sources(self, flown: Flags) -> Ints:
        """For each point the flown one whose label it has, flat: itself, or a corner of its cell; −1: none yet."""
        planes, height, width = self.shape
        found = np.full(self.shape, -1)
        for level in range(self.levels):
            rows, columns = self.stations(level)
            cells = _corners(flown.reshape(self.shape), rows, columns)
            row, column = (
                _cell(each, np.arange(size)) for each, size in zip((rows, columns), (height, width), strict=True)
            )
            corner = _nearer(rows, row)[:, None] * width + _nearer(columns, column)
            corner = corner + np.arange(planes)[:, None, None] * height * width
            found = np.where(cells[:, row][:, :, column], corner, found)
        return np.where(flown, np.arange(flown.size), found.ravel())


def _cell(stations: Ints, places: Ints) -> Ints:
    """Number of the cell that begins at or before each place."""
    return np.clip(np.searchsorted(stations, places, "right") - 1, 0, len(stations) - 2)


def _nearer(stations: Ints, cell: Ints) -> Ints:
    """The nearer end of the cell of each place in order."""
    places, begin, end = np.arange(len(cell)), stations[cell], stations[cell + 1]
    return np.where(places - begin > end - places, end, begin)


def _corners(flown: Flags, rows: Ints, columns: Ints) -> Flags:
    """Cells all of whose corners are flown."""
    there = flown[:, rows][:, :, columns]
    return there[:, :-1, :-1] & there[:, 1:, :-1] & there[:, :-1, 1:] & there[:, 1:, 1:]


def _differing(labels: Ints, rows: Ints, columns: Ints) -> Flags:
    """Closed cells in which labels differ."""
    low = np.where(labels == UNFLOWN, np.iinfo(np.int64).max, labels)
    return _over(np.maximum, labels, rows, columns) > _over(np.minimum, low, rows, columns)


def _over(extreme: np.ufunc, values: Ints, rows: Ints, columns: Ints) -> Ints:
    """Extreme over each closed cell."""
    for axis, stations in ((1, rows), (2, columns)):
        ends = np.take(values, stations[1:], axis=axis)
        values = extreme(extreme.reduceat(values, stations[:-1], axis=axis), ends)
    return values


def _touched(cells: Flags, rows: Ints, columns: Ints, finer_rows: Ints, finer_columns: Ints) -> Flags:
    """Finer stations that lie in a marked cell, or on its sides."""
    found = np.zeros((len(cells), len(finer_rows), len(finer_columns)), dtype=bool)
    for row in _beside(rows, finer_rows):
        for column in _beside(columns, finer_columns):
            found |= cells[:, row][:, :, column]
    return found


def _beside(stations: Ints, places: Ints) -> tuple[Ints, Ints]:
    """Cells to both sides of places, the same where one is inside."""
    before = np.clip(np.searchsorted(stations, places, "left") - 1, 0, len(stations) - 2)
    return before, _cell(stations, places)
