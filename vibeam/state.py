"""The state that passes from one computation to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class State:
    """Modal displacement and velocity (n,) of an ImpactSystem; ``resting``: in lasting contact with the stop.

    The drive's phase is not part of it: a computation says at which time it starts.
    """

    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]
    resting: bool = False
