"""Axes of the map: the case's frequencies, and its gap or the level of its drive in the drive's own unit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.grid_keys import FREQUENCY
from vibeam.casefile.quantities import (
    ACCELERATION,
    FORCE,
    LENGTH,
    MOMENT,
    RATIO,
    SPEED,
    VOLTAGE,
    Dimension,
    UnitError,
    to_si,
)
from vibeam.periodic.bifurcation_functions import DrivePerLevel
from vibeam.periodic.modal_sums import sums
from vibeam.system.number_text import shown_unit
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


WIDE = 2.0  # default gaps, in amplitudes without the stop

#: names and dimensions of what says the level of a drive, by its key
LEVELS = {
    "voltage": ("drive voltage", VOLTAGE),
    "amplitude": ("base amplitude", LENGTH),
    "velocity": ("base velocity", SPEED),
    "acceleration": ("base acceleration", ACCELERATION),
    "force": ("drive force", FORCE),
    "moment": ("drive moment", MOMENT),
}

NAMES = {f"drive.{key}": name for key, (name, _) in LEVELS.items()}
PLAIN = {"amplitude": "base amplitude B", "velocity": "base velocity ΩB", "acceleration": "base acceleration Ω²B"}
TABLE = "share of the drive"  # the level of one that is a list over frequency


@dataclass(frozen=True)
class StabilityAxis:
    """Second parameter: ``over`` as in ``OrbitMap``, its name, its SI unit ("": no dimension), its range in SI."""

    over: str
    name: str
    unit: str
    low: float
    high: float

    def text(self, own: float) -> str:
        """A model's own value in words."""
        unit, factor = shown_unit(self.unit, abs(own) or max(abs(self.low), abs(self.high)))
        return f"{self.name} of {own * factor:.4g} {unit}".strip()


@dataclass(frozen=True)
class Driving:
    """Drive of a fidelity: the key of its level (None: a list over frequency), its own level, the drive at level 1."""

    key: str | None
    own: float
    per_level: DrivePerLevel

    @classmethod
    def of(cls, case: Case, fidelity: str) -> Driving:
        """Drive of one fidelity of a case."""
        scene: Any = case.scene_of(fidelity)
        base = scene.base
        key = next(name for name in LEVELS if getattr(base, name) is not None)
        own = getattr(base, key)
        if isinstance(own, tuple):
            return cls(None, 1.0, lambda omega: case.amplitude_of(fidelity, omega))
        return cls(key, own, case.model(fidelity).at({f"drive.{key}": 1.0}).amplitude)

    def amplitude(self, omega: Array) -> Array:
        """Amplitude of the drive as it is, at ``omega`` (points,) rad/s."""
        return np.asarray(self.own * np.asarray(self.per_level(omega))) * np.ones(len(omega))


def frequencies(case: Case, count: int) -> Array:
    """Frequencies over the case's own range, in rad/s; ValueError where that is one frequency."""
    grid = case.sweep.frequency
    if not grid.min() < grid.max():
        raise ValueError("sweep.frequency: a map needs a range of frequencies, there is one")
    return np.asarray(2 * np.pi * np.linspace(grid.min(), grid.max(), count))


def second_name(over: str) -> str:
    """Name of the key beside the frequency: ``"gap"`` of ``"frequency,gap"``, and of ``"gap"`` alone."""
    names = [part.strip() for part in over.split(",")]
    others = [name for name in names if name not in ("frequency", FREQUENCY)]
    return others[0] if len(others) == 1 and len(names) <= 2 else over


def second_axis(
    case: Case, over: str, low: str | float | None, high: str | float | None, system: ImpactSystem, drive: Driving
) -> StabilityAxis:
    """Axis of gap or drive, as in ``stability``; ``system``, ``drive``: of the model that the default range is of."""
    if over not in ("gap", "drive"):
        raise ValueError(f"--over: {over!r} is none of gap, drive; the frequency is the first axis")
    name, kind = _gap_unit(case) if over == "gap" else _drive_unit(case, drive)
    usual = _usual_gaps(case, system, drive) if over == "gap" else (drive.own / 20, 2 * drive.own)
    first, last = (
        default if given is None else _value(flag, given, kind)
        for flag, given, default in (("--from", low, usual[0]), ("--to", high, usual[1]))
    )
    if not first < last:
        raise ValueError(f"--from, --to: {name} must ascend, not go from {first:.4g} to {last:.4g}")
    if over == "drive" and first <= 0:
        raise ValueError(f"--from: {name} must be > 0, not {first:.4g}")
    return StabilityAxis("gap" if over == "gap" else "amplitude", name, kind.unit, first, last)


def _value(flag: str, given: str | float, kind: Dimension) -> float:
    try:
        return to_si(given, kind)
    except UnitError as fault:
        raise ValueError(f"{flag}: {fault}") from None


def _gap_unit(case: Case) -> tuple[str, Dimension]:
    return ("gap at the contact", LENGTH) if case.scene.natural_unit is None else ("gap Δ", RATIO)


def _drive_unit(case: Case, drive: Driving) -> tuple[str, Dimension]:
    if drive.key is None:
        return TABLE, RATIO
    return LEVELS[drive.key] if case.scene.natural_unit is None else (PLAIN[drive.key], RATIO)


def _usual_gaps(case: Case, system: ImpactSystem, drive: Driving) -> tuple[float, float]:
    """Default gaps: around 0, some amplitudes of the motion without the stop, the case's own gap included."""
    grid = frequencies(case, 101)
    half = max(WIDE * swing(system, grid, drive.amplitude(grid)), 2 * abs(system.gap))
    return -half, half


def swing(system: ImpactSystem, omega: Array, amplitude: float | Array) -> float:
    """Median amplitude of the contact without the stop at ``omega`` (points,), m."""
    return float(np.median(np.abs(sums(system, omega, 1).unit) * amplitude))
