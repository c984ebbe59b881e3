"""Reading of reference curves: of vibeam's own form here, of other forms by ``foreign``."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from os import PathLike
from pathlib import Path

from vibeam.exchange.curves.foreign import NO_COLUMNS, heading_of, period_of, read_points
from vibeam.exchange.curves.read import is_text
from vibeam.exchange.curves.record import COLUMNS, Point, ReferenceCurve, ReferenceForm
from vibeam.exchange.faults import CaseError, Fault, as_shown_in_message, fault_in, suggest
from vibeam.exchange.files import LARGEST_TEXT, FormatError, numbered, reason, state_of

LONGEST = 100_000  # characters of a line
LINES = 2_100_000  # one for each direction of the longest sweep, and comments
RECORDED = "# Regression values: recorded by vibeam"  # first line of a file that ``vibeam record`` wrote


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
    if form.own and (head := _own_head(path, quantity)):
        points = _own_points(path, quantity, head, quote)
    else:
        points = read_points(path, quantity, form, quote)
    treated = tuple(_treated(point, form) for point in points if _inside(point, form))
    return ReferenceCurve(quantity, treated, str(path), _is_recorded(path))


def cells_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every line but empty ones and comments; CaseError where the file is unreadable."""
    number = 0
    try:
        state_of(path, LARGEST_TEXT)
        with path.open(encoding="utf-8-sig") as file:
            for number, line in numbered(file, LONGEST, LINES):
                if line.strip() and not line.startswith("#"):
                    yield number, [cell.strip() for cell in next(csv.reader([line]))]
    except FormatError as fault:
        raise CaseError([fault_in(path, fault.line, fault.message)]) from None
    except UnicodeDecodeError:
        raise CaseError([fault_in(path, None, "cannot be read: it is not UTF-8 text")]) from None
    except OSError as error:
        raise CaseError([fault_in(path, None, f"cannot be read: {reason(error)}")]) from None
    except csv.Error as error:
        raise CaseError([fault_in(path, number, f"is no line of a table: {error}")]) from None


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
