"""In which units a case is shown: mm and Hz, or the nondimensional quantities of the paper."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, isinf, pi
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.case import Case


@dataclass(frozen=True)
class Units:
    """Factors from the unit of a response to the one shown, and what that is called (empty: no unit)."""

    length: str
    length_factor: float
    frequency: str
    frequency_factor: float

    def lengths(self, value: float) -> str:
        """A length with its unit, to four digits; a dash where there is no number."""
        return _with_unit(value * self.length_factor, self.length)

    def frequencies(self, value: float) -> str:
        """A frequency with its unit; a dash where there is no number."""
        return _with_unit(value * self.frequency_factor, self.frequency)

    def range(self, ends: tuple[float, float] | None) -> str:
        """Two frequencies as a range, without its unit; a dash for None."""
        if ends is None:
            return "–"
        low, high = (f"{end * self.frequency_factor:.5g}" for end in ends)
        return f"{low}–{high}"


METRIC = Units("mm", 1e3, "Hz", 1.0)


@dataclass(frozen=True)
class Rates:
    """Factor from the unit of a velocity to the one shown, and what that is called."""

    name: str
    factor: float


def units_of(case: Case) -> Units:
    """Millimetres and hertz, or, for a model given without dimensions, q and Ω/ω."""
    from vibeam_models.scene import SdofScene

    scene = case.scene
    if not isinstance(scene, SdofScene):
        return METRIC
    return Units("", 1.0, "", 2 * pi / scene.natural_frequency)


def rates_of(case: Case) -> Rates:
    """Millimetres a second, or, for a model given without dimensions, dq/d(ω t)."""
    from vibeam_models.scene import SdofScene

    scene = case.scene
    return Rates("", 1 / scene.natural_frequency) if isinstance(scene, SdofScene) else Rates("mm/s", 1e3)


def percent(value: float) -> str:
    """A share as percent, to three digits."""
    return f"{100 * value:.3g} %" if isfinite(value) else "∞" if isinf(value) else "–"


def _with_unit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".strip() if isfinite(value) else "–"
