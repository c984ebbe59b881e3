"""Data sets of universal files: where each lies, and the units of the file (data set 164)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vibeam.exchange.curves.record import factor
from vibeam.exchange.files import FormatError, read_by, real, whole
from vibeam.exchange.units import LENGTH, MASS, unit_size

ROUNDED = 1e-3  # relative error of a factor of units

#: units of length and force by the code of data set 164; 9 are the user's own
CODES = {
    1: ("m", "N"), 2: ("ft", "lbf"), 3: ("m", "kgf"), 4: ("ft", "lb ft/s^2"), 5: ("mm", "mN"), 6: ("cm", "cN"),
    7: ("in", "lbf"), 8: ("mm", "kgf"), 10: ("mm", "N"),
}  # fmt: skip
_BEGIN = re.compile(rb"^ {4}-1[ \t\r]*\n *([0-9]+b?)([^\n]*)\n", re.MULTILINE)
_END = re.compile(rb" {4}-1[ \t\r]*$", re.MULTILINE)
_BEFORE_BYTES = re.compile(rb"(?:[^\n]*\n){11}")


@dataclass(frozen=True)
class DataSet:
    """Data set: its ``kind`` (``"58b"``), the ``line`` that says so, what else stands there, and the lines below."""

    kind: str
    line: int
    more: str
    content: bytes


def data_sets(path: Path) -> list[DataSet]:
    """Data sets of a file in its order; FormatError for one that does not end."""
    raw, at, line, found = path.read_bytes(), 0, 1, list[DataSet]()
    raw = raw if b"\n" in raw else raw.replace(b"\r", b"\n")
    while begin := _BEGIN.search(raw, at):
        kind, more, start = begin[1].decode(), begin[2].decode("latin1"), begin.end()
        line += raw.count(b"\n", at, start - 1)
        binary = _BEFORE_BYTES.match(raw, start) if kind == "58b" else None
        end = _END.search(raw, binary.end() + int(re.sub("[^0-9]", "", more[24:36]) or 0) if binary else start)
        while end and not binary and raw[end.start() - 1 : end.start()] != b"\n":
            end = _END.search(raw, end.end())
        if end is None:
            raise FormatError(f"its data set {kind} does not end: is the file cut off?", line)
        found.append(DataSet(kind, line, more, raw[start : end.start()]))
        at, line = end.end(), line + raw.count(b"\n", start - 1, end.end())
    return found


@dataclass(frozen=True)
class FileUnits:
    """Units of a file: how many of its units of length and force are one of SI; ``words``: their names, if it says."""

    length: float = 1.0
    force: float = 1.0
    words: str = ""

    @property
    def is_si(self) -> bool:
        """Test whether values are in SI."""
        return self.length == self.force == 1

    def size(self, unit: str) -> float:
        """Size in SI of the file's unit of what has this SI ``unit``."""
        powers = (unit_size(unit) or (1, {}))[1]
        force = powers.get(MASS, 0.0)
        return self.of_powers(powers.get(LENGTH, 0.0) - force, force)

    def of_powers(self, length: float, force: float) -> float:
        """Size in SI of the file's unit of what has these powers of length and force; time is in s."""
        return float(self.length**-length * self.force**-force)


def units_of(sets: Sequence[DataSet]) -> FileUnits:
    """Units of a file by its data sets 164, SI without any; FormatError where they contradict each other."""
    found = {_units(each) for each in sets if each.kind == "164"}
    if len(found) > 1:
        raise FormatError("has data sets 164 of different units: keep those of one of them in it")
    return found.pop() if found else FileUnits()


def _units(one: DataSet) -> FileUnits:
    head, _, below = one.content.decode("latin1").partition("\n")
    with read_by("its data set 164 says no units", ValueError, one.line + 1):
        code = whole(head[:10].strip())
        length, force, _ = (real(each.upper().replace("D", "E"), each) for each in below.split()[:3])
        if min(length, force) <= 0:
            raise FormatError("a factor is not above 0")
        names = CODES.get(code, ("", ""))
        for name, si, each in zip(names, ("m", "N"), (length, force), strict=True):
            if name and abs(each * factor(name, si) - 1) > ROUNDED:
                told = f"the code {code} is {' and '.join(names)}, and the factor of the {name} {each:g}"
                raise FormatError(f"{told}: correct one of both, or delete data set 164 if the file is in SI")
    words = " and ".join(names) if names[0] else f"units of {1 / length:g} m and {1 / force:g} N"
    return FileUnits(length, force, words)
