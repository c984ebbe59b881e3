"""Curves in LabVIEW's TDMS files: channels by name or ``group/name``, read by npTDMS, which is the extra ``lab``."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.arrays import CLOCKS, UNITS, Held, of
from vibeam.exchange.curves.columns import Columns, WantedColumn
from vibeam.exchange.files import FormatError, read_by, require_samples
from vibeam_models.registry import loaded

MISSING = "npTDMS reads it, and is not installed: pip install 'vibeam[lab]', or export the channels as CSV"


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The channels wanted; their steps and starts are those of their waveforms, the time of day does not count."""
    try:
        files = loaded("nptdms:TdmsFile")
    except ImportError:
        raise FormatError(MISSING) from None
    with read_by("is no TDMS file that can be read"), files.open(path) as file:
        channels = [(f"{group.name}/{each.name}", each) for group in file.groups() for each in group.channels()]
        return of({name: Held(partial(_values, each), _said(each)) for name, each in channels}, wanted, "channel")


def _values(channel: Any) -> Any:
    require_samples((len(channel),))
    return np.asarray(channel[:])


def _said(channel: Any) -> dict[str, Any]:
    found = {name.casefold(): value for name, value in channel.properties.items()}
    return {name: value for name, value in found.items() if name in (*UNITS, *CLOCKS) and value not in ("", None)}
