"""Time series in files as records: columns of text, WAV, MATLAB and HDF5, universal files (data set 58).

A column of times that are equal steps to 10⁻³ of one is taken as equal steps, which is less than what interpolation
leaves open; one that is off by more, and by less than 0.3 of a step throughout, lost digits when it was written: the
rate must be said in its place.
"""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import SHOWN, Columns, CurveColumn, HeadError, WantedColumn
from vibeam.exchange.curves.read import is_text, read_columns
from vibeam.exchange.curves.record import factor
from vibeam.exchange.faults import CaseError, as_shown_in_message, fault_in
from vibeam.exchange.files import FormatError, file_fault, reason
from vibeam.system.record import Record
from vibeam.system.record_samples import JOINED, LEAST, samples_of, times_of
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
WAVES = (".wav", ".wave")
TIMES = ("time", "t", "seconds")
EVEN, ROUNDED = 1e-3, 0.3  # of a step: times taken as equal steps; times that were written with too few digits
ANONYMOUS = "cannot be read as a record; its lines are not shown, since it lies outside the case's folder"


def record_of_file(
    path: str | PathLike[str],
    *,
    column: str | int | None = None,
    time: str | int | None = None,
    channel: int | None = None,
    quantity: str = "acceleration",
    unit: str | None = None,
    rate: float | None = None,
    scale: float | None = None,
    interpolation: str | None = None,
    remove: str | None = None,
    quote: bool = True,
) -> Record:
    """Record of a file, by its ending: text (CSV and tables of instruments), .wav, .mat, .h5, universal files.

    - ``column``: head of the samples, or number from 1 (text); variable or dataset, ``"name:2"`` for its second column
      (.mat, .h5); number of the data set 58 (universal files). None: a usual head of the ``quantity``.
    - ``time``: the same of the times; None: ``"time"`` or ``"t"``. ``rate`` (Hz): samples per second, in its place.
    - ``channel``: of a WAV file, from 1. Of one of whole numbers ``scale`` must say the value of the full scale.
    - ``quantity``, ``interpolation``, ``remove``: as in ``Record.sampled``. ``unit`` goes before the one that the file
      says (``g`` is 9.80665 m/s²); without any: SI. ``scale``: factor on top of it.

    CaseError names file, line or row, and cure of every fault. ``quote``: whether messages may quote the file.

    >>> import vibeam
    >>> with open("shock.csv", "w") as file:
    ...     _ = file.write("time [ms];acceleration [g]\\n0;0\\n1;20\\n2;50\\n3;20\\n4;0\\n")
    >>> vibeam.record_of_file("shock.csv")
    Record(acceleration, 0 … 0.004 s, 4 pieces, peak 490.332 m/s², samples linear)
    """
    path = Path(path)
    if fault := file_fault(path):
        raise CaseError([fault_in(path, None, fault)])
    try:
        if quantity not in JOINED:
            raise FormatError(f"quantity {quantity!r} is none of {', '.join(JOINED)}")
        if path.suffix.lower() in WAVES:
            found, own = _read_wav(path, channel, scale is not None)
            rate = own if rate is None else rate
        else:
            found = _read(path, column, time, channel, quantity, rate)
        value = _in_si(found.columns["value"], UNITS[quantity], unit, "unit") * (1.0 if scale is None else scale)
        clock = found.columns.get("frequency")
        if clock is not None and clock.unit == "Hz":
            raise FormatError(f"column {clock.head!r} is in Hz: a record goes over time, this is a spectrum")
        times = _in_si(found.columns["frequency"], "s", None, "time") if rate is None else None
    except FormatError as wrong:
        raise CaseError([fault_in(path, wrong.line, _told(wrong, quantity, quote))]) from None
    word = "line" if is_text(path) and path.suffix.lower() not in WAVES else "row"
    faults: list[str] = []
    samples_of(
        value, LEAST.get(interpolation or JOINED[quantity][0], 2), faults, lambda row: f"{word} {found.lines[row]}"
    )
    if times is not None:
        times_of(len(value), None, times, None, faults, lambda row: f"{word} {found.lines[row]}")
    if faults:
        raise CaseError([fault_in(path, None, each) for each in faults])
    try:
        start, even = (0.0, rate) if times is None else (float(times[0]), _even(times))
        when: dict[str, Any] = {"times": times} if even is None else {"rate": even, "start": start}
        return Record.sampled(value, **when, quantity=quantity, interpolation=interpolation, remove=remove)
    except ValueError as wrong:
        raise CaseError([fault_in(path, None, str(wrong).removeprefix("record: "))]) from None


def _read(
    path: Path, column: str | int | None, time: str | int | None, channel: int | None, quantity: str, rate: float | None
) -> Columns:
    """Columns ``value`` and, without a ``rate``, ``frequency``, as the readers of curves call the abscissa."""
    if channel is not None:
        raise FormatError("channel goes with a WAV file: say the column of this one")
    wanted = {
        "frequency": WantedColumn(TIMES if time is None else (time,), needed=rate is None),
        "value": WantedColumn(HEADS[quantity] if column is None else (column,)),
    }
    return read_columns(path, wanted)


def _read_wav(path: Path, channel: int | None, scaled: bool) -> tuple[Columns, float]:
    """One channel of a WAV file, as shares of the full scale where it is of whole numbers, and its rate, Hz."""
    from scipy.io import wavfile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            own, data = wavfile.read(path)
    except Exception as error:  # whatever scipy makes of another file
        raise FormatError(f"is no WAV file that can be read: {reason(error)}") from None
    table = data.reshape(len(data), -1)
    channels = table.shape[1]
    if channel is None and channels > 1:
        raise FormatError(f"has {channels} channels: say which, channel = 1 … {channels}")
    if channel is not None and not 1 <= channel <= channels:
        raise FormatError(
            f"has no channel {channel}: there {'is 1' if channels == 1 else f'are {channels}'}, from 1 on"
        )
    values = table[:, (channel or 1) - 1]
    if data.dtype.kind in "iu":
        if not scaled:
            raise FormatError("holds shares of its full scale: say scale, the value of the full scale")
        values = (values - (128.0 if data.dtype.kind == "u" else 0.0)) / 2.0 ** (8 * data.dtype.itemsize - 1)
    columns = {"value": CurveColumn(f"channel {channel or 1}", "", np.asarray(values, dtype=float))}
    return Columns(columns, range(1, len(values) + 1)), float(own)


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


def _in_si(column: CurveColumn, wanted: str, unit: str | None, key: str) -> Array:
    """Values of a column in SI; a unit that is said goes before the file's."""
    try:
        return column.values * factor(column.unit if unit is None else unit, wanted)
    except ValueError as fault:
        raise FormatError(f'column {column.head!r}: {fault}; say it: {key} = "…"') from None


def _told(wrong: FormatError, quantity: str, quote: bool) -> str:
    """Message of a reader, with the keys of a record as the cure."""
    if not quote:
        return ANONYMOUS
    if isinstance(wrong, HeadError):
        there = ", ".join(map(as_shown_in_message, wrong.heads[:SHOWN]))
        heads = f": there are {there}" if there else ""
        return (
            f'has no columns "time" and "{quantity}"{heads}; say column and time by head or number from 1, or the rate'
        )
    return wrong.message.partition(", columns = {")[0]
