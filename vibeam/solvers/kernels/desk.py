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
    no_attached: Array
    blocks: Array
    to_blocks: Array  # (2(n−1), 2n): block coordinates from (η − held, η')
    from_blocks: Array  # (2n, 2(n−1))
    held: Array  # (n,) contact · gap / Σ contact²
