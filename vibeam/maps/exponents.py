"""Largest Lyapunov exponent of every point of a grid, from the state that it settled in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.pause import pause
from vibeam.orbits.lyapunov import lyapunov
from vibeam.system.ended import Ended
from vibeam.system.state import State

if TYPE_CHECKING:
    from vibeam.batch.response import BatchResponse
    from vibeam.maps.points import GridPoints

LEAST = 20  # drive periods of a mean, which has an error from so many batches


def largest_exponents(
    points: GridPoints, part: Any, response: BatchResponse, periods: int
) -> NDArray[np.float64]:  # fmt: skip
    """Largest exponents (1/s) of the points ``part``, of the shape of the ``response``; NaN where there is none.

    A motion that repeats has that of its multipliers; of any other it is a mean over ``periods`` drive periods.
    """
    shape = response.shape
    own = np.arange(points.omega.size).reshape(points.omega.shape)[part]
    places = np.broadcast_to(own.reshape(*own.shape, *(1,) * (len(shape) - own.ndim)), shape).ravel()
    found = np.full(places.size, np.nan)
    n = response.state.shape[-1] // 2
    states, resting = response.state.reshape(-1, 2 * n), response.resting.ravel()
    for at in np.flatnonzero(response.ended.ravel() == Ended.COMPLETE.code):
        pause()
        system, drive = points.system_at(places[at]), points.drive_at(places[at])
        state = State(states[at, :n], states[at, n:], bool(resting[at]))
        try:
            spectrum = lyapunov(system, drive, state, settle=0, periods=max(periods, LEAST), count=1)
        except (ValueError, ArithmeticError):  # a law without tangent maps, or a motion that ended on the way
            continue
        found[at] = spectrum.largest
    return found.reshape(shape)
