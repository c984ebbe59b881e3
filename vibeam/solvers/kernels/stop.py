"""On the stop exactly: round-off in the contact's place and velocity taken out of all modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.jit import joined
from vibeam.solvers.kernels.layout import CONTACT, GAP, MOBILITY, YIELD

Array = NDArray[np.float64]
ROUND_OFF = 4.0 * 2.220446049250313e-16


@joined
def less(a: float, b: float) -> float:
    """a − b, and 0 where that is no more than their round-off: so that one mode put onto the stop lies still there."""
    difference = a - b
    return difference if abs(difference) > ROUND_OFF * abs(b) else 0.0


@joined
def put_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Move the contact exactly onto the stop, from where it is to round-off, with the least energy."""
    beyond = -drive[GAP]
    for k in range(modes.shape[1]):
        beyond += modes[CONTACT, k] * pose[0, k]
    for k in range(modes.shape[1]):
        pose[0, k] = less(pose[0, k], modes[YIELD, k] * beyond)


@joined
def settle_on_stop(modes: Array, drive: Array, pose: Array) -> None:
    """Take contact velocity out by the least impulse, and penetration by round-off with the least energy."""
    put_on_stop(modes, drive, pose)
    slope = 0.0
    for k in range(modes.shape[1]):
        slope += modes[CONTACT, k] * pose[1, k]
    for k in range(modes.shape[1]):
        pose[1, k] = less(pose[1, k], modes[CONTACT, k] * slope / drive[MOBILITY])
