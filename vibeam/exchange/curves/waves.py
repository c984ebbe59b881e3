"""Curves in WAV files: one channel over time, read by scipy once the sizes in its head are known to be right."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.columns import Columns, CurveColumn, WantedColumn
from vibeam.exchange.files import FormatError, read_by, require_samples

SHARES = "shares of its full scale"  # unit of whole numbers
TAG = 4  # bytes of the name of a part: none are there at the end
STREAMED = 0x7FFF0000  # bytes from which on a size is that of a stream, whose end was not known


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """Times and one channel, the one that ``wanted["value"]`` numbers where there are several."""
    from scipy.io import wavfile

    with read_by("is no WAV file that can be read"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        raw = path.read_bytes()
        if raw[:4] in (b"RIFF", b"RIFX"):  # a size of the whole that is wrong does no harm
            raw = raw[:4] + (len(raw) - 8).to_bytes(4, "big" if raw[:4] == b"RIFX" else "little") + raw[8:]
        rate, data = wavfile.read(_Whole(raw))
    if not len(data) or not rate:
        raise FormatError(f"holds {len(data)} samples, {rate} a second: record it again")
    require_samples(data.shape)
    table = data.reshape(len(data), -1)
    channels, name = table.shape[1], wanted["value"].names[0]
    channel = name if isinstance(name, int) else 1
    if not 0 < channel <= channels or (channels > 1 and name != channel):
        raise FormatError(f"has {channels} channels: say which, column = 1 … {channels}")
    with np.errstate(invalid="ignore"):  # a number that is none is said of the samples
        values = table[:, channel - 1].astype(float)
    if whole := data.dtype.kind in "iu":
        values = (values - (128.0 if data.dtype.kind == "u" else 0.0)) / 2.0 ** (8 * data.dtype.itemsize - 1)
    columns = {
        "frequency": CurveColumn("time", "s", np.arange(len(values)) / rate, origin="from the rate in its head"),
        "value": CurveColumn(f"channel {channel}", SHARES if whole else "", values, place=f"channel {channel}"),
    }
    return Columns(columns, range(1, len(values) + 1), kind="time history")


class _Whole(BytesIO):
    """Content of a file, whose every part must be as long as its head says; that of a stream may end before."""

    def read(self, size: int | None = -1) -> bytes:
        found = super().read(size)
        if len(found) < (size or 0) < STREAMED and size != TAG:
            raise FormatError(f"is cut off: its head says {size} bytes, and {len(found)} are there: record it again")
        return found
