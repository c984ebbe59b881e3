"""Text of others: encodings, line ends, and how long a file and its lines may be."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from vibeam.exchange.files import LARGEST_TEXT, FormatError, reason, state_of

LINES = 5_000_000  # of one file: 100 MB of lines of 20 characters
LONGEST = 30_000_000  # characters of a line: a row of a million numbers
Line = tuple[int, str]  # number from 1, text
_LINE = re.compile(r"([^\r\n]*)(?:\r\r\n|\r\n|\n|\r|\Z)")


def text_of(path: Path) -> str:
    """The text of a file in UTF-8, UTF-16 with its mark, or Windows' Latin; FormatError where it is no text."""
    state_of(path, LARGEST_TEXT)
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise FormatError(f"cannot be read: {reason(error)}") from None
    if raw.startswith(b"PK\x03\x04"):
        raise FormatError("is a workbook, not text: save the sheet as CSV")
    encodings = ("utf-16",) if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252")
    for encoding in encodings:
        try:
            text = raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise FormatError("cannot be read: it is not UTF-8 text")


def lines_of(text: str, longest: int = LONGEST, most: int = LINES) -> Iterator[Line]:
    """The lines that are not blank, one after the other; FormatError as ``numbered``."""
    for number, line in numbered((found[1] for found in _LINE.finditer(text)), longest, most):
        if line and not line.isspace():
            yield number, line


def numbered(lines: Iterable[str], longest: int = LONGEST, most: int = LINES) -> Iterator[Line]:
    """Lines with their numbers; FormatError for a line that is too long, and for too many."""
    for number, line in enumerate(lines, 1):
        if len(line) > longest:
            raise FormatError(f"has {len(line)} characters; a line may have {longest} at most", number)
        if number > most:
            raise FormatError(f"has more than {most} lines: keep fewer, or write them as .npz, .mat or HDF5")
        yield number, line
