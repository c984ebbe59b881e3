"""Measured signals: abscissa, values and uncertainties from the columns of a file.

The columns are told by their heads, as instruments and spreadsheets write them, and by their units; of two columns that
no head tells apart the abscissa is the one that ascends.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.columns import (
    TIMES,
    Columns,
    CurveColumn,
    HeadError,
    WantedColumn,
    split_head,
    taken_column,
)
from vibeam.exchange.curves.read import BINARY, is_text, read_columns
from vibeam.exchange.curves.record import factor
from vibeam.exchange.curves.taken import Taken
from vibeam.exchange.faults import CaseError, fault_in
from vibeam.exchange.files import FormatError
from vibeam_models.arrays import Array

UNITS = {"time": "s", "frequency": "Hz"}
NAMES = {
    "time": TIMES,
    "frequency": ("frequency", "freq", "f", "frequenz", "fréquence", "frecuencia", "frequencies", "hz"),
}
VALUES = ("displacement", "amplitude", "magnitude", "value", "x", "a")
UNCERTAINTIES = ("uncertainty", "unsicherheit", "u")
OTHERS = re.compile(
    r"phase|phasen?winkel|coherence|kohärenz|sigma|uncertainty|unsicherheit|u|direction|period|index|no?\.?|nr\.?|#"
)
PARTS = (re.compile(r"re(al(teil|part| part)?)?\b.*"), re.compile(r"im(ag(inary|inär)?(teil|part| part)?)?\b.*"))


@dataclass(frozen=True)
class Signal:
    """Signal of a file: ``at`` (n,) in s or Hz, ``value`` (n,), standard ``uncertainty`` (n,) or None.

    ``over``: ``"time"``, ``"frequency"``, empty where neither head nor unit says it. ``heads``, ``units`` of abscissa
    and value as the file has them; ``parts``: heads of real and imaginary part, whose modulus is the value. ``taken``:
    which columns of its file.
    """

    at: Array
    value: Array
    uncertainty: Array | None
    over: str
    heads: tuple[str, str]
    units: tuple[str, str]
    parts: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    taken: Taken | None = None

    def within(self, stretch: tuple[float | None, float | None]) -> Signal:
        """The part from one abscissa to another (None: to the end); ValueError where nothing is left."""
        low, high = (end if each is None else each for each, end in zip(stretch, (-np.inf, np.inf), strict=True))
        inside = (self.at >= low) & (self.at <= high)
        if not inside.any():
            raise ValueError(f"nothing lies from {low:g} to {high:g}: it has {self.at.min():g} to {self.at.max():g}")
        uncertainty = None if self.uncertainty is None else self.uncertainty[inside]
        taken, left = self.taken, int(np.sum(~inside))
        if taken is not None and left:
            taken = replace(taken, notes=(*taken.notes, f"{left} of {len(self.at)} points left out by --from and --to"))
        return replace(self, at=self.at[inside], value=self.value[..., inside], uncertainty=uncertainty, taken=taken)


def read_signal(path: Path, over: str = "", x: str | None = None, y: str | None = None) -> Signal:
    """Signal of a CSV, .mat, HDF5 or universal file; CaseError with the place and the cure.

    ``over``: ``"time"``, ``"frequency"``, empty: found out. ``x``, ``y``: heads of the columns, or numbers from 1.
    """
    try:
        found, parts = _columns(path, over, x, y)
        signal = _signal(path, found.columns, over, parts)
        return replace(signal, taken=_taken(path, found, signal))
    except FormatError as wrong:
        raise CaseError([fault_in(path, wrong.line, _cured(wrong.message))]) from None


def _taken(path: Path, found: Columns, signal: Signal) -> Taken:
    over = UNITS.get(signal.over, "")
    units = {"value": "", "frequency": over, "uncertainty": signal.units[1]}
    columns = tuple(taken_column(found.columns[role], units[role]) for role in units if role in found.columns)
    ends = float(signal.at.min()), float(signal.at.max())
    return Taken(path.name, "time history", columns, len(signal.at), *ends, over, notes=found.notes)


def _cured(message: str) -> str:
    """Message of a reader with the cure of a command in place of that of a case."""
    said = message.partition("; say which in the case")[0].partition(", columns = {")[0]
    return said + ("; name them: --x HEAD --y HEAD" if "say which" in message else "")


def _columns(path: Path, over: str, x: str | None, y: str | None) -> tuple[Columns, tuple[str, ...]]:
    """Columns by role, the abscissa as ``frequency``; of a value in two parts its modulus, and their heads."""
    if x and y:
        return read_columns(path, _wanted(_head(x), _head(y))), ()
    overs = (over,) if over else tuple(UNITS)
    heads = _heads(path, {"frequency": WantedColumn(overs), "value": WantedColumn((_head(y or ""),))})
    if isinstance(heads, Columns):
        return heads, ()
    at = _head(x) if x else _abscissa(heads, overs)
    if at is None:
        return _by_numbers(path, heads, overs, y), ()
    if not y and (parts := _parts(heads)):
        real, imaginary = (read_columns(path, _wanted(at, each)) for each in parts)
        size = np.hypot(real.columns["value"].values, imaginary.columns["value"].values)
        return Columns({**real.columns, "value": replace(real.columns["value"], values=size)}, real.lines), parts
    return read_columns(path, _wanted(at, _head(y) if y else _value(heads, at))), ()


def _wanted(at: str | int, value: str | int) -> dict[str, WantedColumn]:
    return {
        "frequency": WantedColumn((at,)),
        "value": WantedColumn((value,)),
        "uncertainty": WantedColumn(UNCERTAINTIES, needed=False),
    }


def _head(text: str) -> str | int:
    return int(text) if text.isdigit() else text


def _heads(path: Path, wanted: Mapping[str, WantedColumn]) -> list[str] | Columns:
    """Heads of a file, or its columns where it has no heads to choose among."""
    try:
        if not is_text(path):
            return read_columns(path, {**wanted, "none": WantedColumn(("\0",))})
        read_columns(path, {"frequency": WantedColumn(("\0",))})
    except HeadError as others:
        if not is_text(path):
            last = [_last(each) for each in others.heads]
            return last if len({*last}) == len(last) else list(others.heads)
        found = [each.lstrip("#% ") for each in others.heads]
        return re.split(r"\s+(?![\[(])", found[0]) if len(found) == 1 else found
    raise AssertionError("a column of that name")


def _last(name: str) -> str:
    """Last part of the path of a variable."""
    return name.replace(".", "/").rpartition("/")[2]


def _abscissa(heads: Sequence[str], over: Sequence[str]) -> str | None:
    """Head of time or frequency; FormatError where several may be meant."""
    found = [head for head in heads if any(name_in(head, each) for each in over)]
    found = found or [head for head in heads if any(suits(split_head(head)[1], each) for each in over)]
    if len(found) > 1:
        raise FormatError(f"has {' and '.join(map(repr, found))}: say over which it is, --x HEAD")
    return found[0] if found else None


def name_in(head: str, over: str) -> bool:
    """Test whether a head is a name of time, or of frequency."""
    return _plain(head) in NAMES[over]


def suits(unit: str, over: str) -> bool:
    """Test whether a unit is one of time, or of frequency."""
    try:
        return bool(unit) and factor(unit, UNITS[over]) > 0
    except ValueError:
        return False


def _plain(head: str) -> str:
    return split_head(head)[0].casefold()


def _value(heads: Sequence[str], at: str | int) -> str:
    """Head of the values: the usual name, or the only one that is left."""
    apart = [head for place, head in enumerate(heads, 1) if at not in (head, place)]
    left = [head for head in apart if not OTHERS.fullmatch(_plain(head))]
    usual = [head for name in VALUES for head in left if _plain(head) == name]
    if len(left) == 1 or usual:
        return left[0] if len(left) == 1 else usual[0]
    there = ", ".join(map(repr, heads)) or "none"
    raise FormatError(f"no column is known as that of the values: there are {there}; name it: --y HEAD")


def _parts(heads: Sequence[str]) -> tuple[str, str] | None:
    """Heads of real and imaginary part, where there is one of each."""
    real, imaginary = ([head for head in heads if form.fullmatch(_plain(head))] for form in PARTS)
    return (real[0], imaginary[0]) if len(real) == len(imaginary) == 1 else None


def _by_numbers(path: Path, heads: Sequence[str], over: Sequence[str], y: str | None) -> Columns:
    """Two columns that no head tells apart: the abscissa is the one that ascends."""
    try:
        found = read_columns(path, _wanted(1, 2) | {"further": WantedColumn((3,), needed=False)})
    except FormatError:
        found = None
    if found is None or y or "further" in found.columns:
        there = ", ".join(map(repr, heads)) or "none"
        sought = " or ".join(over)
        raise FormatError(f"no column is known as {sought}: there are {there}; name them: --x HEAD --y HEAD")
    one, other = (ascends(found.columns[role].values) for role in ("frequency", "value"))
    if one == other:
        both = "both columns ascend" if one else "none of its columns ascends"
        raise FormatError(f"{both}: say which is that of time or frequency, --x 1 --y 2")
    if one:
        return found
    swapped = {"frequency": found.columns["value"], "value": found.columns["frequency"]}
    return Columns(swapped, found.lines)


def ascends(values: Array) -> bool:
    """Test whether each value that is finite is larger than the one before."""
    return bool((np.diff(values[np.isfinite(values)]) > 0).all())


def _signal(path: Path, found: Mapping[str, CurveColumn], over: str, parts: tuple[str, ...]) -> Signal:
    """Signal of columns by role, its abscissa scaled to s or Hz."""
    at, value = found["frequency"], found["value"]
    paths = path.suffix.lower() in BINARY
    heads = (_last(at.head), _last(value.head)) if paths else (at.head, value.head)
    known = [each for each in UNITS if suits(at.unit, each)] or [each for each in NAMES if name_in(heads[0], each)]
    if at.unit and not any(suits(at.unit, each) for each in UNITS):
        told = f"the unit {at.unit!r} is neither one of time nor one of frequency"
        raise FormatError(f"column {heads[0]!r}: {told}: name another, --x HEAD")
    over = over or next(iter(known), "")
    try:
        scaled = at.values * (factor(at.unit, UNITS[over]) if over else 1.0)
    except ValueError as wrong:
        raise FormatError(f"column {heads[0]!r}: {wrong}") from None
    size, notes = value.values, []
    if not at.unit:
        notes.append(f"{heads[0]!r} has no unit: it is taken in {UNITS.get(over, 's or Hz')}")
    if _decibels(value):
        size = 10 ** (size / 20)
        notes.append(f"{heads[1]!r} is in decibels: 20 dB are taken as a factor of 10 in amplitude")
    there = np.isfinite(scaled) & np.isfinite(size)
    uncertainty = _uncertainty(found["uncertainty"], value, size)[there] if "uncertainty" in found else None
    return Signal(scaled[there], size[there], uncertainty, over, heads, (at.unit, value.unit), parts, tuple(notes))


def _decibels(column: CurveColumn) -> bool:
    return column.unit.casefold().startswith("db")


def _uncertainty(column: CurveColumn, value: CurveColumn, size: Array) -> Array:
    """Standard uncertainties of amplitudes ``size``: in the unit of the value or another one, decibels or percent."""
    if column.unit == "%":
        return np.asarray(np.abs(size) * column.values / 100)
    if _decibels(value):
        return np.asarray(size * column.values * log(10) / 20)
    try:
        known = column.unit in ("", value.unit)
        return column.values if known else column.values * factor(column.unit, value.unit)
    except ValueError as wrong:
        raise FormatError(f"column {column.head!r}: {wrong}") from None
