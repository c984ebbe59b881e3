"""Period of a motion in drive periods, and its class in a map."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.system.quantities import Ended
from vibeam_models.arrays import Array


def strobe_time(hits: Array, begin: float, span: float) -> float:
    """Time in the first drive period, of ``span`` s from ``begin`` on, as far as possible from the impacts ``hits``.

    At an impact round-off would matter most.
    """
    if not len(hits):
        return begin
    phases = np.sort(np.mod(hits - begin, span))
    gaps = np.diff(np.append(phases, phases[0] + span))
    widest = int(np.argmax(gaps))
    return begin + float(np.mod(phases[widest] + gaps[widest] / 2, span))


LONGEST_PERIOD = 16


def repetition(strobes: Array, omega: Array, drive: float, tolerance: float, longest: int = LONGEST_PERIOD) -> int:
    """Least k ≤ longest such that each of the last k strobes (m, 2, n) repeats the one k periods before, else 0.

    Distances are in velocity units, ``omega`` (n,) and ``drive`` rad/s; ``tolerance`` is a share of the largest strobe.
    """
    weights = np.stack([omega**2 + drive**2, np.ones_like(omega)])
    size = float(np.max(np.sum(weights * strobes**2, axis=(1, 2))))
    hold = len(strobes) - 1
    for k in range(1, min(longest, hold // 2) + 1):
        steps = strobes[hold - k + 1 :] - strobes[hold - 2 * k + 1 : hold - k + 1]
        if np.max(np.sum(weights * steps**2, axis=(1, 2))) <= tolerance**2 * size:
            return k
    return 0


RESTING = 0.999  # share of the time on the stop from which a motion has no impacts


class Class(IntEnum):
    """Class of a motion in the map."""

    NO_IMPACT = 0
    PERIOD_ONE = 1
    PERIOD_TWO = 2
    PERIOD_MORE = 3
    NOT_PERIODIC = 4
    FAILED = 5


def classes(period: NDArray[Any], rest: NDArray[Any], ended: NDArray[Any]) -> NDArray[np.int_]:
    """Class of the motion at every point, of the shape of the arguments: period, share at rest, code of ``Ended``."""
    found = np.select([period > 2, period > 0], [Class.PERIOD_MORE, period], Class.NOT_PERIODIC)
    found = np.where((period < 0) | (rest > RESTING), Class.NO_IMPACT, found)
    return np.where(ended == Ended.COMPLETE.code, found, Class.FAILED)
