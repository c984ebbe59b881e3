"""The desk: all arrays that one run of one system under one drive works on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Desk(NamedTuple):
    """See ``layout`` for the rows. The free system and the system at rest have a signal's arrays each."""

    pairs: Array
    table: Array
    levels: Array
    signal: Array
    attached: Array
    modes: Array
    drive: Array
    rest_pairs: Array
    rest_table: Array
    rest_levels: Array
    rest_signal: Array
    rest_attached: Array
    blocks: Array
    to_blocks: Array  # (2(n−1), 2n): block coordinates from (η − held, η')
    from_blocks: Array  # (2n, 2(n−1))
    held: Array  # (n,) contact · gap / Σ contact²
    cells: Array  # the free system in blocks of modes, see ``cells``; empty where that cannot be
    rungs: Array


class Room(NamedTuple):
    """What a point of a sweep is watched with: an output's rows, the segments traced, what is read off them."""

    row: Array  # (n,) the output in flight
    rest_row: Array  # (2, n − 1) and at rest
    nothing: Array  # (0, TRACE_COLUMNS): no trace is kept
    trace: Array  # (m, TRACE_COLUMNS)
    poses: Array  # (m, 2, n)
    strobes: Array  # (hold + 1, 2, n)
    scratch: Array  # (2, n)
    frame: Array  # (2, n)
    result: Array  # (RESULT_ROWS,)
    energy: Array  # (n,) ∫ E dt of each mode
    share: Array  # (n + 1,) what the last period watched added to it, and to the time at rest
    reading: int  # how much is read off: see ``layout``
