"""Curves in text: CSV and the tables of instruments, any heads, separators, decimal signs, line ends.

Numbers as instruments and spreadsheets write them: decimal commas, thousands separators, D exponents.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate
from math import isfinite, nan
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.columns import (
    Columns,
    CurveColumn,
    HeadError,
    WantedColumn,
    find,
    missing,
    split_head,
)
from vibeam.exchange.files import FormatError, lines_of, read_by, shown, text_of
from vibeam_models.arrays import Array

SEPARATORS = (";", "\t", ",", "|", " ")
LONGEST_HEAD = 500  # lines before the table begins
LONGEST_LINE = 100_000  # characters of one, and of all that may be heads
LINES = 2_100_000  # one for each direction of the longest sweep, and comments
_FREQUENCY_UNIT = re.compile(r"[\[(]?\s*(k?hz|rad/s|rpm|1/min|[mµu]?s)\s*[\])]?", re.IGNORECASE)
Row = tuple[int, list[str]]  # line, cells


@dataclass(frozen=True)
class TextForm:
    """Form of a text file; empty: found out from the file."""

    separator: str = ""
    decimal: str = ""


def read(path: Path, wanted: Mapping[str, WantedColumn], form: TextForm | None = None) -> Columns:
    """The columns wanted; FormatError, with the line, where one is missing or a cell is no number."""
    form = form or TextForm()
    lines = list(lines_of(text_of(path), LONGEST_LINE, LINES))
    place, heads, separator = _head(lines, wanted, form)
    places = {role: found for role, each in wanted.items() if (found := find(heads, each)) is not None}
    below = [(line, text) for line, text in lines[place:] if text.lstrip()[0] not in "#%"]
    if below and not form.separator:
        separator = _of_rows(*below[0], len(heads), separator)
    needed = 1 + max(places[role] for role in places if wanted[role].needed)
    units, rows = _units_line(list(_rows(below[:1], heads, separator, needed)), places, wanted)
    below = below if rows else below[1:]
    plain = not form.decimal and not any(wanted[role].words for role in places)
    if plain and (table := _table(below, heads, separator)) is not None:
        said = {role: (*split_head(heads[column]), table[:, column].copy()) for role, column in places.items()}
        numbers = {role: CurveColumn(name, units.get(role, unit), kept) for role, (name, unit, kept) in said.items()}
        return Columns(numbers, tuple(line for line, _ in below), tuple(heads))
    rows = list(_rows(below, heads, separator, needed))
    kept = [row for row in rows if any(row[1][places[role]].strip() for role in places if wanted[role].needed)]
    if not kept:
        raise FormatError("has no line of numbers below its heads")
    cells = ((line, row[place]) for line, row in kept for role, place in places.items() if not wanted[role].words)
    decimal = form.decimal or decimal_sign(cells)
    columns = {}
    for role, column in places.items():
        name, unit = split_head(heads[column])
        own = [(line, cells[column]) for line, cells in kept]
        if wanted[role].words:
            columns[role] = CurveColumn(name, "", np.full(len(own), np.nan), tuple(cell.strip() for _, cell in own))
        else:
            columns[role] = CurveColumn(name, units.get(role, unit), np.array([number(each, decimal) for each in own]))
    return Columns(columns, tuple(line for line, _ in kept), tuple(heads))


def _table(below: list[tuple[int, str]], heads: list[str], separator: str) -> Array | None:
    """All lines as one table, where each cell is a plain finite number with a decimal point; None where one is not."""
    lines = [text for _, text in below]
    if not lines or (separator != " " and any(line.count(separator) != len(heads) - 1 for line in lines)):
        return None
    try:
        table = np.loadtxt(lines, delimiter=None if separator == " " else separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return table if table.shape[1] == len(heads) and np.isfinite(table).all() else None


def _head(
    lines: list[tuple[int, str]], wanted: Mapping[str, WantedColumn], form: TextForm
) -> tuple[int, list[str], str]:
    """Index of the first line below the heads, the heads, the separator between them."""
    if all(isinstance(name, int) for each in wanted.values() for name in each.names if each.needed):
        return _without_head(lines, wanted, form)
    separators = (form.separator,) if form.separator else SEPARATORS
    best: tuple[int, list[str], str] | None = None
    for place, (line, text) in enumerate(_first(lines)):
        for separator in separators:
            heads = _heads_of(line, text, separator)
            if best and (separator == " " or len(heads) <= len(best[1])):
                continue
            if all(find(heads, each) is not None for each in wanted.values() if each.needed):
                best = place + 1, heads, separator
        if best:
            return best[0], _trimmed(best[1]), best[2]
    raise _no_heads(lines, wanted, separators)


def _first(lines: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """The lines that may be heads."""
    lengths = accumulate(len(text) for _, text in lines[:LONGEST_HEAD])
    return [line for line, length in zip(lines, lengths, strict=False) if length <= LONGEST_LINE]


def _heads_of(line: int, text: str, separator: str) -> list[str]:
    """Heads of a line, which may be a comment; a unit in brackets belongs to the word before it."""
    heads = text.lstrip("#%").strip() if text[0] in "#%" else text
    return re.split(r"\s+(?![\[(])", heads.strip()) if separator == " " else _cells_of(line, heads, separator)


def _no_heads(
    lines: list[tuple[int, str]], wanted: Mapping[str, WantedColumn], separators: tuple[str, ...]
) -> HeadError:
    """The message for a file whose heads are other ones: those of the line that looks most like heads."""
    likely, line = list[str](), None
    for count, text in _first(lines):
        heads = max((_trimmed(_cells_of(count, text, each)) for each in separators[:-1] or separators), key=len)
        if sum(map(bool, heads)) > len(likely) and not any(
            re.fullmatch(r"[+-]?[0-9.,eE+-]+", each) for each in heads if each
        ):
            likely, line = heads, count
    found = {role: find(likely, each) for role, each in wanted.items()}
    fault = missing(likely, wanted, found)
    assert fault is not None  # or it would have been the head
    return HeadError(fault.message, likely, line or (lines[0][0] if lines else None))


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


def _without_head(
    lines: list[tuple[int, str]], wanted: Mapping[str, WantedColumn], form: TextForm
) -> tuple[int, list[str], str]:
    """As ``_head`` of a file whose columns are told by number: numbers begin where all of these are numbers."""
    needed = [name for each in wanted.values() if each.needed for name in each.names if isinstance(name, int)]
    for place, (line, text) in enumerate(_first(lines)):
        for separator in (form.separator,) if form.separator else SEPARATORS:
            cells = _cells_of(line, text, separator)
            if len(cells) >= max(needed) and all(_numeric(cells[each - 1]) for each in needed):
                heads = _cells_of(*lines[place - 1], separator) if place else []
                named = len(heads) == len(cells)
                return place, heads if named else [f"column {each + 1}" for each in range(len(cells))], separator
    raise FormatError(f"has no line with numbers in the columns {' and '.join(map(str, needed))}")


def _numeric(text: str) -> bool:
    return len(text) <= LONGEST and bool(re.fullmatch(r"\s*[+-]?[0-9.,'  ]*[0-9][0-9.,]*([eEdD][+-]?[0-9]+)?\s*", text))


def _rows(lines: list[tuple[int, str]], heads: list[str], separator: str, needed: int) -> Iterator[Row]:
    """Rows of cells, as many as heads; FormatError where a row has more, or is cut off before the ``needed`` ones."""
    for line, text in lines:
        raw = _cells_of(line, text, separator)
        cells = _trimmed(raw)
        if not cells:
            continue
        if len(cells) > len(heads):
            why = ": decimal commas between commas? Export with semicolons" if separator == "," else ""
            raise FormatError(f"{len(cells)} cells for {len(heads)} columns{why}", line)
        if len(raw) < needed:
            counted = f"{len(raw)} cell{'s' * (len(raw) != 1)} for {len(heads)} columns"
            raise FormatError(f"{counted}, {shown(text)}: complete the line, delete it, or begin it with #", line)
        yield line, cells + [""] * (len(heads) - len(cells))


def _of_rows(line: int, text: str, count: int, separator: str) -> str:
    """Separator of the rows: the heads', unless they have none of it and another gives as many cells as heads."""
    if count == 1 or len(_cells_of(line, text, separator)) > 1:
        return separator
    fitting = [each for each in SEPARATORS if len(_trimmed(_cells_of(line, text, each))) == count]
    return fitting[0] if fitting else separator


