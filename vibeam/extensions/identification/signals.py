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
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import (
    BINARY,
    TIMES,
    Columns,
    CurveColumn,
    HeadError,
    WantedColumn,
    is_text,
    read_columns,
    size_in,
    split_head,
    taken_column,
)
from vibeam.exchange.curves.record import Taken
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
PHASE = re.compile(r"phasen?(winkel)?|angle|argument|arg\b.*")
OTHERS = re.compile(
    rf"{PHASE.pattern}|coherence|kohärenz|sigma|{'|'.join(UNCERTAINTIES)}|direction|period|index|no?\.?|nr\.?|#"
)
PARTS = (
    re.compile(r"(.*[\s_(])?(re|real(teil| part)?)([\W_\d].*)?"),
    re.compile(r"(.*[\s_(])?(im|imag(teil|inär(teil)?|inary)?( part)?)([\W_\d].*)?"),
)
REFERENCE = re.compile(r"db\W*(?:re|ref)?\W*([\d.]+(?:e[+-]?\d+)?)?\s*(.*?)\W*", re.IGNORECASE)


@dataclass(frozen=True)
class Signal:
    """Signal of a file: ``at`` (n,) in s or Hz, ``value`` (n,), standard ``uncertainty`` (n,) or None.

    Of several responses ``value`` is (m, n), and complex where the phase is there. ``over``: ``"time"``,
    ``"frequency"``, empty where neither head nor unit says it. ``heads``, ``units`` of abscissa and value as the file
    has them, of the value without decibels; ``parts``: heads of all columns that the values are of, if more than one.
    ``taken``: which columns of its file.
    """

    at: Array
    value: Any
    uncertainty: Array | None
    over: str
    heads: tuple[str, str]
    units: tuple[str, str]
    parts: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    decibels: bool = False
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

    ``over``: ``"time"``, ``"frequency"``, empty: found out. ``x``, ``y``: heads of the columns, or numbers from 1;
    several values with commas between them.
    """
    try:
        found = _columns(path, over, x, y)
        signals = [_signal(path, each.columns, over) for each in found]
        signal = replace(signals[0], taken=_taken(path, found, signals[0]))
        if len(signals) == 1:
            return signal
        units = sorted({each.units[1] for each in signals})
        if len(units) > 1:
            raise FormatError(f"its columns are in {' and '.join(units)}: name those of one unit, --y HEAD,HEAD")
        parts = tuple(name for each in signals for name in each.parts or each.heads[1:])
        return replace(signal, value=np.array([each.value for each in signals]), parts=parts)
    except FormatError as wrong:  # of a reader, whose cure is that of a case
        said = wrong.message.partition("; say which in the case")[0].partition(", columns = {")[0]
        cure = "; name them: --x HEAD --y HEAD" if "say which" in wrong.message else ""
        raise CaseError([fault_in(path, wrong.line, said + cure)]) from None


def _taken(path: Path, found: Sequence[Columns], signal: Signal) -> Taken:
    over, ends = UNITS.get(signal.over, ""), (float(signal.at.min()), float(signal.at.max()))
    units = {"value": "", "imaginary": "", "phase": "rad", "frequency": over, "uncertainty": signal.units[1]}
    columns = [
        taken_column(each.columns[role], units[role]) for role in units for each in found if role in each.columns
    ]
    return Taken(
        path.name, found[0].kind or "time history", tuple(dict.fromkeys(columns)), len(signal.at), *ends, over,
        notes=found[0].notes,
    )  # fmt: skip


def _columns(path: Path, over: str, x: str | None, y: str | None) -> list[Columns]:
    """Columns by role of each response: the abscissa as ``frequency``; ``value``, and ``phase`` or ``imaginary``."""
    several = [each.strip() for each in y.split(",")] if y else []
    if x and len(several) == 1:
        return [read_columns(path, _wanted(_head(x), _head(several[0])))]
    overs = (over,) if over else tuple(UNITS)
    wanted = _head(several[0] if several else "")
    heads = _heads(path, {"frequency": WantedColumn(overs), "value": WantedColumn((wanted,))})
    if isinstance(heads, Columns):
        role = {"frequency": WantedColumn(overs)}
        rest = (read_columns(path, role | {"value": WantedColumn((_head(n),))}) for n in several[1:])
        return [heads, *rest]
    if y in heads:
        several = [str(y)]
    at = _head(x) if x else _abscissa(heads, overs)
    if at is None:
        return [_by_numbers(path, heads, overs, y)]
    return [
        read_columns(path, _wanted(at, _head(value), _head("".join(second)), role))
        for value, *second, role in _responses(
            several or [each for each in heads if each != at], heads, at, bool(several)
        )
    ]


def _responses(among: Sequence[str], heads: Sequence[str], at: str | int, named: bool) -> list[list[str]]:
    """Heads of each response, and the role of the second: real and imaginary part, modulus and phase, or alone."""
    real, imaginary = ({_label(head, form): head for head in among if form.fullmatch(_plain(head))} for form in PARTS)
    pairs = [[real[each], imaginary[each], "imaginary"] for each in real if each in imaginary]
    if pairs:
        return pairs
    phases = [head for head in among if PHASE.fullmatch(_plain(head))]
    if named:
        return [[each, "imaginary"] for each in among if each not in phases or len(phases) == len(among)]
    value = _value(heads, at)
    return [[value, *(phases if len(phases) == 1 else []), "phase"]]


def _label(head: str, form: re.Pattern[str]) -> str:
    """Head without the word for the part."""
    found = form.fullmatch(_plain(head))
    return "" if found is None else f"{found[1] or ''}{found.groups()[-1] or ''}".strip(" _()")


def _wanted(at: str | int, value: str | int, second: str | int = "", role: str = "") -> dict[str, WantedColumn]:
    return {
        "frequency": WantedColumn((at,)),
        "value": WantedColumn((value,)),
        "uncertainty": WantedColumn(UNCERTAINTIES, needed=False),
    } | ({role: WantedColumn((second,))} if second else {})


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
    """Head of time or frequency, by its name and then by its unit; FormatError where several may be meant."""
    units = {head: split_head(head)[1] for head in heads}
    of = {head: [each for each in UNITS if _suits(unit, each)] for head, unit in units.items()}
    named = [head for head in heads if (of[head] or not units[head]) and any(name_in(head, each) for each in over)]
    found = named or [head for head in heads if {*of[head]} & {*over}]
    if len(found) > 1:
        raise FormatError(f"has {' and '.join(map(repr, found))}: say over which it is, --x HEAD")
    return found[0] if found else None


def name_in(head: str, over: str) -> bool:
    """Test whether a head is a name of time, or of frequency."""
    return _plain(head) in NAMES[over]


def _suits(unit: str, over: str) -> bool:
    return bool(unit and size_in(unit, UNITS[over]))


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


def _signal(path: Path, found: Mapping[str, CurveColumn], over: str) -> Signal:
    """Signal of columns by role, its abscissa scaled to s or Hz."""
    at, value = found["frequency"], found["value"]
    paths = path.suffix.lower() in BINARY
    heads = (_last(at.head), _last(value.head)) if paths else (at.head, value.head)
    of_unit = [each for each in UNITS if _suits(at.unit, each)]
    if at.unit and not of_unit:
        told = f"the unit {at.unit!r} is neither one of time nor one of frequency"
        raise FormatError(f"column {heads[0]!r}: {told}: name another, --x HEAD")
    over = over or next(iter(of_unit or [each for each in NAMES if name_in(heads[0], each)]), "")
    scaled = at.values * (_factor(at, UNITS[over]) if over and at.unit else 1.0)
    notes = [] if at.unit else [f"{heads[0]!r} has no unit: it is taken in {UNITS.get(over, 's or Hz')}"]
    size, unit = _sizes(value, notes)
    parts = tuple(found[role].head for role in ("value", "imaginary", "phase") if role in found)
    if value.complex_values is not None and not _decibels(value):
        size = value.complex_values
    if "imaginary" in found:
        size = size + 1j * _sizes(found["imaginary"], [])[0]
    elif "phase" in found:
        size = size * np.exp(1j * _phase(found["phase"], notes))
    there = np.isfinite(scaled) & np.isfinite(size)
    uncertainty = _uncertainty(found["uncertainty"], value, np.abs(size))[there] if "uncertainty" in found else None
    return Signal(
        scaled[there], size[there], uncertainty, over, heads, (at.unit, unit), parts if len(parts) > 1 else (),
        tuple(notes), decibels=_decibels(value),
    )  # fmt: skip


def _sizes(column: CurveColumn, notes: list[str]) -> tuple[Array, str]:
    """Values of a column, of decibels the amplitudes in their reference, and their unit."""
    if not _decibels(column):
        return column.values, column.unit
    reference = REFERENCE.fullmatch(column.unit)
    number, unit = (reference[1], reference[2]) if reference else (None, "")
    over = f", over {number or 1} {unit}" if number or unit else ""
    notes.append(f"{column.head!r} is in decibels{over}: 20 dB are taken as a factor of 10 in amplitude")
    return np.asarray(float(number or 1.0) * 10 ** (column.values / 20)), unit


def _phase(column: CurveColumn, notes: list[str]) -> Array:
    """Phase in rad; without a unit in degrees where it goes beyond a turn."""
    unit = column.unit or ("deg" if np.nanmax(np.abs(column.values)) > 7 else "rad")
    if not column.unit:
        notes.append(f"{column.head!r} has no unit: it is taken in {unit}")
    return np.asarray(column.values * _factor(replace(column, unit=unit), "rad"))


def _factor(column: CurveColumn, wanted: str) -> float:
    """Factor from the unit of a column to another one."""
    size = size_in(column.unit, wanted)
    if size is None:
        raise FormatError(f"column {column.head!r}: the unit {column.unit!r} is not one of {wanted}")
    return size


def _decibels(column: CurveColumn) -> bool:
    return column.unit.casefold().startswith("db")


def _uncertainty(column: CurveColumn, value: CurveColumn, size: Array) -> Array:
    """Standard uncertainties of amplitudes ``size``: in the unit of the value or another one, decibels or percent."""
    if column.unit == "%":
        return np.asarray(np.abs(size) * column.values / 100)
    if _decibels(value):
        return np.asarray(size * column.values * log(10) / 20)
    return column.values * (1.0 if column.unit in ("", value.unit) else _factor(column, value.unit))
