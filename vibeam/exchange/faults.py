"""Faults in a case and the files that it names: every fault with its line, all reported together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from os.path import relpath
from pathlib import Path

OVERRIDE = "--set"  # in place of a file name, for a fault in an override


@dataclass(frozen=True)
class Fault:
    """Fault: file (or ``"--set"``), line (None: no single one), key (empty: the whole file), message with the cure."""

    file: str
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        where = f"{OVERRIDE} {self.key}" if self.file == OVERRIDE else self._place()
        return printable(f"{where}: {self.message}")

    def _place(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        return f"{place}: {self.key}" if self.key else place

    @property
    def order(self) -> tuple[bool, int, str]:
        """Sort key: by line, overrides last."""
        return self.file == OVERRIDE, self.line or 0, self.key


def fault_in(path: Path, line: int | None, message: str) -> Fault:
    """Fault in a file, named by the shorter of its paths."""
    return Fault(shortest(path), line, "", message)


def shortest(path: Path) -> str:
    """Path from the working directory where that is shorter, else unchanged."""
    try:
        return min(str(path), relpath(path), key=len)
    except (OSError, ValueError):  # the working directory does not exist
        return str(path)


SHOWN = 50  # faults in the text of an error


class CaseError(ValueError):
    """Invalid case. ``faults`` holds every fault in line order; the text has one a line, of many the first.

    >>> import vibeam
    >>> try:
    ...     vibeam.load("cases/dtu_neutral.toml", {"stop.restitution": 1.2})
    ... except vibeam.CaseError as error:
    ...     print(error)
    --set stop.restitution: 1.2 is outside [0, 1]
    """

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(sorted(dict.fromkeys(faults), key=lambda fault: fault.order))
        more = len(self.faults) - SHOWN
        rest = [f"… and {more} more"] if more > 0 else []
        super().__init__("\n".join([*map(str, self.faults[:SHOWN]), *rest]))

    def __reduce__(self) -> tuple[type[CaseError], tuple[tuple[Fault, ...]]]:
        return type(self), (self.faults,)


def reason_of(refusal: ValueError) -> str:
    """Reason of a refusal, without the file name before each fault."""
    if isinstance(refusal, CaseError):
        return "; ".join(f"{fault.key}: {fault.message}" for fault in refusal.faults)
    return str(refusal)


KNOWN = "known here: "


def suggestion(wrong: str, known: Iterable[str]) -> str | None:
    """Known name closest to ``wrong``, or None."""
    names = {name.lower(): name for name in reversed(list(known))}
    close = get_close_matches(wrong.lower(), names, n=1, cutoff=0.6)
    return names[close[0]] if close else None


def suggest(wrong: str, known: Iterable[str]) -> str:
    """``did you mean 'density'?``, or the list of known names, none perhaps, where none is near."""
    names = list(known)
    near = suggestion(wrong, names)
    return f"did you mean '{near}'?" if near else f"{KNOWN}{', '.join(names) or 'none'}"


def printable(text: str) -> str:
    """Text with every control, format and surrogate character escaped: ``\\x1b``, ``\\u202e``."""
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() else each.encode("unicode_escape", "replace").decode() for each in text)


def as_shown_in_message(value: object) -> str:
    """Value as shown in a message: text in quotes, numbers bare, tables and lists by their kind, all of it short."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict | list | tuple):
        return "a table" if isinstance(value, dict) else "a list"
    if isinstance(value, int) and value.bit_length() > 128:
        return "a number of more than 38 digits"
    text = repr(value) if isinstance(value, str | int | float) else f"the date or time {value}"
    return text if len(text) <= 60 else f"{text[:56]} …{text[-1]}"


def shortened(name: str, longest: int = 40) -> str:
    """Name as shown in a message: its beginning where it is longer than ``longest``."""
    return name if len(name) <= longest else f"{name[: longest - 1]}…"


KeyPath = tuple[str | int, ...]


Complaint = tuple[KeyPath, str]  # place in the case, and message
