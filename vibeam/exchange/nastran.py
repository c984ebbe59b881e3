"""Nastran's bulk data: entries, each with its fields and those of its continuations.

Fields of 8 columns, of 16 where the entry is NAME*, or between commas; a continuation begins with a blank, + or * (MSC
Nastran Quick Reference Guide).
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from vibeam.exchange.files import FormatError, lines_of, real

SMALL, LARGE = 8, 16  # characters of a field


def cards(bulk: str, above: int = 0) -> Iterator[tuple[int, str, list[str]]]:
    """Line, name and fields of every entry in capitals, its continuations joined; FormatError for an INCLUDE.

    ``above``: lines of the file before these.
    """
    start, name, fields = 0, "", [""]
    for number, line in (*lines_of(bulk), (0, "END")):
        text = line.partition("$")[0].rstrip().expandtabs(SMALL)
        if not text:
            continue
        if text.lstrip().startswith("INCLUDE"):
            raise FormatError("INCLUDE: another file is not read: put its lines into this one", above + number)
        first, further = _fields(text)
        if not first or first[0] in "+*":
            fields.extend(further)
        else:
            yield start, name, fields
            start, name, fields = above + number, first.rstrip("*"), further


def _fields(text: str) -> tuple[str, list[str]]:
    """First field of a line, and its other ones, filled up so that those of a continuation are in place."""
    if "," in text:
        first, *fields = (each.strip() for each in text.split(","))
    else:
        first, width = text[:SMALL].strip(), LARGE if "*" in text[:SMALL] else SMALL
        fields = [text[at : at + width].strip() for at in range(SMALL, SMALL + 64, width)]
    count = 4 if "*" in first else 8
    return first, [*fields, *[""] * count][:count]


def real_field(field: str) -> float:
    """The real number of a field, whose exponent may have D, or no letter: ``1.5-3``; FormatError where it is none."""
    number = field.replace("D", "E")
    return real(number if "E" in number else re.sub(r"(?<=[0-9.])([+-])", r"E\1", number), field)
