"""Units that a text file says outside the heads of its columns: rows of units, settings of instruments, comments."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from vibeam.exchange.curves.columns import TIMES, bracketed, is_unit, split_head
from vibeam.exchange.curves.numbers import numeric
from vibeam.exchange.curves.record import factor

LONGEST = 200  # characters of a setting
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
        text[:LONGEST].replace('"', "").lstrip("#% "),
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
