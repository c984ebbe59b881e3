"""Reference files: readability checks, and lines as cells."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from os.path import relpath
from pathlib import Path

from vibeam.case.faults import CaseError, Fault
from vibeam.exchange.files import LARGEST_TEXT, FormatError, reason, state_of
from vibeam.exchange.text import numbered

LONGEST = 100_000  # characters of a line

LINES = 2_100_000  # one for each direction of the longest sweep, and comments


def file_fault(path: Path) -> str | None:
    """Reason why a path cannot be read as a reference file, or None; it is not opened."""
    try:
        state_of(path, LARGEST_TEXT)
    except FormatError as fault:
        return fault.message
    return None


def cells_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every line but empty ones and comments; CaseError where the file is unreadable."""
    number = 0
    try:
        state_of(path, LARGEST_TEXT)
        with path.open(encoding="utf-8-sig") as file:
            for number, line in numbered(file, LONGEST, LINES):
                if line.strip() and not line.startswith("#"):
                    yield number, [cell.strip() for cell in next(csv.reader([line]))]
    except FormatError as fault:
        raise CaseError([fault_in(path, fault.line, fault.message)]) from None
    except UnicodeDecodeError:
        raise CaseError([fault_in(path, None, "cannot be read: it is not UTF-8 text")]) from None
    except OSError as error:
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
