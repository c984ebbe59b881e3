"""Peak of a response, and difference of two responses: the one record of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
    def of(cls, relative: NDArray[np.float64], total: int, peak: float = NAN) -> Difference:
        """Difference whose values at the points compared are ``relative``."""
        if not len(relative):
            return cls(peak, total=total)
        worst = float(relative[np.argmax(np.abs(relative))])
        return cls(peak, float(np.sqrt(np.mean(relative**2))), worst, len(relative), total)
