"""Curves in universal files: functions at nodal degrees of freedom (data set 58), read by pyuff, the extra ``lab``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import Columns, CurveColumn, WantedColumn
from vibeam.exchange.files import FormatError
from vibeam.exchange.uff import data_sets

ABSCISSAE = {17: "time", 18: "frequency"}  # specific data types
FUNCTIONS = {
    2: "power spectrum", 3: "power spectrum", 4: "frequency response", 5: "transmissibility", 9: "power density",
    10: "power density", 12: "spectrum",
}  # fmt: skip
UNITS = {8: "m", 11: "m/s", 12: "m/s^2"}  # specific data types of an ordinate
AXES = {1: "X", 2: "Y", 3: "Z", 4: "RX", 5: "RY", 6: "RZ"}


def read(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """Frequency and modulus of one data set 58, the one that ``wanted["value"]`` numbers where there are several.

    Time and value where ``wanted["frequency"]`` may be called time.
    """
    sets = data_sets(path, "export the curve as CSV")
    curves = [each for each in sets if each["type"] == 58]
    one = curves[_chosen(curves, wanted["value"])]
    frequency, ordinate = np.asarray(one["x"], dtype=float), np.asarray(one["data"])
    over = ABSCISSAE.get(int(one.get("abscissa_spec_data_type") or 0), "")
    timed = "time" in wanted["frequency"].names
    if over not in ("frequency", *(["time"] if timed else [])):
        cure = "over time" if timed else "over frequency: export a frequency response or an order"
        raise FormatError(f"its data set 58 is not {cure}")
    if not len(frequency) == len(ordinate) == int(one.get("num_pts") or len(ordinate)) > 0:
        told = f"{len(frequency)} frequencies and {len(ordinate)} values for {one.get('num_pts')} points"
        raise FormatError(f"its data set 58 has {told}: blanks are missing between numbers, or lines?")
    values = np.abs(ordinate) if np.iscomplexobj(ordinate) else np.asarray(ordinate, dtype=float)
    if not (np.isfinite(frequency).all() and np.isfinite(values).all()):
        raise FormatError("its data set 58 has entries that are no numbers: blanks are missing between numbers?")
    head = f"{FUNCTIONS.get(int(one.get('func_type') or 0), '')} {_called(one)}".strip()
    columns = {
        "frequency": CurveColumn(over, "s" if over == "time" else "Hz", frequency),
        "value": CurveColumn(head, _unit(one), values),
    }
    return Columns(columns, tuple(range(1, len(frequency) + 1)))


def _chosen(curves: list[dict[str, Any]], wanted: WantedColumn) -> int:
    if not curves:
        raise FormatError("has no curve: a data set 58 is needed")
    if isinstance(wanted.names[0], int):
        number = wanted.names[0]
        if not 0 < number <= len(curves):
            raise FormatError(f"has {len(curves)} data sets 58: there is no number {number}")
        return number - 1
    if len(curves) > 1:
        told = ", ".join(f"{number}: {_called(each)}" for number, each in enumerate(curves[:8], 1))
        raise FormatError(f"has {len(curves)} data sets 58, {told}: say which by its number, columns = {{ value = 1 }}")
    return 0


def _called(one: Mapping[str, Any]) -> str:
    """Response and reference degree of freedom: ``2Z/1Z``."""
    parts = []
    for part in ("rsp", "ref"):
        direction = int(one.get(f"{part}_dir") or 0)
        sign = "-" if direction < 0 else ""
        parts.append(f"{one.get(f'{part}_node', 0)}{sign}{AXES.get(abs(direction), '')}")
    return "/".join(parts)


def _unit(one: Mapping[str, Any]) -> str:
    """Unit of the ordinate: its label, or by its type; of a ratio over a denominator, empty where it is not said."""
    label = str(one.get("ordinate_axis_units_lab") or "").strip()
    if label and label.upper() != "NONE":
        return label
    if int(one.get("orddenom_spec_data_type") or 0):
        return ""
    return UNITS.get(int(one.get("ordinate_spec_data_type") or 0), "")
