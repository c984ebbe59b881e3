"""Display units of a case: a prefix that suits the size of its numbers, or nondimensional as in the paper."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, isinf, pi
from typing import TYPE_CHECKING

import numpy as np

from vibeam.figures.prefixes import FREQUENCIES, LENGTHS, SPEEDS, prefixed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.comparison import Comparison


@dataclass(frozen=True)
class Units:
    """Factors from SI (or the case's own unit) to the displayed unit, and its name (empty: no unit)."""

    length: str
    length_factor: float
    frequency: str
    frequency_factor: float
    speed: str = "mm/s"
    speed_factor: float = 1e3

    def lengths(self, value: float) -> str:
        """Length with its unit, to four digits; a dash for NaN."""
        return _with_unit(value * self.length_factor, self.length)

    def speeds(self, value: float) -> str:
        """Velocity with its unit, to four digits; a dash for NaN."""
        return _with_unit(value * self.speed_factor, self.speed)

    def frequencies(self, value: float) -> str:
        """Frequency with its unit; a dash for NaN."""
        return _with_unit(value * self.frequency_factor, self.frequency)

    def range(self, ends: tuple[float, float] | None) -> str:
        """Two frequencies as a range, without its unit; a dash for None."""
        if ends is None:
            return "–"
        low, high = (f"{end * self.frequency_factor:.5g}" for end in ends)
        return f"{low}–{high}"


METRIC = Units("mm", 1e3, "Hz", 1.0)


def units_of(case: Case, length: float = float("nan"), speed: float = float("nan")) -> Units:
    """Units by the sweep's frequencies, the largest ``length`` (m) and ``speed`` (m/s) to be shown; NaN: mm, mm/s.

    Of a model given without dimensions they are q, Ω/ω and dq/d(ω t).
    """
    from vibeam_models.scene import SdofScene

    scene = case.scene
    if isinstance(scene, SdofScene):
        return Units("", 1.0, "", 2 * pi / scene.natural_frequency, "", 1 / scene.natural_frequency)
    frequency = prefixed(FREQUENCIES, float(np.max(case.sweep.frequency, initial=0.0)), usual=-1)
    return Units(*prefixed(LENGTHS, length), *frequency, *prefixed(SPEEDS, speed))


def units_for(result: Comparison) -> Units:
    """Units of all figures and tables of a result: by its largest amplitude and the corresponding speed."""
    sizes = [
        (response.amplitude, 2 * pi * response.frequency * response.amplitude)
        for branches in result.values()
        for _, response in branches.items()
    ]
    length, speed = (max((_largest(size[index]) for size in sizes), default=0.0) for index in (0, 1))
    return units_of(result.case, length, speed)


def _largest(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    return float(np.max(values[np.isfinite(values)], initial=0.0))


def percent(value: float) -> str:
    """Share as percent, to three digits."""
    return f"{100 * value:.3g} %" if isfinite(value) else "∞" if isinf(value) else "–"


def signed(value: float) -> str:
    """Signed share as percent, to three digits; a power of ten where it is below 10⁻⁵."""
    if not isfinite(value):
        return "–"
    return f"{100 * value:+.3g} %" if abs(value) >= 1e-5 else "0" if value == 0 else f"{value:+.0e}"


def _with_unit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".strip() if isfinite(value) else "–"
