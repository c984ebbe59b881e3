"""How close a periodic motion comes to the stop between its impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from vibeam.periodic.motion import carried, state_after
from vibeam.system import Drive, ImpactSystem

Array = NDArray[np.float64]
SAMPLES = 12  # a turn of the fastest mode
MOST = 20_000


def clearance(system: ImpactSystem, drive: Drive, periods: int, phase: float, impulse: float) -> float:
    """The least of the local minima of gap − contact displacement strictly between two impacts, m; ∞ without any.

    The contact velocity is sampled twelve times a turn of the fastest mode and its roots are refined to round-off.
    """
    state, begin = state_after(system, drive, periods, phase, impulse), phase / drive.omega
    span = 2 * np.pi * periods / drive.omega
    rate = max(drive.omega, float(np.max(system.omega[system.contact != 0])))
    count = min(MOST, max(32, int(np.ceil(SAMPLES * rate * span / (2 * np.pi)))))
    times = begin + span * np.linspace(0, 1, count + 1)

    def speed(t: float) -> float:
        return float(carried(system, drive, state, begin, np.array([t]))[1][0] @ system.contact)

    speeds = carried(system, drive, state, begin, times)[1] @ system.contact
    tops = [brentq(speed, times[i], times[i + 1], xtol=1e-15 * span) for i in _summits(speeds)]
    if not tops:
        return np.inf
    heights = carried(system, drive, state, begin, np.array(tops))[0] @ system.contact
    return float(system.gap - heights.max())


def _summits(speeds: Array) -> NDArray[np.int64]:
    """Where the velocity falls through zero; neither end counts: it leaves the stop there, and comes to it."""
    return np.flatnonzero((speeds[1:-2] > 0) & (speeds[2:-1] <= 0)) + 1
