"""Reading of reference curves, of vibeam's own files and those of other programs: columns by their heads, SI values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from re import fullmatch

import numpy as np

from vibeam.exchange.curves.columns import (
    SHOWN,
    Columns,
    CurveColumn,
    HeadError,
    TextForm,
    WantedColumn,
    in_si,
    read_columns,
    taken_column,
)
from vibeam.exchange.curves.record import (
    COLUMNS,
    QUANTITIES,
    ROLES,
    Point,
    ReferenceCurve,
    ReferenceForm,
    Taken,
    given,
    tell,
)
from vibeam.exchange.faults import CaseError, as_shown_in_message, fault_in, suggest
from vibeam.exchange.files import FormatError, file_fault, read_by
from vibeam.exchange.units import CURES, taking
from vibeam_models.arrays import Array

RECORDED = "# Regression values: recorded by vibeam"  # first line of a file that ``vibeam check --write`` wrote
NO_COLUMNS = "does not begin with the names of its columns: write {}"
KIND = "response curve of vibeam's own form"  # whose units are known: nobody is told
OWN = COLUMNS[0]  # head of the frequencies in a file of vibeam's own form
FREQUENCY_HEADS = ("frequency", "freq", "f")

WAYS = {
    "up": "up", "down": "down", "forward": "up", "backward": "down", "increasing": "up", "decreasing": "down",
}  # fmt: skip

ANONYMOUS = "cannot be read as a curve; its lines are not shown, since it lies outside the case's folder"


def read_curve(
    path: str | PathLike[str], quantity: str = "amplitude", form: ReferenceForm | None = None, *, quote: bool = True
) -> ReferenceCurve:
    """Read a reference file, of vibeam's own form or of any other; CaseError names its faults.

    ``form``: columns, units, scale; absent: vibeam's own form, or the usual heads and plain units. ``quote``: whether
    messages may quote the file's content, not only the line number.

    >>> import vibeam
    >>> curve = vibeam.read_curve("cases/references/sdof_nominal_sdof.csv")
    >>> curve.quantity, len(curve.points)
    ('amplitude', 402)
    """
    form, path = form or ReferenceForm(), Path(path)
    points, taken = _read_points(path, quantity, form, quote)
    treated = tuple(_treated(point, form) for point in points if _inside(point, form))
    left = len(points) - len(treated)
    notes = (*taken.notes, f"{left} of {len(points)} points left out by window") if left else taken.notes
    taken = replace(taken, notes=notes)
    if taken.kind != KIND or left:
        tell(taken)
    return ReferenceCurve(quantity, treated, str(path), _is_recorded(path), taken)


def _treated(point: Point, form: ReferenceForm) -> Point:
    """Point in SI, whose value is scaled and shifted, with the uncertainty of all where it has none of its own."""
    value = None if point.value is None else form.scale * point.value + form.offset
    own = point.uncertainty
    if own is not None:
        return replace(point, value=value, uncertainty=abs(form.scale) * own)
    if form.uncertainty is None or value is None:
        return replace(point, value=value)
    return replace(point, value=value, uncertainty=form.uncertainty * (abs(value) if form.relative else 1.0))


def _inside(point: Point, form: ReferenceForm) -> bool:
    return form.window is None or form.window[0] <= point.frequency <= form.window[1]


def _is_recorded(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(RECORDED)) == RECORDED.encode()


def _read_points(path: Path, quantity: str, form: ReferenceForm, quote: bool) -> tuple[list[Point], Taken]:
    """The points of a file of any form, and what was taken of it; CaseError with the place and the cure."""
    if fault := file_fault(path):
        raise CaseError([fault_in(path, None, fault)])
    try:
        found = read_columns(path, _wanted(quantity, form), TextForm(form.separator, form.decimal))
        points = _points(found, quantity, form)
        return points, _taken(path, found, quantity, form, points)
    except FormatError as wrong:
        raise CaseError([fault_in(path, wrong.line, _told(wrong, quantity, form, quote))]) from None


def _taken(path: Path, found: Columns, quantity: str, form: ReferenceForm, points: Sequence[Point]) -> Taken:
    units = {"value": (form.unit, form.units.get(quantity)), "frequency": ("Hz", form.units.get("frequency"))}
    if "uncertainty" in found.columns:
        units["uncertainty"] = units["value"][0], form.units.get("uncertainty")
    columns = tuple(taken_column(found.columns[role], *units[role]) for role in units)
    at = [point.frequency for point in points] or [0.0]
    kind = KIND if form.own and OWN in found.heads else "response curve"
    return Taken(path.name, kind, columns, len(points), min(at), max(at), "Hz", notes=found.notes)


def _told(wrong: FormatError, quantity: str, form: ReferenceForm, quote: bool) -> str:
    """Message of a fault; what the file holds is in it where it may be quoted."""
    if isinstance(wrong, HeadError) and not form.columns:
        heads = ", ".join(map(as_shown_in_message, wrong.heads[:SHOWN])) if quote else ""
        there = f": there are {heads}" if heads else ""
        cure = f'columns = {{ frequency = "…", {quantity} = "…" }} (numbers from 1 where it has none)'
        return f"{NO_COLUMNS.format(heading_of(quantity))}, or name its own in the case, {cure}{there}"
    return wrong.message.replace("value = ", f"{quantity} = ") if quote else ANONYMOUS


def _wanted(quantity: str, form: ReferenceForm) -> dict[str, WantedColumn]:
    """Columns by role: those that the case names, or the usual heads."""
    said = {role: (name,) for role, name in form.columns.items()}
    found = {role: WantedColumn(said.get(role, (role,)), role in said, role != "uncertainty") for role in ROLES[1:]}
    found["frequency"] = WantedColumn(said.get("frequency", FREQUENCY_HEADS))
    return found | {"value": WantedColumn(said.get(quantity, (quantity,)))}


def _points(found: Columns, quantity: str, form: ReferenceForm) -> list[Point]:
    columns, periods = found.columns, found.columns.get("period")
    if OWN in found.heads:
        _require_known(found.heads)
    elif "period" not in form.columns:
        periods = None  # of other programs, a column of this name may hold seconds
    frequency = _in_si(columns["frequency"], "frequency", "Hz", form.units.get("frequency"), "")
    column = columns["value"]
    how = taking(form.units.get(quantity) or column.unit)[1]
    if how in CURES and form.scale == 1 and quantity in QUANTITIES[:4]:
        told = f"column {column.head!r} holds {how} values, and {quantity} is one from the middle"
        raise FormatError(f"{told}: say scale = {CURES[how]} in the case")
    value = _in_si(column, quantity, form.unit, form.units.get(quantity), form.scale_unit)
    uncertainty = _uncertainty(columns.get("uncertainty"), column, value, quantity, form)
    points = []
    for row, line in enumerate(found.lines):
        at = float(frequency[row])
        if np.isnan(at) and np.isnan(value[row]):
            continue
        if not at > 0:
            raise FormatError(
                "the frequency is missing" if np.isnan(at) else f"the frequency {at:g} Hz is not above 0", line
            )
        way = _way(columns["direction"].words[row], line) if "direction" in columns else None
        with read_by("", ValueError, line):
            period = period_of(periods.words[row].removesuffix(".0")) if periods else None
        points.append(Point(line, at, way, given(float(value[row])), period, given(float(uncertainty[row]))))
    return points


def _require_known(heads: tuple[str, ...]) -> None:
    """FormatError for a column of a file of vibeam's own form that is none of its columns."""
    for name in heads:
        if name not in (*COLUMNS, "uncertainty"):
            raise FormatError(f"{name}: unknown column; {suggest(name, COLUMNS)}", 1)


