"""Pieces of a branch: cut at changes of the class of motion and at jumps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vibeam.system.curves import MotionCurves
from vibeam.system.response import FrequencyResponse, complete
from vibeam_models.arrays import Array

STEEP = 5.0  # a step is a jump if it is this many times its larger neighbour …
STEEP_ELSEWHERE = 3.0  # … this many times where the number of impacts changes too …
LARGE = 0.05  # … and at least this share of the range


class MotionClass(Enum):
    """Class of a motion; the value is its legend entry."""

    PERIOD_ONE = "period 1"
    PERIOD_MORE = "period 2 … 16"
    NO_CONTACT = "no contact"
    NOT_PERIODIC = "not periodic"
    FAILED = "failed"


@dataclass(frozen=True)
class BranchPiece:
    """Neighbouring points of one class on one branch, as the range of their indices."""

    kind: MotionClass
    points: slice

    def __len__(self) -> int:
        return int(self.points.stop - self.points.start)


@dataclass(frozen=True)
class MotionPiece:
    """Neighbouring points of one branch, of equal stability: frequency in Hz and amplitude (points,)."""

    stable: bool
    frequency: Array
    amplitude: Array


def motion_pieces(curves: MotionCurves, quantity: str = "amplitude") -> Iterator[MotionPiece]:
    """Admissible motions, cut where they end; a change of stability is joined to the point before it.

    ``quantity``: what stands as their amplitude, also ``"reach"``.
    """
    values = getattr(curves, quantity)
    for branch in range(curves.amplitude.shape[1]):
        shown = curves.admissible[:, branch]
        kind = np.where(shown, curves.stable[:, branch], -1)
        cuts = np.flatnonzero(np.diff(kind)) + 1
        for points in np.split(np.arange(len(kind)), cuts):
            if len(points) and shown[points[0]]:
                before = points[0] - 1
                joined = np.append(before, points) if before >= 0 and shown[before] else points
                stable = bool(curves.stable[points[0], branch])
                yield MotionPiece(stable, curves.frequency[joined], values[joined, branch])


def pieces(response: FrequencyResponse, values: Array | None = None) -> Iterator[BranchPiece]:
    """Branch cut where the period changes, or where the amplitude jumps or ``values`` (points,), drawn in its place."""
    if not len(response):
        return
    period = np.where(complete(response), response.period, -2)
    cut = np.diff(period) != 0
    for each in [response.amplitude] if values is None else [response.amplitude, values]:
        cut |= jumps(each, period, response.impacts_per_period)
    ends = [0, *(np.flatnonzero(cut) + 1).tolist(), len(response)]
    for begin, end in pairwise(ends):
        yield BranchPiece(_kind(int(period[begin])), slice(begin, end))


def jumps(values: Array, period: NDArray[np.int64], impacts: Array) -> NDArray[np.bool_]:
    """Mask of the steps (points − 1,) that are jumps: steep compared with the steps next to them, and large.

    ``impacts``: impacts a drive period. Where their number changes another branch of motions may begin, of the same
    period; a motion that grazes gains an impact and goes on smoothly.
    """
    if len(values) < 2:
        return np.zeros(0, dtype=bool)
    alike = np.diff(period) == 0
    step = np.where(alike & np.isfinite(np.diff(values)), np.abs(np.diff(values)), 0.0)
    around = np.concatenate(([0.0], step, [0.0]))
    beside = np.maximum(around[:-2], around[2:])
    steep = np.where(np.diff(impacts) != 0, STEEP_ELSEWHERE, STEEP)
    finite = values[np.isfinite(values)]
    extent = np.ptp(finite) if len(finite) else 0.0
    return np.asarray((step > steep * beside) & (step > LARGE * extent))


def _kind(period: int) -> MotionClass:
    special = {
        -2: MotionClass.FAILED,
        -1: MotionClass.NO_CONTACT,
        0: MotionClass.NOT_PERIODIC,
        1: MotionClass.PERIOD_ONE,
    }
    return special.get(period, MotionClass.PERIOD_MORE)
