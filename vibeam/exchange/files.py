"""Files of others as they lie there: whether they may be read at all, how much, and what they hold as a digest."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from hashlib import sha256
from math import prod
from pathlib import Path
from stat import S_ISDIR, S_ISREG

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
    """What the system, or another library, says of a file, in one line without its path."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror.lower()
    return (str(error).splitlines() or [""])[0][:200] or type(error).__name__


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
        limit = f"{COORDINATES:,}".replace(",", " ")
        raise FormatError(f"has {max(sizes)} coordinates; a matrix may have {limit} at most")


def digest_of(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal; FormatError as ``state_of``."""
    return _digest(path, state_of(path))


@lru_cache(maxsize=64)
def _digest(path: Path, state: State) -> str:
    try:
        with path.open("rb") as file:
            made = sha256()
            while block := file.read(1 << 20):
                made.update(block)
    except OSError as error:
        raise FormatError(f"cannot be read: {reason(error)}") from None
    return made.hexdigest()
