"""Disturbances of points, and what they come to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Disturbances(NamedTuple):
    """Of m points: how long each is carried along, columns of (δη, δη'), and how they grow."""

    periods: NDArray[np.int64]  # (m,) drive periods
    columns: NDArray[np.float64]  # (m, c, 2, n), in place of which what they have become is put
    growth: NDArray[np.float64]  # (m, p) factor in each period of the one column, then of size 1; or p = 0
    ended: NDArray[np.int64]  # (m, 2): outcome, LOST where a direction is lost or rests are met


LOST = 1
