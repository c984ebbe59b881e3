"""Reading of reference curves: of vibeam's own form here, of other forms by ``reference_columns``."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.case.faults import CaseError, Fault, as_shown_in_message, suggest
from vibeam.case.reference_columns import NO_COLUMNS, heading_of, period_of, read_points
from vibeam.case.reference_files import ReferenceForm, cells_of, fault_in
from vibeam.case.reference_record import COLUMNS, Point, ReferenceCurve
from vibeam.exchange.curves.read import is_text

if TYPE_CHECKING:
    from vibeam.case.plans import Reference

SAME_FREQUENCY = 1e-9  # relative tolerance
RECORDED = "# Regression values: recorded by vibeam"  # first line of a file that ``vibeam record`` wrote


def reference_points(reference: Reference) -> list[Point]:
    """Points of a case's reference on its branches; CaseError where its file cannot be read."""
    return reference_curve(reference).along(("up", "down") if reference.direction == "both" else (reference.direction,))


def reference_curve(reference: Reference) -> ReferenceCurve:
    """Curve of a case's reference; CaseError where its file cannot be read."""
    if reference.curve is not None:
        return reference.curve
    curve = read_curve(reference.file, reference.quantity, reference.form, quote=reference.quote)
    if reference.direction == "both":
        return curve
    known = tuple(replace(each, direction=each.direction or reference.direction) for each in curve.points)
    return replace(curve, points=known)


def read_reference(
    path: Path, quantity: str, directions: Collection[str] = ("up", "down"), *, quote: bool = True,
    form: ReferenceForm | None = None,
) -> list[Point]:  # fmt: skip
    """Read the points of a reference file for ``quantity`` on given branches; CaseError names its faults.

    ``quote``: whether messages may quote the file's content, not only the line number.
    """
    return read_curve(path, quantity, form, quote=quote).along(directions)


def read_curve(
    path: str | PathLike[str], quantity: str = "amplitude", form: ReferenceForm | None = None, *, quote: bool = True
) -> ReferenceCurve:
    """Read a reference file, of vibeam's own form or of any other; CaseError and ``quote`` as ``read_reference``.

    ``form``: columns, units, scale; absent: vibeam's own form, or the usual heads and plain units.
    """
    form, path = form or ReferenceForm(), Path(path)
    if form.own and (head := _own_head(path, quantity)):
        points = _own_points(path, quantity, head, quote)
    else:
        points = read_points(path, quantity, form, quote)
    treated = tuple(_treated(point, form) for point in points if _inside(point, form))
    return ReferenceCurve(quantity, treated, str(path), _is_recorded(path))


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


def _own_head(path: Path, quantity: str) -> tuple[int, list[str]] | None:
    """Line and names of the columns, where a file is of vibeam's own form."""
    if not is_text(path):
        return None
    try:
        line, head = next(cells_of(path), (0, []))
    except CaseError as fault:
        if "not UTF-8" in str(fault):
            return None  # text in another encoding
        raise
    return (line, head) if "frequency_hz" in head and {quantity, "direction"} & {*head} else None


def _own_points(path: Path, quantity: str, heading: tuple[int, list[str]], quote: bool) -> list[Point]:
    first, head = heading
    if faults := _column_faults(path, first, head, quantity):
        raise CaseError(faults if quote else [fault_in(path, first, NO_COLUMNS.format(heading_of(quantity)))])
    found = []
    lines = cells_of(path)
    next(lines)
    for number, cells in lines:
        try:
            found.append(_point(number, (head, cells), quantity))
        except ValueError as fault:
            why = str(fault) if quote else "write a frequency in Hz, up or down, and numbers"
            raise CaseError([fault_in(path, number, f"is no reference point: {why}")]) from None
    return found


def _column_faults(path: Path, line: int | None, head: list[str], quantity: str) -> list[Fault]:
    wrong = [] if quantity in head else [(quantity, "the column is missing")]
    known = (*COLUMNS, "uncertainty")
    wrong += [(name, f"unknown column; {suggest(name, known)}") for name in head if name not in known]
    wrong += [(name, "the column is there twice") for name in known if head.count(name) > 1]
    return [fault_in(path, line, message, name) for name, message in wrong]


def _point(number: int, row: tuple[list[str], list[str]], quantity: str) -> Point:
    head, given = row
    if len(head) != len(given):
        raise ValueError(f"{len(given)} cells for {len(head)} columns")
    cells = dict(zip(head, given, strict=True))
    direction = cells.get("direction")
    if direction not in ("up", "down", None):
        raise ValueError(f"direction {as_shown_in_message(direction)} is neither up nor down")
    value = _finite(cells[quantity]) if cells[quantity] else None
    return Point(
        number, _finite(cells["frequency_hz"]), direction, value, period_of(cells.get("period")),
        _finite(cells["uncertainty"]) if cells.get("uncertainty") else None,
    )  # fmt: skip


def _finite(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise ValueError(f"{as_shown_in_message(text)} is not a number") from None
    if not isfinite(number):
        raise ValueError(f"{as_shown_in_message(text)} is not a finite number")
    return number