def _in_si(column: CurveColumn, role: str, wanted: str, said: str | None, scale_unit: str) -> Array:
    """Values of a column in SI; the case's unit goes before the file's."""
    return in_si(column, wanted, said, f'say it in the case: units = {{ {role} = "…" }}', scale_unit)


def _uncertainty(
    column: CurveColumn | None, of: CurveColumn, value: Array, quantity: str, form: ReferenceForm
) -> Array:
    """Standard uncertainties before the scale: in the unit of the value, its own, or a percentage of the value."""
    if column is None:
        return np.full(len(value), np.nan)
    unit = form.units.get("uncertainty", column.unit)
    if unit == "%":
        return np.abs(value) * column.values / 100
    return np.abs(_in_si(column, "uncertainty", form.unit, unit or form.units.get(quantity, of.unit), form.scale_unit))


def _way(word: str, line: int) -> str | None:
    if word and word.casefold() not in WAYS:
        raise FormatError(f"direction {as_shown_in_message(word)} is neither up nor down", line)
    return WAYS.get(word.casefold())


def heading_of(quantity: str) -> str:
    """First line of a file of vibeam's own form."""
    return f"frequency_hz,direction,{quantity}"


def period_of(text: str | None) -> int | None:
    """Period as a whole number, None where empty; ValueError for anything else."""
    if text and not fullmatch("[+-]?[0-9]{1,9}", text):
        raise ValueError(f"the period {as_shown_in_message(text)} is not a whole number")
    return int(text) if text else None
