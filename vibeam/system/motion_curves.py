"""All steady motions of one kind over frequency, unstable ones included, which a sweep cannot reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array, Flags

BRANCHES = 2  # two roots of the quadratic for motions with one impact a span


@dataclass(frozen=True)
class MotionCurves:
    """Both branches of motions with one impact per ``periods`` drive periods; arrays (points, 2), the larger first.

    SI units. NaN where there is no such motion; one that passes through the stop between its impacts (``admissible``
    False) has a ``velocity``, but neither amplitude nor reach. Frequencies ascend.
    """

    frequency: Array  #: drive frequency (points,), Hz
    periods: int
    amplitude: Array  #: ½(max − min) of the chosen output
    reach: Array  #: gap − min of the contact displacement, m
    velocity: Array  #: of the contact just before impact, m/s
    stable: Flags  #: all Floquet multipliers within the unit circle; False where there is no motion
    admissible: Flags  #: it keeps clear of the stop between its impacts; False where there is no motion

    def __repr__(self) -> str:
        found, stable = np.count_nonzero(self.admissible), np.count_nonzero(self.admissible & self.stable)
        return (
            f"MotionCurves({len(self.frequency)} frequencies, periods={self.periods}, {found} motions, {stable} stable)"
        )

    @classmethod
    def empty(cls, frequency: Array, periods: int) -> MotionCurves:
        """No motion anywhere."""
        shape = (len(frequency), BRANCHES)
        nothing = {name: np.full(shape, np.nan) for name in ("amplitude", "reach", "velocity")}
        never = {name: np.zeros(shape, dtype=bool) for name in ("stable", "admissible")}
        return cls(frequency=np.asarray(frequency, dtype=float), periods=periods, **nothing, **never)
