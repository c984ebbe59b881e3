"""Curves in text: CSV and the tables of instruments, any heads, separators, decimal signs, line ends."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.cells import decimal_sign, number, numeric, one_unit, plain_table, settings, units_row
from vibeam.exchange.curves.columns import (
    Columns,
    CurveColumn,
    HeadError,
    TextForm,
    WantedColumn,
    find,
    is_unit,
    missing,
    split_head,
)
from vibeam.exchange.files import FormatError, lines_of, read_by, shown, text_of
from vibeam_models.arrays import Array
from vibeam_models.registry import loaded

SEPARATORS = (";", "\t", ",", "|", " ")
LONGEST_HEAD = 500  # lines before the table begins
LONGEST_LINE = 100_000  # characters of one, and of all that may be heads
LINES = 2_100_000  # one for each direction of the longest sweep, and comments
Line = tuple[int, str]  # line, text
Row = tuple[int, list[str]]  # line, cells
Units = Mapping[int, Sequence[tuple[str, str]]]  # by column: where, unit


@dataclass(frozen=True)
class TableHead:
    """Heads and the separator between them; index of their line (None: none), and of the first line below.

    Where columns are told by number the first line below is that of the first numbers.
    """

    head: int | None
    heads: list[str]
    separator: str
    begin: int


def read(path: Path, wanted: Mapping[str, WantedColumn], form: TextForm | None = None) -> Columns:
    """The columns wanted; FormatError, with the line, where one is missing or a cell is no number."""
    form = form or TextForm()
    lines = list(lines_of(text_of(path), LONGEST_LINE, LINES))
    if lines and lines[0][1].startswith("LabVIEW Measurement"):
        columns_of: Callable[..., Columns] = loaded("vibeam.exchange.curves.labview:read")
        return columns_of(lines, wanted)
    table = _head(lines, wanted, form)
    heads, separator = table.heads, table.separator
    places = {role: found for role, each in wanted.items() if (found := find(heads, each)) is not None}
    needed = [column for role, column in places.items() if wanted[role].needed]
    units, rest = _units(lines, table, places, needed)
    below = [(line, text) for line, text in lines[rest:] if text.lstrip()[0] not in "#%"]
    if below and not form.separator:
        separator = _of_rows(*below[0], len(heads), separator)
    words = {role for role in places if wanted[role].words}
    whole = range(len(heads), len(heads) + 1)
    plain = None if form.decimal or words else plain_table([text for _, text in below], separator, whole, places)
    if plain is not None:
        numbers = {role: _column(heads, units, places[role], values) for role, values in plain.items()}
        return Columns(numbers, tuple(line for line, _ in below), tuple(heads))
    rows = list(_rows(below, heads, separator, 1 + max(needed)))
    kept = [row for row in rows if any(row[1][places[role]].strip() for role in places if wanted[role].needed)]
    if not kept:
        raise FormatError("has no line of numbers below its heads")
    spelt = [place for role, place in places.items() if role not in words]
    decimal = form.decimal or decimal_sign((line, row[place]) for line, row in kept for place in spelt)
    columns = {}
    for role, place in places.items():
        own = [(line, cells[place]) for line, cells in kept]
        if role in words:
            said, values = tuple(cell.strip() for _, cell in own), np.full(len(own), np.nan)
        else:
            said, values = (), np.array([number(each, decimal) for each in own])
        columns[role] = replace(_column(heads, units, place, values), words=said)
    return Columns(columns, tuple(line for line, _ in kept), tuple(heads))


def _column(heads: list[str], units: Units, column: int, values: Array) -> CurveColumn:
    name, own = split_head(heads[column])
    unit, origin = one_unit(own, units.get(column, ()))
    return CurveColumn(name, unit, values, (), f"column {column + 1}", origin)


def _units(lines: list[Line], table: TableHead, places: Mapping[str, int], needed: Sequence[int]) -> tuple[Units, int]:
    """Units by column that are said outside its head, each with where, and the index of the line after the last row."""
    at, value = places.get("frequency"), places.get("value", next(iter(places.values())))
    units, rest = dict[int, list[tuple[str, str]]](), table.begin
    for index, (line, text) in enumerate(_first(lines)):
        if index == table.head:
            continue
        comment = text.lstrip()[0] in "#%"
        row = units_row(_cells_like(line, text, table), needed, at) if index <= rest else {}
        if index == rest and (row or comment):
            rest += 1
        elif table.head is not None and table.head < index < table.begin and not (row or comment):
            raise FormatError(f"{shown(text)} is no head, no unit, no number: delete it, or begin it with #", line)
        side = "above" if table.head is not None and index < table.head else "below"
        where = f"from the row {side} the heads" if row and table.head is not None else f"from line {line}"
        free = index < rest or text.lstrip(' "')[:1].isalpha()
        for said in [row] if row else settings(text, table.heads, value, at) if free else []:
            for column, unit in said.items():
                units.setdefault(column, []).append((where, unit))
    return units, rest


def _cells_like(line: int, text: str, table: TableHead) -> list[str]:
    """Cells of a line by the separator that gives as many as there are heads, else by that of the heads."""
    for separator in (table.separator, *SEPARATORS):
        cells = _heads_of(line, text, separator)
        if len(_trimmed(cells)) <= len(table.heads) <= len(cells):
            return cells
    return _heads_of(line, text, table.separator)


def _head(lines: list[Line], wanted: Mapping[str, WantedColumn], form: TextForm) -> TableHead:
    """The heads that have all columns that are needed."""
    if all(isinstance(name, int) for each in wanted.values() for name in each.names if each.needed):
        return _without_head(lines, wanted, form)
    separators = (form.separator,) if form.separator else SEPARATORS
    best: TableHead | None = None
    for place, (line, text) in enumerate(_first(lines)):
        for separator in separators:
            heads = _heads_of(line, text, separator)
            if best and (separator == " " or len(heads) <= len(best.heads)):
                continue
            if all(find(heads, each) is not None for each in wanted.values() if each.needed):
                best = TableHead(place, heads, separator, place + 1)
        if best:
            return replace(best, heads=_trimmed(best.heads))
    raise _no_heads(lines, wanted, separators)


def _first(lines: list[Line]) -> list[Line]:
    """The lines that may be heads."""
    lengths = accumulate(len(text) for _, text in lines[:LONGEST_HEAD])
    return [line for line, length in zip(lines, lengths, strict=False) if length <= LONGEST_LINE]


def _heads_of(line: int, text: str, separator: str) -> list[str]:
    """Heads of a line, which may be a comment; a unit in brackets belongs to the word before it."""
    heads = text.lstrip("#%").strip() if text[0] in "#%" else text
    return re.split(r"\s+(?![\[(])", heads.strip()) if separator == " " else _cells_of(line, heads, separator)


def _no_heads(lines: list[Line], wanted: Mapping[str, WantedColumn], separators: tuple[str, ...]) -> HeadError:
    """The message for a file whose heads are other ones: those of the line that looks most like heads."""
    heads = [(lines[0][0] if lines else None, list[str]())]
    for line, text in _first(lines):
        cells = max((_trimmed(_heads_of(line, text, each)) for each in separators[:-1] or separators), key=len)
        heads += [(line, cells)] * (not any(map(numeric, cells)))
    place, likely = max(heads, key=lambda each: sum(map(bool, each[1])))
    fault = missing(likely, wanted, {role: find(likely, each) for role, each in wanted.items()})
    assert fault is not None  # or it would have been the head
    return HeadError(fault.message, likely, place)


def _cells_of(line: int, text: str, separator: str) -> list[str]:
    """Cells of a line; blanks in any number are one separator."""
    if separator == " ":
        return text.split()
    with read_by("is no line of a table", csv.Error, line):
        return [cell.strip() for cell in next(csv.reader([text.strip("\r\n")], delimiter=separator))]


def _trimmed(cells: list[str]) -> list[str]:
    """Cells without empty ones at the end: a line may end with separators."""
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells


def _without_head(lines: list[Line], wanted: Mapping[str, WantedColumn], form: TextForm) -> TableHead:
    """As ``_head`` of a file whose columns are told by number: numbers begin where all of these are numbers."""
    needed = [name for each in wanted.values() if each.needed for name in each.names if isinstance(name, int)]
    for place, (line, text) in enumerate(_first(lines)):
        for separator in (form.separator,) if form.separator else SEPARATORS:
            cells = _cells_of(line, text, separator)
            if len(cells) >= max(needed) and all(numeric(cells[each - 1]) for each in needed):
                plain = TableHead(None, [f"column {each + 1}" for each in range(len(cells))], separator, place)
                at = [name for name in wanted["frequency"].names if isinstance(name, int)]
                return _named(lines, plain, [each - 1 for each in needed], at[0] - 1 if at else None)
    raise FormatError(f"has no line with numbers in the columns {' and '.join(map(str, needed))}")


def _named(lines: list[Line], table: TableHead, needed: Sequence[int], at: int | None) -> TableHead:
    """The table with its heads, where the line above its numbers, or above the row of units there, has as many."""
    for index in range(table.begin - 1, -1, -1):
        line, text = lines[index]
        cells = _cells_like(line, text, table)
        if len(cells) == len(table.heads) and not any(map(numeric, cells)):
            if not units_row(cells, needed, at):
                return replace(table, head=index, heads=cells)
        elif text.lstrip()[0] not in "#%":
            if any(map(is_unit, cells)) and not any(map(numeric, cells)):
                told = f"{len(cells)} cells above {len(table.heads)} columns of numbers"
                raise FormatError(f"{told}, {shown(text)}: complete the line, delete it, or begin it with #", line)
            break
    return table


def _rows(lines: list[Line], heads: list[str], separator: str, needed: int) -> Iterator[Row]:
    """Rows of cells, as many as heads; FormatError where a row has more, or is cut off before the ``needed`` ones."""
    before = 0
    for line, text in lines:
        raw = _cells_of(line, text, separator)
        cells, least = _trimmed(raw), max(needed, before) if line == lines[-1][0] else needed
        before = len(raw)
        if not cells:
            continue
        if len(cells) > len(heads):
            why = ": decimal commas between commas? Export with semicolons" if separator == "," else ""
            raise FormatError(f"{len(cells)} cells for {len(heads)} columns{why}", line)
        if len(raw) < least:
            counted = f"{len(raw)} cell{'s' * (len(raw) != 1)} for {len(heads)} columns"
            raise FormatError(f"{counted}, {shown(text)}: complete the line, delete it, or begin it with #", line)
        yield line, cells + [""] * (len(heads) - len(cells))


def _of_rows(line: int, text: str, count: int, separator: str) -> str:
    """Separator of the rows: the heads', unless they have none of it and another gives as many cells as heads."""
    if count == 1 or len(_cells_of(line, text, separator)) > 1:
        return separator
    fitting = [each for each in SEPARATORS if len(_trimmed(_cells_of(line, text, each))) == count]
    return fitting[0] if fitting else separator
