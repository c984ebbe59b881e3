"""Files of others as they lie there: kind, size, digest; of text encoding and lines; of nested tables the values."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import lru_cache
from hashlib import file_digest
from math import isfinite, prod
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Any

from vibeam.system.record_samples import MOST_SAMPLES

LARGEST = 2_000_000_000  # bytes on disk
LARGEST_TEXT = 100_000_000  # bytes on disk of what is text, and of a measured curve
NUMBERS = 25_000_000  # of one array: what is made of it on the way stays below 2 GiB
BYTES = 8 * NUMBERS
COORDINATES = 1_000_000  # rows or columns of one matrix
State = tuple[int, int]  # time of the last change in ns, size


class FormatError(ValueError):
    """File that cannot be read as what it should be: the message says what is wrong, ``line`` where (None: nowhere)."""

    def __init__(self, message: str, line: int | None = None) -> None:
        self.message, self.line = message, line
        super().__init__(message if line is None else f"line {line}: {message}")


def reason(error: Exception) -> str:
    """Reason that the system, or another library, gives of a file, in one line without its path."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror.lower()
    if isinstance(error, UnboundLocalError):  # of scipy, where a head or the numbers are not there
        return "a part of it is missing"
    return (str(error).splitlines() or [""])[0][:200] or type(error).__name__


@contextmanager
def read_by(
    said: str = "cannot be read", refusal: type[Exception] = Exception, line: int | None = None
) -> Iterator[None]:
    """Context of a reading by the system or another library, whose every ``refusal`` becomes a FormatError.

    ``said``: its message before the reason. A FormatError from within goes through as it is, or gets the ``line``.
    """
    try:
        yield
    except refusal as error:
        if isinstance(error, FormatError) and line is None:
            raise
        raise FormatError(": ".join(filter(None, (said, reason(error)))), line) from None


SHOWN = 40  # characters of a text in a message
_WHOLE = re.compile(r"[+-]?[0-9]{1,15}")
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def shown(text: str) -> str:
    """Text as a message shows it."""
    text = text.strip()
    return repr(text if len(text) <= SHOWN else f"{text[:SHOWN]} …")


def whole(text: str) -> int:
    """The whole number that is written in digits of ASCII; FormatError for any other text."""
    if not _WHOLE.fullmatch(text):
        raise FormatError(f"{shown(text)} is no whole number")
    return int(text)


def real(text: str, spelt: str = "") -> float:
    """The finite number that is written in digits of ASCII; FormatError for other text, as the file ``spelt`` it."""
    if not _REAL.fullmatch(text):
        raise FormatError(f"{shown(spelt or text)} is no number")
    if not isfinite(value := float(text)):
        raise FormatError(f"{shown(spelt or text)} is beyond the largest number")
    return value


def dotted(tables: Mapping[str, Any], above: str = "", spelt: Callable[[str], str] = str) -> Iterator[tuple[str, Any]]:
    """Values of nested tables by dotted names, ``data.f``, each part as ``spelt``."""
    for name, value in tables.items():
        place = above + spelt(name)
        if isinstance(value, Mapping):
            yield from dotted(value, f"{place}.", spelt)
        else:
            yield place, value


def state_of(path: Path, largest: int = LARGEST) -> State:
    """State of a regular file, which is not opened; FormatError for what is none, empty, or too large.

    What the kernel makes as it is read (/proc/kmsg, which never ends) has no size: it counts as empty.
    """
    try:
        found = path.stat()
    except (FileNotFoundError, ValueError):  # a NUL in the name
        raise FormatError("no such file") from None
    except OSError as error:
        raise FormatError(f"cannot be read: {reason(error)}") from None
    if not S_ISREG(found.st_mode):
        raise FormatError("is a folder, not a file" if S_ISDIR(found.st_mode) else "is not a regular file")
    if not found.st_size:
        raise FormatError("is empty")
    if found.st_size > largest:
        raise FormatError(f"has {found.st_size / 1e6:.0f} MB; such a file may have {largest / 1e6:.0f} MB at most")
    return found.st_mtime_ns, found.st_size


def file_fault(path: Path) -> str | None:
    """Reason why a path cannot be read as text or a measured curve, or None; it is not opened."""
    try:
        state_of(path, LARGEST_TEXT)
    except FormatError as fault:
        return fault.message
    return None


def require_room(shape: Sequence[int], itemsize: int = 8) -> None:
    """FormatError for an array that is too large to be read, before it is."""
    shown = " × ".join(map(str, shape)) or "1"
    if min(shape, default=1) < 0:
        raise FormatError(f"says that it is {shown}")
    if max(shape, default=1) > NUMBERS or prod(shape) > NUMBERS:
        raise FormatError(f"is {shown}; an array may have {NUMBERS:,} numbers at most".replace(",", " "))
    if prod(shape) * itemsize > 2 * BYTES:
        raise FormatError(f"is {shown} of {itemsize} bytes; an array may have {2 * BYTES / 1e6:.0f} MB at most")


def require_coordinates(*sizes: int) -> None:
    """FormatError for a matrix of more rows or columns than are read."""
    if max(sizes) > COORDINATES:
        raise FormatError(f"has {max(sizes)} coordinates; a matrix may have {COORDINATES:,} at most".replace(",", " "))


def require_samples(shape: Sequence[int]) -> None:
    """FormatError for a column of more samples than a record may have, before it is read, or made floats."""
    if max(shape, default=1) > MOST_SAMPLES:
        raise FormatError(f"has {max(shape)} samples; {MOST_SAMPLES} at most: cut the record, or sample it again")


def digest_of(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal; FormatError as ``state_of``."""
    return _digest(path, state_of(path))


@lru_cache(maxsize=64)
def _digest(path: Path, state: State) -> str:
    with read_by(refusal=OSError), path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


LINES = 5_000_000  # of one file: 100 MB of lines of 20 characters
LONGEST = 30_000_000  # characters of a line: a row of a million numbers
Line = tuple[int, str]  # number from 1, text
_LINE = re.compile(r"([^\r\n]*)(?:\r\r\n|\r\n|\n|\r|\Z)")


def text_of(path: Path) -> str:
    """The text of a file in UTF-8, UTF-16 with its mark, or Windows' Latin; FormatError where it is no text."""
    state_of(path, LARGEST_TEXT)
    with read_by(refusal=OSError):
        raw = path.read_bytes()
    if raw.startswith(b"PK\x03\x04"):
        raise FormatError("is a workbook, not text: save the sheet as CSV")
    encodings = ("utf-16",) if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252")
    for encoding in encodings:
        with suppress(UnicodeDecodeError):
            if "\0" not in (text := raw.decode(encoding)):
                return text
    raise FormatError("cannot be read: it is not UTF-8 text")


def lines_of(text: str, longest: int = LONGEST, most: int = LINES) -> Iterator[Line]:
    """The lines that are not blank with their numbers; FormatError for one that is too long, and for too many."""
    for number, found in enumerate(_LINE.finditer(text), 1):
        line = found[1]
        if len(line) > longest:
            raise FormatError(f"has {len(line)} characters; a line may have {longest} at most", number)
        if number > most:
            raise FormatError(f"has more than {most} lines: keep fewer, or write them as .npz, .mat or HDF5")
        if line and not line.isspace():
            yield number, line
