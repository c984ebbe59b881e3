"""Curves over frequency: all motions of one kind, unstable ones too; a curve's peak, and the difference of two."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from vibeam_models.arrays import Array, Flags, Index, ValueRecord

BRANCHES = 2  # two roots of the quadratic for motions with one impact a span


def evenly(first: int, last: int, most: int) -> Index:
    """Whole numbers from ``first`` to ``last``, both among them, at most ``most`` and evenly spread."""
    return np.unique(np.linspace(first, last, min(most, last - first + 1)).round().astype(int))


@dataclass(frozen=True, eq=False, repr=False)
class MotionCurves(ValueRecord):
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


NAN = float("nan")


@dataclass(frozen=True)
class Peak:
    """Peak of a curve: its highest complete point, one whose hold was flown to its end, whether it repeats or not.

    ``amplitude`` in the unit of the output, ``frequency`` in Hz, ``direction`` of the sweep where several were made,
    ``point``: index of the point in its branch. ``repeats``: its motion is periodic. NaN and −1 without such a point.
    """

    amplitude: float = NAN
    frequency: float = NAN
    direction: str = ""
    point: int = -1
    repeats: bool = False


@dataclass(frozen=True)
class Difference:
    """Relative difference in amplitude: of the ``peak``'s height, and over ``points`` of ``total`` frequencies.

    NaN where unknown; ``peak`` and ``worst``, the largest in size, are signed.
    """

    peak: float = NAN
    rms: float = NAN
    worst: float = NAN
    points: int = 0
    total: int = 0

    @classmethod
    def of(cls, relative: Array, total: int, peak: float = NAN) -> Self:
        """Difference whose values at the points compared are ``relative``."""
        if not len(relative):
            return cls(peak, total=total)
        worst = float(relative[np.argmax(np.abs(relative))])
        return cls(peak, float(np.sqrt(np.mean(relative**2))), worst, len(relative), total)