def _units_line(
    rows: list[Row], places: Mapping[str, int], wanted: Mapping[str, WantedColumn]
) -> tuple[dict[str, str], list[Row]]:
    """Units from a line of their own below the heads, and the rows after it."""
    if not rows or "frequency" not in places or not _FREQUENCY_UNIT.fullmatch(rows[0][1][places["frequency"]].strip()):
        return {}, rows
    cells = rows[0][1]
    units = {role: cells[place].strip().strip("[]()").strip() for role, place in places.items()}
    return {role: unit for role, unit in units.items() if not wanted[role].words}, rows[1:]


LONGEST = 100  # characters of a number: some expressions below take time with their square
EMPTY = ("", "-", "--", "n/a", "na", "nan", "null", "none")
_GROUPED = re.compile(r"([+-]?[0-9]{1,3})((?:[ \u00a0\u202f'’][0-9]{3})+)(?![0-9])")
_LIKELY = re.compile(r"[+-]?[0-9.,'’ \u00a0\u202f]+([eEdD][+-]?[0-9]+)?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eEdD][+-]?[0-9]+)?")
_EITHER = re.compile(r"[+-]?[1-9][0-9]{0,2}[.,][0-9]{3}")  # 1,234: a thousand and more, or one and a bit
_THOUSANDS = {mark: re.compile(rf"[+-]?[0-9]{{1,3}}(?:{re.escape(mark)}[0-9]{{3}})+") for mark in ".,"}
Cell = tuple[int, str]  # line, text


