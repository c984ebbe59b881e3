"""Curves in WAV files: one channel over time, read by scipy once the sizes in its head are known to be right."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from struct import pack_into, unpack_from

import numpy as np

from vibeam.exchange.curves.columns import Columns, CurveColumn, WantedColumn
from vibeam.exchange.files import FormatError, read_by, require_samples

SHARES = "shares of its full scale"  # unit of whole numbers
STREAMED = 0x7FFF0000  # bytes from which on a size is that of a stream, whose end was not known


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """Times and one channel, the one that ``wanted["value"]`` numbers where there are several."""
    from scipy.io import wavfile

    with read_by("is no WAV file that can be read"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rate, data = wavfile.read(BytesIO(_sized(bytearray(path.read_bytes()))))
    if not len(data) or not rate:
        raise FormatError(f"holds {len(data)} samples, {rate} a second: record it again")
    require_samples(data.shape)
    table = data.reshape(len(data), -1)
    channels, name = table.shape[1], wanted["value"].names[0]
    if channels > 1 and not isinstance(name, int):
        raise FormatError(f"has {channels} channels: say which, column = 1 … {channels}")
    channel = name if isinstance(name, int) else 1
    if not 0 < channel <= channels:
        there = "is 1" if channels == 1 else f"are {channels}"
        raise FormatError(f"has no channel {channel}: there {there}, from 1 on")
    with np.errstate(invalid="ignore"):  # a number that is none is said of the samples
        values = table[:, channel - 1].astype(float)
    if whole := data.dtype.kind in "iu":
        values = (values - (128.0 if data.dtype.kind == "u" else 0.0)) / 2.0 ** (8 * data.dtype.itemsize - 1)
    columns = {
        "frequency": CurveColumn("time", "s", np.arange(len(values)) / rate, origin="from the rate in its head"),
        "value": CurveColumn(f"channel {channel}", SHARES if whole else "", values, place=f"channel {channel}"),
    }
    return Columns(columns, range(1, len(values) + 1), kind="time history")


def _sized(raw: bytearray) -> bytearray:
    """A file up to the end of its samples, with right sizes; FormatError for one that is cut off.

    A stream has 0, or the largest size, where none was known, and goes on to the end of the file.
    """
    order = ">" if raw[:4] == b"RIFX" else "<"
    at, frame = 12, 1
    while at + 8 <= len(raw):
        (size,), start = unpack_from(f"{order}I", raw, at + 4), at + 8
        if raw[at : at + 4] == b"data":
            break
        if raw[at : at + 4] == b"fmt " and start + 14 <= len(raw):
            frame = max(1, unpack_from(f"{order}H", raw, start + 12)[0])
        at = start + size + size % 2
    else:
        return raw
    if raw[:4] == b"RF64" and raw[12:16] == b"ds64":
        raw[:4], size = b"RIFF", unpack_from("<Q", raw, 28)[0]
    covered = unpack_from(f"{order}I", raw, 4)[0] + 8
    there = len(raw) - start
    if size >= STREAMED or (not size and covered <= start):
        size = there // frame * frame
    if size > there:
        told = f"its head says {size // frame} samples, and {there // frame} are there"
        raise FormatError(f"is cut off: {told}: record it again, or correct the size in its head")
    pack_into(f"{order}I", raw, 4, start + size - 8)
    pack_into(f"{order}I", raw, at + 4, size)
    return raw[: start + size]
