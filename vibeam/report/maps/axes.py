"""Axes of a map in a picture: names, units, and the panels that the outer axis and the fidelities make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import Case, units_of_output
from vibeam.case.grid_keys import FREQUENCY
from vibeam.figures.page import plain
from vibeam.figures.style import name_of
from vibeam.figures.units import frequency_label, units_of, with_unit
from vibeam.studies.stability.axes import NAMES
from vibeam.system.number_text import shown_unit
from vibeam.system.quantities import LAYOUT, unit_of

if TYPE_CHECKING:
    from vibeam.case.grid_keys import AxisPlan, MapPlan
    from vibeam.maps.evaluate import GridResponse
    from vibeam.maps.run import MapResult


CALLED = NAMES | {
    "stop.gap": "gap",
    "stop.restitution": "restitution R",
    "start.displacement": "initial displacement of the contact",
    "start.velocity": "initial velocity of the contact",
}

LETTERS = "abcdefghijklmnopqrstuvwxyz"


@dataclass(frozen=True)
class ShownAxis:
    """Axis as it is shown: its label, unit and factor from SI."""

    key: str
    label: str
    unit: str
    factor: float

    def text(self, value: float) -> str:
        """One value with its unit."""
        return f"{self.label.partition(' (')[0]} {value * self.factor:.4g} {self.unit}".strip().replace("-", "−")


def shown_axis(case: Case, axis: AxisPlan) -> ShownAxis:
    """Name, unit and factor of an axis."""
    if axis.key == FREQUENCY:
        units = units_of(case)
        return ShownAxis(axis.key, frequency_label(units), units.frequency or "Ω/ω", units.frequency_factor)
    unit, factor = shown_unit(axis.unit, max(abs(value) for value in axis.values))
    return ShownAxis(axis.key, with_unit(CALLED.get(axis.key, axis.key), unit), unit, factor)


@dataclass(frozen=True)
class MapPanel:
    """One panel: its place, title, row's name, what it shows of (``response``, ``way``), and the outer axis' value."""

    row: int
    column: int
    title: str
    side: str
    fidelity: str
    way: int
    outer: tuple[tuple[str, float], ...]
    index: int | None  # along the outer axis

    def of(self, response: GridResponse, quantity: str) -> NDArray[Any]:
        """One quantity of this panel, over the last two axes."""
        values = response.values[quantity][self.way]
        return np.asarray(values if self.index is None else values[self.index])


def panels(result: MapResult) -> Iterator[MapPanel]:
    """Panels of a map: a row for each fidelity and way, a column for each value of the outer axis."""
    plan: MapPlan = result.plan
    outer = plan.axes[0] if len(plan.axes) == 3 else None
    shown = None if outer is None else shown_axis(result.case, outer)
    row = 0
    for fidelity, response in result.responses.items():
        for way, called in enumerate(response.ways):
            side = name_of(result.case, fidelity) + ("" if called == "apart" else f", {called}")
            for column, value in enumerate((None,) if outer is None else outer.values):
                title = "" if shown is None or value is None else f"({LETTERS[column % 26]}) {shown.text(value)}"
                held = () if outer is None or value is None else ((outer.key, value),)
                at = None if outer is None else column
                yield MapPanel(row, column, title, side, fidelity, way, held, at)
            row += 1


def cells(values: NDArray[Any]) -> NDArray[Any]:
    """Values as rows of cells: one row where there is one axis."""
    return values[None, :] if values.ndim == 1 else values


def quantity_label(result: MapResult, quantity: str) -> str:
    """Label of a quantity with its SI unit."""
    own = {"energy": "time-mean energy of all modes", "lyapunov": "largest Lyapunov exponent (1/s)"}
    described = LAYOUT.get(quantity)
    if described is None:
        return own.get(quantity, quantity)
    unit = unit_of(described, units_of_output(result.case, result.plan.output))
    return plain(described.long_name if unit == "1" else f"{described.long_name} ({unit})")


def edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of the cells round ``centres``, (points + 1,): half-way between neighbours."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    inner = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - inner[0]], inner, [2 * centres[-1] - inner[-1]]])
