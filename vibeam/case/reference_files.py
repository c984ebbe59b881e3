"""Reference files: readability checks, and lines as cells."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from os.path import relpath
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from vibeam.case.faults import CaseError, Fault

LARGEST = 100_000_000  # bytes: one line for each direction of the longest sweep


def file_fault(path: Path) -> str | None:
    """Reason why a path cannot be read as a reference file, or None; it is not opened."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return "no such file"
    except (OSError, ValueError) as error:
        return f"cannot be read: {reason(error)}"
    if not S_ISREG(found.st_mode):
        return "is a folder, not a file" if S_ISDIR(found.st_mode) else "is not a regular file"
    if found.st_size > LARGEST:
        return f"has {found.st_size / 1e6:.0f} MB; a reference file has at most {LARGEST / 1e6:.0f} MB"
    return None


def cells_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every line but empty ones and comments; CaseError where the file is unreadable."""
    if fault := file_fault(path):
        raise CaseError([fault_in(path, None, fault)])
    number = 0
    try:
        with path.open(encoding="utf-8-sig") as file:
            for number, line in enumerate(file, 1):
                if line.strip() and not line.startswith("#"):
                    yield number, [cell.strip() for cell in next(csv.reader([line]))]
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError([fault_in(path, None, f"cannot be read: {reason(error)}")]) from None
    except csv.Error as error:
        raise CaseError([fault_in(path, number, f"is no line of a table: {error}")]) from None


def fault_in(path: Path, line: int | None, message: str, column: str = "") -> Fault:
    """Fault in a reference file, named by the shorter of its paths."""
    return Fault(shortest(path), line, column, message)


def shortest(path: Path) -> str:
    """Path from the working directory where that is shorter, else unchanged."""
    try:
        return min(str(path), relpath(path), key=len)
    except (OSError, ValueError):  # the working directory does not exist
        return str(path)


def reason(error: OSError | ValueError) -> str:
    """Reason of an error, in words for a message."""
    if isinstance(error, UnicodeDecodeError):
        return "it is not UTF-8 text"
    return str(getattr(error, "strerror", None) or error).lower()
