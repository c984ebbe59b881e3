"""Time series in files as records: columns of text, WAV, MATLAB, HDF5 and TDMS, universal files (data set 58).

A column of times that are equal steps to 10⁻³ of one is taken as equal steps, which is less than what interpolation
leaves open; one that is off by more, and by less than 0.3 of a step throughout, lost digits when it was written: the
rate must be said in its place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import (
    TIMES,
    Columns,
    HeadError,
    WantedColumn,
    in_si,
    is_text,
    read_columns,
    split_head,
    taken_column,
)
from vibeam.exchange.curves.record import Taken, tell
from vibeam.exchange.curves.waves import SHARES
from vibeam.exchange.faults import CaseError, fault_in
from vibeam.exchange.files import FormatError, State, file_fault, state_of
from vibeam.exchange.units import taking
from vibeam.system.record import Record
from vibeam.system.record_samples import JOINED, LEAST, samples_of, times_of
from vibeam_models.arguments import number, shown, word
from vibeam_models.arrays import Array

UNITS = {"acceleration": "m/s^2", "velocity": "m/s", "displacement": "m", "force": "N", "moment": "N m"}
#: usual heads of columns, by quantity
HEADS = {
    "acceleration": ("acceleration", "accel", "acc", "a"),
    "velocity": ("velocity", "vel", "v"),
    "displacement": ("displacement", "disp", "d", "x"),
    "force": ("force", "f"),
    "moment": ("moment", "torque", "m"),
}
FIRST = "first sample"
EVEN, ROUNDED = 1e-3, 0.3  # of a step: times taken as equal steps; times that were written with too few digits
LONGER = 0.01  # share by which a record may last longer or shorter by a rate that is said than by its own times
SHORTEST = 1e-12  # s, a step; the longest is one over it
SAY_UNIT, SAY_RATE = 'say it: unit = "…"', 'say it: rate = "…"'
ANONYMOUS = "cannot be read as a record; its lines are not shown, since it lies outside the case's folder"


def record_of_file(
    path: str | PathLike[str],
    *,
    column: str | int | None = None,
    time: str | int | None = None,
    quantity: str = "acceleration",
    unit: str | None = None,
    rate: float | None = None,
    scale: float | None = None,
    interpolation: str | None = None,
    remove: str | None = None,
    start: str | float | None = None,
    since: float | None = None,
    until: float | None = None,
    quote: bool = True,
) -> Record:
    """Record of a file, by its ending: text (CSV and tables of instruments), .wav, .mat, .h5, .tdms, universal files.

    - ``column``: head of the samples, or number from 1 (text); variable, dataset or channel, ``"name:2"`` for its
      second column (.mat, .h5, .tdms); number of the data set 58 (universal files) or of the channel (.wav). None: a
      usual head of the ``quantity``, or the only one.
    - ``time``: the same of the times; None: a usual head as ``"t"``. ``rate`` (Hz): samples per second, where
      there are no times, or they lost digits, as universal files have six; times that differ by more are a fault.
    - ``quantity``, ``interpolation``, ``remove``: as in ``Record.sampled``. ``unit`` goes before the one that the file
      says (``g`` is 9.80665 m/s²); without any: SI. ``scale``: factor on top of it; of a WAV file of whole numbers the
      value of its full scale, which must be said.
    - ``since``, ``until``: stretch of the file that is taken, s by its own clock, which begins at 0 where it has none.
      ``start``: time of the file that becomes 0, or ``"first sample"``; None: its clock stays.

    ``taken`` of the record says what was read. CaseError names file, line or row, and cure of every fault. ``quote``:
    whether messages may quote the file.

    >>> import vibeam
    >>> with open("shock.csv", "w") as file:
    ...     _ = file.write("time [ms];acceleration [g]\\n0;0\\n1;20\\n2;50\\n3;20\\n4;0\\n")
    >>> vibeam.record_of_file("shock.csv")
    Record(acceleration, 0 … 0.004 s, 4 pieces, peak 490.332 m/s², samples linear)
    """
    path = Path(path)
    try:
        numbers = {"scale": scale, "start": None if start == FIRST else start, "since": since, "until": until}
        _require_keys(quantity, {"column": column, "time": time}, unit, numbers)
        found, unit, value, clock = samples_of_file(path, column, time, quantity, unit, rate, scale)
        kept = _stretch(clock, since, until)
    except FormatError as wrong:
        raise CaseError([fault_in(path, wrong.line, _told(wrong, quote))]) from None
    value, clock, lines = value[kept], clock[kept], found.lines[kept]
    least = 2 if interpolation == "linear" else LEAST[JOINED[quantity][0]]
    _require_sound(path, lines, value, clock if rate is None else None, least)
    try:
        even = _even(clock) if rate is None else rate
        zero = float(clock[0]) if start == FIRST else 0.0 if start is None else float(start)
        when: dict[str, Any] = {"times": clock - zero} if even is None else {"rate": even, "start": clock[0] - zero}
        with np.errstate(over="ignore", invalid="ignore"):  # loads beyond any quantity are refused by their peak
            made = Record.sampled(value, **when, quantity=quantity, interpolation=interpolation, remove=remove)
    except ValueError as wrong:
        raise CaseError([fault_in(path, None, str(wrong).removeprefix("record: "))]) from None
    taken = _taken(path, found, UNITS[quantity], unit, clock, even, None if start is None else zero)
    object.__setattr__(made, "taken", taken)
    return made


def record_in_run(path: Path, duration: float | None, quote: bool, said: Mapping[str, Any]) -> Record:
    """Record of a file by the keys of a case, in a run of ``duration`` s, None: as long as it is; CaseError as above.

    Read once while the file is unchanged. A clock that begins before 0 or after the run begins at its first sample.
    """
    form = tuple(({"from": "since", "to": "until"}.get(name, name), value) for name, value in said.items())
    if fault := file_fault(path):
        raise CaseError([fault_in(path, None, fault)])
    asked = path, state_of(path), quote, form
    made = _record_of(*asked)
    if "start" not in said and not 0 <= made.start < (duration or made.duration):
        made = _record_of(*asked, start=FIRST)
    tell(made.taken)
    return made


@lru_cache(maxsize=4)
def _record_of(path: Path, state: State, quote: bool, form: tuple[tuple[str, Any], ...], **more: Any) -> Record:
    return record_of_file(path, quote=quote, **dict(form), **more)


def samples_of_file(
    path: Path, column: str | int | None, time: str | int | None, quantity: str, unit: str | None, rate: float | None,
    scale: float | None,
) -> tuple[Columns, str | None, Array, Array]:  # fmt: skip
    """Columns of a file, the unit that is said of its samples, these in SI, and their times in s."""
    found = _columns(path, column, time, quantity, rate)
    if found.columns["value"].unit == SHARES:
        unit = unit or ""
        if scale is None:
            raise FormatError(f"holds {SHARES}: say scale, the value of the full scale")
    value = in_si(found.columns["value"], UNITS[quantity], unit, SAY_UNIT) * (1.0 if scale is None else scale)
    return found, unit, value, _clock(found, rate)


def _stretch(clock: Array, since: float | None, until: float | None) -> slice:
    """Samples from one time on up to another; FormatError where there are none."""
    if since is until is None:
        return slice(None)
    low, high = -np.inf if since is None else since, np.inf if until is None else until
    near = 1e-6 * abs(clock[-1] - clock[0]) / len(clock)
    places = np.flatnonzero((clock >= low - near) & (clock <= high + near))
    if not len(places):
        there = f"its clock goes from {clock[0]:.6g} to {clock[-1]:.6g} s"
        raise FormatError(f"has no sample from {low:.6g} s to {high:.6g} s: {there}")
    return slice(int(places[0]), int(places[-1]) + 1)


def _taken(
    path: Path, found: Columns, si: str, unit: str | None, clock: Array, even: float | None, zero: float | None
) -> Taken:  # fmt: skip
    columns = [taken_column(found.columns["value"], si, unit)]
    if "frequency" in found.columns:
        columns.append(taken_column(found.columns["frequency"], "s"))
    notes, left, steps = list(found.notes), len(found.lines) - len(clock), np.diff(clock)
    if left:
        notes.append(f"{left} of {len(found.lines)} samples left out by from and to")
    if even is None:
        notes.append(f"uneven steps of {steps.min():.4g} to {steps.max():.4g} s")
    if how := taking(found.columns["value"].unit)[1]:
        notes.append(f"its head says {how} values, and samples are taken as they are")
    span = float(clock[0]), float(clock[-1])
    return Taken(path.name, "time history", tuple(columns), len(clock), *span, "s", even, tuple(notes), zero)


def _require_keys(quantity: Any, places: Mapping[str, Any], unit: Any, numbers: Mapping[str, Any]) -> None:
    """FormatError for what no file can have."""
    faults: list[str] = []
    word("quantity", quantity, JOINED, faults)
    for name, each in places.items():
        if not (each is None or isinstance(each, str) or (isinstance(each, int) and each > 0)):
            faults.append(f"{name}: {shown(each)} must be a head, or a number from 1")
    if not (unit is None or isinstance(unit, str)):
        faults.append(f"unit: {shown(unit)} must be text")
    for name, each in numbers.items():
        number(name, 0 if each is None else each, faults)
    if faults:
        raise FormatError("; ".join(faults))


def _columns(
    path: Path, column: str | int | None, time: str | int | None, quantity: str, rate: float | None
) -> Columns:
    """Columns ``value`` and ``frequency``, as readers of curves call the abscissa, which may be absent with a rate.

    Where no ``column`` is said, the value may be the only one that is not the times.
    """
    wanted = {
        "frequency": WantedColumn(TIMES if time is None else (time,), needed=rate is None),
        "value": WantedColumn(HEADS[quantity] if column is None else (column,)),
    }
    try:
        found = read_columns(path, wanted)
    except HeadError as fault:
        times = wanted["frequency"].names
        left = [each for each in fault.heads if {each, split_head(each)[0].casefold()}.isdisjoint(times)]
        if column is not None or len(left) != 1:
            raise
        found = read_columns(path, {**wanted, "value": WantedColumn((left[0],))})
    if found.kind not in ("", "time history", "impulse response"):
        raise FormatError(f"has a {found.kind}: a record is a time history")
    if found.columns["value"].complex_values is not None:
        raise FormatError(f"column {found.columns['value'].head!r} is complex: a record is real, this is a spectrum")
    return found


def _clock(found: Columns, rate: Any) -> Array:
    """Times in s, by ``rate`` from the first on; FormatError where they are none, the samples, or by another rate."""
    value, clock = found.columns["value"], found.columns.get("frequency")
    if clock is None:
        return np.asarray(np.arange(len(value.values)) / rate)
    if clock.unit == "Hz":
        raise FormatError(f"column {clock.head!r} is in Hz: a record goes over time, this is a spectrum")
    if clock.head == value.head and np.array_equal(clock.values, value.values, equal_nan=True):
        raise FormatError(f"column {clock.head!r} is that of the times: name that of the samples, column = …")
    times = in_si(clock, "s", None, SAY_RATE)
    if rate is None:
        return times
    steps, span = len(times) - 1, float(times[-1] - times[0])
    if span > 0 and abs(rate * span - steps) > max(1.0, LONGER * len(times)):
        told = f"rate is {rate:.6g} Hz, and column {clock.head!r} has {steps / span:.6g} samples a second"
        raise FormatError(f"{told}: take rate out, or correct the times or their unit")
    return np.asarray(times[0] + np.arange(len(times)) / rate)


def _require_sound(path: Path, lines: Sequence[int], value: Array, times: Array | None, least: int) -> None:
    """CaseError with all faults of samples and times, by line or row."""
    faults: list[str] = []
    spelt = ("line {}" if is_text(path) else "row {}").format
    samples_of(value, least, faults, lambda row: spelt(lines[row]))
    if times is not None:
        times_of(len(value), None, times, None, faults, lambda row: spelt(lines[row]))
        if not faults and not SHORTEST < (mean := float(times[-1] - times[0]) / len(times)) < 1 / SHORTEST:
            faults.append(f"times: steps of {mean:.3g} s are those of no record: correct its rate, or their unit")
    if faults:
        raise CaseError([fault_in(path, None, each) for each in faults])


def _even(times: Array) -> float | None:
    """Rate of times that are equal steps, None where they are not; ValueError where they lost their last digits."""
    steps = len(times) - 1
    rate = steps / float(times[-1] - times[0])
    off = float(np.abs((times - times[0]) * rate - np.arange(steps + 1)).max())
    if off <= EVEN:
        return rate
    if off < ROUNDED and steps >= 10:
        told = f"times are equal steps but for {100 * off:.2g} % of one, by digits that were lost"
        raise ValueError(f"{told}: say rate = {rate:.6g} Hz, or what it was before")
    return None


def _told(wrong: FormatError, quote: bool) -> str:
    """Message of a reader, with the keys of a record as the cure."""
    if not quote:
        return ANONYMOUS
    said = wrong.message.partition("; say which in the case")[0].partition(", columns = {")[0]
    cure = "; say column and time by head or number from 1, or the rate" if isinstance(wrong, HeadError) else ""
    return said + cure
