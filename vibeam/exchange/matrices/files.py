"""Files of others as they lie there: whether they can be read at all, and what they hold as a digest."""

from __future__ import annotations

from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from vibeam.exchange.matrices.entries import FormatError

LARGEST = 2_000_000_000  # bytes

State = tuple[int, int]  # time of the last change in ns, size


def state_of(path: Path) -> State:
    """State of a regular file, which is not opened; FormatError for what is none, or too large."""
    try:
        found = path.stat()
    except (FileNotFoundError, ValueError):  # a NUL in the name
        raise FormatError("there is no such file") from None
    except OSError as error:
        raise FormatError(f"cannot be read: {error.strerror or error}") from None
    if not S_ISREG(found.st_mode):
        raise FormatError("is a folder, not a file" if S_ISDIR(found.st_mode) else "is not a regular file")
    if found.st_size > LARGEST:
        raise FormatError(f"has {found.st_size / 1e6:.0f} MB; a file may have {LARGEST / 1e6:.0f} MB at most")
    return found.st_mtime_ns, found.st_size


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
        raise FormatError(f"cannot be read: {error.strerror}") from None
    return made.hexdigest()
