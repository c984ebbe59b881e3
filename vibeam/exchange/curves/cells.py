"""Numbers and units in text as instruments and spreadsheets write them.

Numbers have decimal commas, thousands separators, D exponents; units that a file says outside the heads of its columns
stand in rows of their own, in settings of instruments, in comments.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite, nan

import numpy as np

from vibeam.exchange.curves.columns import TIMES, bracketed, is_unit, split_head
from vibeam.exchange.files import FormatError, shown
from vibeam.exchange.units import factor
from vibeam_models.arrays import Array

LONGEST = 100  # characters of a number: some expressions below take time with their square
EMPTY = ("", "-", "--", "n/a", "na", "nan", "null", "none")
_GROUPED = re.compile(r"([+-]?[0-9]{1,3})((?:[ \u00a0\u202f'’][0-9]{3})+)(?![0-9])")
_LIKELY = re.compile(r"[+-]?[0-9.,'’ \u00a0\u202f]+([eEdD][+-]?[0-9]+)?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eEdD][+-]?[0-9]+)?")
_EITHER = re.compile(r"[+-]?[1-9][0-9]{0,2}[.,][0-9]{3}")  # 1,234: a thousand and more, or one and a bit
_THOUSANDS = {mark: re.compile(rf"[+-]?[0-9]{{1,3}}(?:{re.escape(mark)}[0-9]{{3}})+") for mark in ".,"}
Cell = tuple[int, str]  # line, text
Plain = dict[str, Array]


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


def numeric(text: str) -> bool:
    """Test whether a cell looks like a number."""
    return len(text) <= LONGEST and bool(re.fullmatch(r"\s*[+-]?[0-9.,'  ]*[0-9][0-9.,]*([eEdD][+-]?[0-9]+)?\s*", text))


def _hint(text: str) -> str:
    if len(re.findall(r"[0-9][.,]?[0-9]*[eEdD]?[+-]?[0-9]*", text)) and re.search(r"[0-9][+-][0-9.]", text):
        return ": two numbers without a blank between them?"
    if re.match(r"[+-]?[0-9.,]+\s*[A-Za-zµ%/]+", text):
        return ": write the unit into the head, or into units of the case"
    return ": delete the line, or begin it with #"


def plain_table(lines: Sequence[str], separator: str, cells: range, places: Mapping[str, int]) -> Plain | None:
    """Columns of lines of so many ``cells`` that are plain finite numbers with a decimal point; None where not."""
    counts = (len(line.split()) if separator == " " else line.count(separator) + 1 for line in lines)
    if not lines or any(count not in cells for count in counts):
        return None
    mark = None if separator == " " else separator
    try:
        table = np.loadtxt(lines, delimiter=mark, comments=None, usecols=[*places.values()], ndmin=2)
    except ValueError:
        return None
    return dict(zip(places, table.T.copy(), strict=True)) if np.isfinite(table).all() else None


LONGEST_SETTING = 200  # characters of a setting
COUNTS = ("sequence", "sample", "samples", "point", "points", "index")  # what stands in place of a unit of time
QUANTITY = re.compile(r"acc|vel|disp|force|kraft|moment|torque|ampl|magn|value|signal|data", re.IGNORECASE)
ABSCISSA = re.compile(r"hor|time|zeit|absc|freq|x\b|x[ _-]", re.IGNORECASE)
ORDINATE = re.compile(r"vert|ord|y\b|y[ _-]", re.IGNORECASE)
_SETTING = re.compile(r"([\w .-]*?)[ _-]*\bunits?(?:[ _-]*label)?\s*[:=,;\t(\[]\s*(.+)", re.IGNORECASE)
_PHRASE = re.compile(r"([^\W\d]\w*)\s*(?:\b(?:\w+ )?in\b(?: units of\b)?|[:=(\[])\s*([^\s,;()\[\]]+)", re.IGNORECASE)


def units_row(cells: Sequence[str], needed: Sequence[int], at: int | None) -> Mapping[int, str]:
    """Units by column, where cells are a row of them, those of the columns ``needed``; ``at``: of the abscissa.

    Words beside a unit of time or frequency are units too, which nobody knows.
    """
    if any(map(numeric, cells)) or len(cells) <= max(needed, default=0):
        return {}
    sure = all(is_unit(cells[each]) or bracketed(cells[each]) or not cells[each] for each in needed)
    first = "" if at is None or at >= len(cells) else cells[at].strip("[]() ")
    clock = (is_unit(first) and first.casefold() not in TIMES) or first.casefold() in COUNTS
    if not (clock or (sure and any(cells[each] for each in needed))):
        return {}
    plain = (cell.strip()[1:-1].strip() if bracketed(cell) else cell.strip() for cell in cells)
    return {place: unit for place, unit in enumerate(plain) if unit}


def settings(text: str, heads: Sequence[str], value: int, at: int | None) -> Iterator[Mapping[int, str]]:
    """Units by column that a setting of an instrument, or a comment, says of the value and of the abscissa."""
    text, places = (
        text[:LONGEST_SETTING].replace('"', "").lstrip("#% "),
        {value: ORDINATE} | ({} if at is None else {at: ABSCISSA}),
    )
    if found := _SETTING.match(text):
        name, units = found[1], [each for each in re.split(r"[\s,;|)\]]+", found[2]) if each]
        of = [place for place, words in places.items() if words.match(name) or _is(name, heads[place])]
        if of or (not name and len(units) == 1):
            yield {(of or [value])[0]: units[0]}
        elif not name and len(units) == len(heads):
            yield dict(enumerate(units))
        return
    for name, unit in _PHRASE.findall(text):
        for place in places:
            usual = name.casefold() in TIMES if place == at else bool(QUANTITY.match(name))
            if is_unit(unit) and (usual or _is(name, heads[place])):
                yield {place: unit}


def _is(name: str, head: str) -> bool:
    return bool(name) and name.strip().casefold() == split_head(head)[0].casefold()


def one_unit(own: str, said: Sequence[tuple[str, str]]) -> tuple[str, str]:
    """Unit of a column by its ``own`` head and by what is ``said`` elsewhere, (where, unit), and where it is from.

    Units that differ are joined to one that nobody knows, so that a message names both.
    """
    every = [("", own)] * bool(own) + [*said]
    if not every:
        return "", ""
    origin, unit = every[0]
    others = [each for _, each in every[1:] if not _same(unit, each)]
    return " or ".join(dict.fromkeys([unit, *others])), origin


def _same(one: str, other: str) -> bool:
    try:
        return one == other or {one, other} == {"g", "G"} or factor(one, other) == 1.0
    except ValueError:
        return False
