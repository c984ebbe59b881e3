"""Axes of the map: the case's frequencies, and its gap or drive in the case's own units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.casefile.quantities import LENGTH, RATIO, VOLTAGE, Dimension, UnitError, to_si
from vibeam.figures.prefixes import LENGTHS, prefixed
from vibeam.orbits.bifurcation_functions import motions

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


Array = NDArray[np.float64]

WIDE = 2.0  # default gaps, in amplitudes without the stop


@dataclass(frozen=True)
class Axis:
    """Second parameter: ``over`` as in ``OrbitMap``, its name, its unit, SI for one of it, the case's own value.

    ``low``, ``high`` and ``own`` are in ``unit`` ("1": no dimension).
    """

    over: str
    name: str
    unit: str
    factor: float
    own: float
    low: float
    high: float

    @property
    def own_text(self) -> str:
        """Case's own value in words."""
        size = abs(self.own) or max(abs(self.low), abs(self.high))
        unit, factor = prefixed(LENGTHS, size) if self.unit == "m" else (self.unit.removeprefix("1"), 1.0)
        return f"{self.name} of {self.own * factor:.4g} {unit}".strip()


def frequencies(case: Case, count: int) -> Array:
    """Frequencies over the case's own range, in rad/s; ValueError where that is one frequency."""
    grid = case.sweep.frequency
    if not grid.min() < grid.max():
        raise ValueError("sweep.frequency: a map needs a range of frequencies, there is one")
    return np.asarray(2 * np.pi * np.linspace(grid.min(), grid.max(), count))


def second_axis(case: Case, over: str, low: str | float | None, high: str | float | None, system: ImpactSystem) -> Axis:
    """Axis of gap or drive, as in ``stability``; ``system``: its gap and swing are the defaults."""
    if over not in ("gap", "drive"):
        raise ValueError(f"--over: {over!r} is none of gap, drive")
    name, kind, factor = _gap_unit(case) if over == "gap" else _drive_unit(case)
    own = system.gap if over == "gap" else case.base_amplitude / factor
    usual = _usual_gaps(case, system) if over == "gap" else (own / 20, 2 * own)
    first, last = (
        default if given is None else _value(flag, given, kind)
        for flag, given, default in (("--from", low, usual[0]), ("--to", high, usual[1]))
    )
    if not first < last:
        raise ValueError(f"--from, --to: {name} must ascend, not go from {first:.4g} to {last:.4g}")
    if over == "drive" and first <= 0:
        raise ValueError(f"--from: {name} must be > 0, not {first:.4g}")
    return Axis("gap" if over == "gap" else "amplitude", name, kind.unit or "1", factor, own, first, last)


def _value(flag: str, given: str | float, kind: Dimension) -> float:
    try:
        return to_si(given, kind)
    except UnitError as fault:
        raise ValueError(f"{flag}: {fault}") from None


def _gap_unit(case: Case) -> tuple[str, Dimension, float]:
    if case.scene.natural_unit is not None:
        return "gap Δ", RATIO, 1.0
    return "gap at the contact", LENGTH, 1.0


def _drive_unit(case: Case) -> tuple[str, Dimension, float]:
    """Unit of the drive: volts where the case drives by voltage; SI amplitude for one of them."""
    scene: Any = case.scene
    if scene.natural_unit is not None:
        return "base amplitude B", RATIO, 1.0
    if scene.base.voltage is None:
        return "base amplitude", LENGTH, 1.0
    from vibeam_models.base_motion import base_amplitude

    volt = replace(scene, base=replace(scene.base, voltage=1.0))
    return "drive voltage", VOLTAGE, base_amplitude(volt)


def _usual_gaps(case: Case, system: ImpactSystem) -> tuple[float, float]:
    """Default gaps: around 0, some amplitudes of the motion without the stop, the case's own gap included."""
    grid = frequencies(case, 101)
    free = motions(system, 1, grid, np.full(101, case.base_amplitude), np.zeros(101))
    half = max(WIDE * case.base_amplitude * float(np.median(np.abs(free.total.unit))), 2 * abs(system.gap))
    return -half, half
