"""Numbers as text, one row of the array a line, between blanks or commas."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, require_room
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.text import Line, lines_of, text_of

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
SHOWN = 40  # characters of a line in a message


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The array of a file; ``#`` begins a comment."""
    require_no_name(name)
    text = text_of(path)

    def rows() -> Iterator[Line]:
        for number, line in lines_of(text):
            if cells := line.partition("#")[0].replace(",", " ").strip():
                yield number, cells

    width = len(next(rows(), (0, ""))[1].split())
    if not width:
        raise FormatError("holds no numbers")
    return FileMatrix(table(rows, width))


def require_no_name(name: str) -> None:
    """FormatError for a ``name`` of what has none."""
    if name:
        raise FormatError(f"holds one matrix without a name: leave name = {name!r} away")


def table(rows: Callable[[], Iterable[Line]], width: int) -> NDArray[np.float64]:
    """The numbers (lines, width) of rows, between blanks; FormatError with the first line that has others.

    ``rows`` is called again to find that line. Only digits of ASCII are numbers, and only finite ones.
    """
    try:
        found = np.loadtxt((line for _, line in rows()), comments=None, ndmin=2)
    except ValueError:
        raise _fault(rows(), width) from None
    if found.shape[1:] != (width,) or not np.isfinite(found).all():
        raise _fault(rows(), width)
    require_room(found.shape)
    return found


def _fault(rows: Iterable[Line], width: int) -> FormatError:
    """What is wrong with the first row that is none."""
    for number, line in rows:
        words = line.split(maxsplit=width)
        if len(words) != width:
            counted = "more" if len(words) > width else len(words)
            return FormatError(f"{shown(line)} has {counted} numbers in place of {width}", number)
        for word in words:
            if not _NUMBER.fullmatch(word):
                return FormatError(f"{shown(word)} is no number", number)
            if not np.isfinite(float(word)):
                return FormatError(f"{shown(word)} is beyond the largest number", number)
    return FormatError("cannot be read as rows of numbers")


def shown(text: str) -> str:
    """Text as a message shows it."""
    text = text.strip()
    return repr(text if len(text) <= SHOWN else f"{text[:SHOWN]} …")
