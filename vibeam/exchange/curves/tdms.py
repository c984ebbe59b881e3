"""Curves in LabVIEW's TDMS files: channels by name or ``group/name``, read by npTDMS, which is the extra ``lab``."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.arrays import WORDS, of
from vibeam.exchange.curves.columns import Columns, WantedColumn
from vibeam.exchange.files import FormatError, read_by, require_samples
from vibeam_models.registry import loaded

MISSING = "npTDMS reads it, and is not installed: pip install 'vibeam[lab]', or export the channels as CSV"


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The channels wanted; their steps and starts are those of their waveforms, the time of day does not count."""
    try:
        loaded("nptdms.log:log_manager").set_level(logging.CRITICAL)  # what it prints of damage is a fault here
        files = loaded("nptdms:TdmsFile")
    except ImportError:
        raise FormatError(MISSING) from None
    with read_by("is no TDMS file that can be read"), path.open("rb") as raw, files.open(raw) as file:
        _require_whole(file)
        held: dict[str, Any] = {}
        for each in (channel for group in file.groups() for channel in group.channels()):
            name = f"{each.group_name}/{each.name}"
            held[name] = partial(_values, each)
            said = {word.casefold(): value for word, value in each.properties.items() if value not in ("", None)}
            held |= {f"{name}@{word}": partial(np.asarray, said[word]) for word in WORDS if word in said}
        return of(held, wanted, "channel")


def _require_whole(file: Any) -> None:
    """FormatError for a file whose last segment was cut off."""
    last = file.file_status
    if last.incomplete_final_segment:
        told = [f"{each.read_length} of {each.expected_length}" for each in (last.channel_statuses or {}).values()]
        raise FormatError(f"is cut off: of its last segment {', '.join(told[:3]) or 'no'} samples are there")


def _values(channel: Any) -> Any:
    require_samples((len(channel),))
    return np.asarray(channel[:])
