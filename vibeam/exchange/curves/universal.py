"""Curves in universal files: a function at nodal degrees of freedom (data set 58) with units by types and labels.

The label of an axis says its unit; without one its type does, in the units of data set 164, of which values are then
made SI. A label that is not of its type, and one that data set 164 contradicts, is a fault.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isclose
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.columns import Columns, CurveColumn, WantedColumn, size_in
from vibeam.exchange.curves.data_sets import FileUnits, Function, FunctionAxis, chosen, data_sets, units_of
from vibeam.exchange.files import FormatError
from vibeam.exchange.units import known_unit

AUTO, CROSS, DENSITY, ENERGY = 2, 3, 9, 10
FUNCTIONS = {
    1: "time history", AUTO: "auto power spectrum", CROSS: "cross power spectrum", 4: "frequency response",
    5: "transmissibility", 6: "coherence", 7: "autocorrelation", 8: "cross-correlation",
    DENSITY: "power spectral density", ENERGY: "energy spectral density", 12: "spectrum", 25: "impulse response",
    26: "multiple coherence", 27: "order function",
}  # fmt: skip
GENERAL = 1  # specific data type of what has its exponents beside it
#: SI units by specific data types
TYPES = {
    2: "Pa", 3: "1", 8: "m", 9: "N", 11: "m/s", 12: "m/s^2", 13: "N", 15: "Pa", 16: "kg", 17: "s", 18: "Hz", 19: "rpm",
    21: "Pa",
}  # fmt: skip
ABSCISSAE = {"time": "s", "frequency": "Hz"}


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """Frequency and modulus of one data set 58, the one that ``wanted["value"]`` numbers where there are several.

    Time and value where ``wanted["frequency"]`` may be called time.
    """
    sets = data_sets(path)
    number, one = chosen(sets, wanted["value"].names[0])
    place = f"data set 58 number {number}"
    over, unit = _abscissa(one.axes[0])
    timed = "time" in wanted["frequency"].names
    if over == "time" and not timed:
        raise FormatError("its data set 58 is not over frequency: export a frequency response or an order")
    kind = FUNCTIONS.get(one.type, "")
    ordinate, size, origin = _ordinate(one, units_of(sets))
    values = one.value * size
    columns = {
        "frequency": CurveColumn(over, unit, one.at, place=place),
        "value": CurveColumn(
            f"{kind} {one.called}".strip(), ordinate, np.abs(values) if np.iscomplexobj(values) else values,
            place=place, origin=origin, complex_values=values if np.iscomplexobj(values) else None,
        ),
    }  # fmt: skip
    return Columns(columns, range(1, len(values) + 1), kind=kind)


def _abscissa(axis: FunctionAxis) -> tuple[str, str]:
    """``time`` or ``frequency``, and the unit, by type and label; FormatError for another one."""
    said = TYPES.get(axis.type, "")
    fits = {over for over, unit in ABSCISSAE.items() if said and size_in(said, unit)}
    named = {over for over, unit in ABSCISSAE.items() if axis.label and size_in(axis.label, unit)}
    if axis.type > GENERAL and axis.label and known_unit(axis.label) and not fits & named:
        raise FormatError(f"the abscissa is of type {axis.type}, and its label is {axis.label!r}: {_CURE}", axis.line)
    over = fits or named
    if not over:
        told = f"the abscissa, of type {axis.type} with the label {axis.label!r}, is neither time nor frequency"
        raise FormatError(f"{told}: {_CURE}", axis.line)
    return over.pop(), axis.label or said


_CURE = "correct one of both (type 17 is time, 18 frequency, 0 unknown)"


def _ordinate(one: Function, units: FileUnits) -> tuple[str, float, str]:
    """Unit of the ordinate, factor that makes its values of this unit, and where the unit is from."""
    _, upper, lower = one.axes
    made = [] if "R" in one.called else _forms(one.type, TYPES.get(upper.type, ""), lower)
    for wanted, spelt in made if upper.label else ():
        label = spelt.format(upper.label)
        if (by_label := size_in(label, wanted)) is not None:
            agreed = not units.words or isclose(by_label, units.size(wanted), rel_tol=1e-3)
            return label if agreed else f"{label} by its label, {units.words} by data set 164", 1.0, "by its label"
    if made and upper.label and known_unit(upper.label):
        told = f"the ordinate is of type {upper.type}, {made[0][0]}, and its label is {upper.label!r}"
        raise FormatError(f"{told}: correct one of both (type 0 is unknown)", upper.line)
    if upper.label:
        return upper.label, 1.0, "by its label"
    by = "" if units.length == units.force == 1 else f", made SI of {units.words} by data set 164"
    if made and one.type not in (AUTO, CROSS):
        return made[0][0], units.size(made[0][0]), f"by its type {upper.type}{by}"
    return "" if units.length == units.force == 1 else f"not said{by}", 1.0, ""


def _forms(function: int, above: str, lower: FunctionAxis) -> list[tuple[str, str]]:
    """SI units that an ordinate of this type may have, the usual one first, each with how a label may spell it."""
    square = {DENSITY: "({})^2/Hz", ENERGY: "({})^2 s/Hz"}.get(function)
    if not above:
        return []
    if square:
        return [(square.format(above), each) for each in ("{}", square)]
    if function in (AUTO, CROSS):
        return [(above, "{}"), (f"({above})^2", "{}")]
    below = TYPES.get(lower.type, "") or lower.label
    under, spelt = (each and (f"/({each})" if "/" in each else f"/{each}") for each in (below, lower.label or below))
    return [(above + under, "{}"), (above + under, "{}" + spelt)]
