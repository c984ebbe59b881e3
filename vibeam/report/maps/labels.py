"""Axes and quantities of a map in a picture: names, units, factors, edges of cells."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from vibeam.case.case import Case, units_of_output
from vibeam.case.grid_keys import FREQUENCY, AxisPlan
from vibeam.figures.page import plain
from vibeam.figures.units import frequency_label, units_of, with_unit
from vibeam.maps.axes import name_of_key
from vibeam.maps.result import MapResult
from vibeam.system.number_text import shown_in
from vibeam.system.quantities import LAYOUT, unit_of


@dataclass(frozen=True)
class ShownAxis:
    """Axis as it is shown: its name in words, label, unit and factor from SI."""

    key: str
    name: str
    label: str
    unit: str
    factor: float

    def value(self, value: float) -> str:
        """One value with its unit; a dash for NaN."""
        return f"{value * self.factor:.4g} {self.unit}".strip().replace("-", "−") if isfinite(value) else "–"

    def text(self, value: float) -> str:
        """The name and one value with its unit."""
        return f"{self.name} {self.value(value)}"


def shown_axis(case: Case, axis: AxisPlan) -> ShownAxis:
    """Name, unit and factor of an axis."""
    name = name_of_key(case, axis.key)
    if axis.key == FREQUENCY:
        units = units_of(case)
        return ShownAxis(axis.key, name, frequency_label(units), units.frequency or "Ω/ω", units.frequency_factor)
    plain_numbers = case.scene.natural_unit is not None
    unit, factor = ("", 1.0) if plain_numbers else shown_in(axis.unit, *axis.values)
    return ShownAxis(axis.key, name, with_unit(name, unit), unit, factor)


def quantity_label(result: MapResult, quantity: str) -> str:
    """Label of a quantity with its SI unit."""
    own = {"energy": "time-mean energy of all modes", "lyapunov": "largest Lyapunov exponent (1/s)"}
    described = LAYOUT.get(quantity)
    if described is None:
        return own.get(quantity, quantity)
    unit = unit_of(described, units_of_output(result.case, result.plan.output))
    return plain(described.long_name if unit == "1" else f"{described.long_name} ({unit})")
