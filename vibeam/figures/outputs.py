"""Axis labels: quantity, output and unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.figures.quantity_names import named_of
from vibeam_models.outputs import DISPLACEMENT

if TYPE_CHECKING:
    from vibeam.figures.units import DisplayUnits


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
