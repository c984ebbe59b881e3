"""Numbers as text, one row of the array a line, between blanks or commas."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vibeam.exchange.matrices.entries import FileMatrix, FormatError


def read(path: Path, name: str, wanted: str) -> FileMatrix:
    """The array of a file; ``#`` begins a comment."""
    if name:
        raise FormatError(f"holds one array without a name: leave name = {name!r} away")
    rows: list[list[float]] = []
    for number, line in enumerate(_lines(path), start=1):
        words = line.partition("#")[0].replace(",", " ").split()
        try:
            rows += [[float(word) for word in words]] if words else []
        except ValueError:
            raise FormatError(f"line {number}: {line.strip()[:40]!r} is no row of numbers") from None
        if rows and len(rows[-1]) != len(rows[0]):
            raise FormatError(f"line {number}: {len(rows[-1])} numbers, the rows before have {len(rows[0])}")
    if not rows:
        raise FormatError("holds no numbers")
    return FileMatrix(np.array(rows))


def _lines(path: Path) -> list[str]:
    return text_of(path).splitlines()


def text_of(path: Path) -> str:
    """The text of a file; FormatError where it is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except (UnicodeDecodeError, OSError) as error:
        raise FormatError(f"is no text: {error}") from None
