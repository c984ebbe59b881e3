"""Measured signals from files: a column of time or frequency, one of values, one of their uncertainty."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vibeam.exchange.curves.columns import WantedColumn
from vibeam.exchange.curves.read import read_columns
from vibeam.exchange.curves.record import factor
from vibeam.exchange.faults import CaseError, fault_in
from vibeam.exchange.files import FormatError
from vibeam_models.arrays import Array

USUAL = {"time": ("time", "t"), "frequency": ("frequency", "freq", "f")}
VALUES = ("displacement", "amplitude", "magnitude", "value", "x", "a")
UNITS = {"time": "s", "frequency": "Hz"}


def read_signal(
    path: Path, over: str, x: str | None = None, y: str | None = None
) -> tuple[Array, Array, Array | None]:  # fmt: skip
    """Times in s or frequencies in Hz (n,), values as they stand, uncertainties where the file has them.

    ``x``, ``y``: heads of the columns, or their numbers from 1. CaseError with the place and the cure.
    """
    wanted = {
        "frequency": WantedColumn((_head(x),) if x else USUAL[over]),
        "value": WantedColumn((_head(y),) if y else VALUES),
        "uncertainty": WantedColumn(("uncertainty", "u"), needed=False),
    }
    try:
        found = read_columns(path, wanted).columns
        at = found["frequency"]
        scaled = at.values * factor(at.unit, UNITS[over])
    except FormatError as wrong:
        raise CaseError([fault_in(path, wrong.line, _told(wrong.message))]) from None
    except ValueError as wrong:
        raise CaseError([fault_in(path, None, f"column {at.head!r}: {wrong}")]) from None
    value = found["value"].values
    known = np.isfinite(scaled) & np.isfinite(value)
    uncertainty = found["uncertainty"].values[known] if "uncertainty" in found else None
    return scaled[known], value[known], uncertainty


def _head(text: str) -> str | int:
    return int(text) if text.isdigit() else text


def _told(message: str) -> str:
    return message.partition("; say which in the case")[0] + (
        "; name them: --x HEAD --y HEAD" * ("say which" in message)
    )
