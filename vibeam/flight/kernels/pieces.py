"""Where things stand in the arrays of a certificate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FLIGHT, FROM, LENGTH, CLAIM = range(4)  # columns of a piece

COLUMNS = 4

OPEN, CLOSES, UNPROVED = 0.0, 1.0, 2.0  # claims


class Flights(NamedTuple):
    """The segments of a motion, and the root with which the gap of each starts (``roots.signal.Start``)."""

    trace: Array  # (m, TRACE_COLUMNS)
    poses: Array  # (m, 2, n)
    orders: Array  # (m,)
    rises: Array  # (m,)
