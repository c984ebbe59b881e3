"""Display units of a case, by the size of its numbers or nondimensional as in the paper; labels of axes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite, pi

import numpy as np

from vibeam.case.case import Case, quantity_of
from vibeam.figures.sheet import Comparison, named_of
from vibeam.system.number_text import ACCELERATIONS, FREQUENCIES, OF_QUANTITY, Steps, prefixed
from vibeam.system.response import Branches
from vibeam_models.arrays import Array
from vibeam_models.outputs import DISPLACEMENT


@dataclass(frozen=True)
class DisplayUnits:
    """Factors from SI (or the case's own unit) to the displayed unit, and its name (empty: no unit).

    ``length`` and ``speed`` are of an output and its rate, ``quantity`` is what it reads.
    """

    length: str
    length_factor: float
    frequency: str
    frequency_factor: float
    speed: str = "mm/s"
    speed_factor: float = 1e3
    quantity: str = "displacement"

    @property
    def time_factor(self) -> float:
        """Factor from s to s, of a model given without dimensions to ω t."""
        return 1.0 if self.frequency else 2 * pi / self.frequency_factor

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


METRIC = DisplayUnits("mm", 1e3, "Hz", 1.0)


def units_of(
    case: Case, length: float = float("nan"), speed: float = float("nan"), quantity: str = "displacement"
) -> DisplayUnits:
    """Units by the sweep's frequencies, the largest ``length`` (m) and ``speed`` (m/s) to be shown; NaN: mm, mm/s.

    Of another ``quantity`` than a displacement these are its and its rate's.

    Of a model given without dimensions they are q, Ω/ω and dq/d(ω t).
    """
    own = case.scene.natural_unit
    if own is not None:
        return DisplayUnits("", 1.0, "", 2 * pi / own, "", 1 / own)
    frequency = prefixed(FREQUENCIES, float(np.max(case.sweep.frequency, initial=0.0)), usual=-1)
    steps, rates = OF_QUANTITY[quantity]
    own_units, speeds = prefixed(steps, length, _usual(steps)), prefixed(rates, speed, _usual(rates))
    return DisplayUnits(*own_units, *frequency, *speeds, quantity)


def _usual(steps: Steps) -> int:
    """The step of millimetres, mm/s, m/s², mrad, µε."""
    return 0 if steps is ACCELERATIONS else min(1, len(steps) - 1)


def units_for(result: Comparison, output: str | None = None) -> DisplayUnits:
    """Units of all figures and tables of a result: by its largest amplitude and the corresponding speed.

    ``output``: which is shown, None: the sweep's; of another quantity than that of the sweep's the sizes are not known.
    """
    wanted = quantity_of(result.case, output or result.case.sweep.output)
    if wanted is not quantity_of(result.case, result.case.sweep.output):
        return units_of(result.case, quantity=wanted.name)
    return units_of_branches(result.case, result.values())


def units_of_branches(case: Case, several: Iterable[Branches]) -> DisplayUnits:
    """Units of swept branches: by their largest amplitude and the corresponding speed."""
    responses = [response for branches in several for _, response in branches.items()]
    length = max((_largest(each.amplitude) for each in responses), default=0.0)
    speed = max((_largest(2 * pi * each.frequency * each.amplitude) for each in responses), default=0.0)
    return units_of(case, length, speed, quantity_of(case, case.sweep.output).name)


def _largest(values: Array) -> float:
    return float(np.max(values[np.isfinite(values)], initial=0.0))


def _with_unit(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".strip() if isfinite(value) else "–"


OUTPUTS = ("contact", "sensor", "tip", "platform")


def with_unit(what: str, unit: str) -> str:
    """Quantity with its unit in brackets, where it has one."""
    return f"{what} ({unit})" if unit else what


def motion_of(output: str, quantity: str, units: DisplayUnits) -> str:
    """Label ``sensor displacement (mm)``; for a model without dimensions ``displacement`` alone: it has one output."""
    unit = units.speed if quantity.startswith("velocity") else units.length
    if units.quantity != DISPLACEMENT.name:
        what = f"{units.quantity} amplitude" if quantity == "amplitude" else named_of(quantity, units.quantity)
        return with_unit(f"{output}:\n{what}", unit)
    whose = f"{output} " if units.frequency and output in OUTPUTS else ""
    return with_unit(f"{whose}{quantity}", unit)


def amplitude_of(output: str, units: DisplayUnits) -> str:
    """Label of the amplitude in frequency responses."""
    if units.quantity != DISPLACEMENT.name:
        return with_unit(f"{units.quantity} amplitude, {output}, ½(max − min)", units.length)
    whose = f" at the {output}" if units.frequency and output in OUTPUTS else ""
    return with_unit(f"amplitude{whose}{',' if whose else ''} ½(max − min)", units.length)


def frequency_label(units: DisplayUnits) -> str:
    """Label of the drive frequency in its unit, or over the natural one."""
    return f"drive frequency Ω/2π ({units.frequency})" if units.frequency else "drive frequency Ω/ω"