def decimal_sign(cells: Iterable[Cell]) -> str:
    """The decimal sign that all cells have; FormatError where they differ, or where it cannot be told."""
    proof, doubt, grouped = dict[str, Cell](), dict[str, Cell](), False
    for line, text in cells:
        signs = re.sub(r"[^.,]", "", text[:LONGEST])
        if not signs or len(text) > LONGEST or not _LIKELY.fullmatch(text.strip()):
            continue
        both, last = len(set(signs)) == 2, signs[-1]
        grouped |= both
        if len(signs) > 1 and not both:  # 1.234.567: a thousands separator
            last = "," if last == "." else "."
        kind = doubt if _EITHER.fullmatch(text.strip()) else proof
        kind.setdefault(last, (line, text.strip()))
    if len(proof) == 2:
        (_, one), (line, other) = sorted(proof.values())
        raise FormatError(f"{one!r} and {other!r} have different decimal signs: write all numbers alike", line)
    sign = next(iter(proof), ".")
    other = "," if sign == "." else "."
    if other in doubt and not (grouped and proof):
        line, text = doubt[other]
        either = f"{text.replace(',', '').replace('.', '')} or {text.replace(',', '.')}"
        raise FormatError(f'{text!r} may be {either}: say decimal = "," or decimal = "." in the case', line)
    return sign


def number(cell: Cell, decimal: str) -> float:
    """A cell as a number, NaN where it is empty; FormatError where it is none."""
    line, text = cell[0], cell[1].strip()
    if text.casefold() in EMPTY:
        return nan
    if len(text) > LONGEST:
        raise FormatError(f"{shown(text)} is not a number: it has {len(text)} characters", line)
    plain = _GROUPED.sub(lambda found: found[1] + re.sub("[^0-9]", "", found[2]), text.replace("−", "-"))
    mark = "." if decimal == "," else ","
    whole, sign, rest = plain.partition(decimal)
    if mark in whole:
        if not _THOUSANDS[mark].fullmatch(whole):
            raise FormatError(f"{shown(text)} is not a number with the decimal sign {decimal!r}", line)
        whole = whole.replace(mark, "")
    written = whole + ("." if sign else "") + rest
    if not _NUMBER.fullmatch(written):
        raise FormatError(f"{shown(text)} is not a number{_hint(text)}", line)
    value = float(written.replace("D", "e").replace("d", "e"))
    if not isfinite(value):
        raise FormatError(f"{shown(text)} is not a finite number", line)
    return value


def _hint(text: str) -> str:
    if len(re.findall(r"[0-9][.,]?[0-9]*[eEdD]?[+-]?[0-9]*", text)) and re.search(r"[0-9][+-][0-9.]", text):
        return ": two numbers without a blank between them?"
    if re.match(r"[+-]?[0-9.,]+\s*[A-Za-zµ%/]+", text):
        return ": write the unit into the head, or into units of the case"
    return ": delete the line, or begin it with #"
