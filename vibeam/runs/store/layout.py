"""Layout of a results file: one declaration creates the groups, their scales and their attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.runs.store.checksum import CHECKSUM
from vibeam.system.curves import BRANCHES, MotionCurves
from vibeam.system.quantities import LAYOUT, OutputUnits, Quantity, unit_of
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    import h5py


Values = NDArray[Any]

CURVES: Mapping[str, Quantity] = {
    "frequency": LAYOUT["frequency"],
    "amplitude": Quantity(LAYOUT["amplitude"].long_name, "q", "branch"),
    "reach": Quantity(LAYOUT["reach"].long_name, "c", "branch"),
    "velocity": Quantity("velocity just before impact, q̇₋", "c/s", "branch"),
    "stable": Quantity("all Floquet multipliers within the unit circle (1: yes)", "1", "branch"),
    "admissible": Quantity("clear of the stop between its impacts (1: yes)", "1", "branch"),
}

STATES: Mapping[str, Quantity] = {
    "state_displacement": Quantity("modal displacement η at the end of the point", "1", "mode"),
    "state_velocity": Quantity("modal velocity η̇ at the end of the point", "1", "mode"),
    "state_resting": Quantity("in lasting contact with the stop at the end of the point (1: yes)", "1"),
}

#: mass-normalised modal coordinates: displacement in √kg m where the outputs are in m
MODAL_UNITS = {"m": ("kg(1/2) m", "kg(1/2) m s-1"), "1": ("1", "s-1")}


def fixed(text: str) -> NDArray[np.bytes_]:
    """Text of fixed length; variable-length text lies in a heap, in which h5py may search forever if it is damaged."""
    import h5py

    encoded = text.encode()
    return np.array(encoded, dtype=h5py.string_dtype("utf-8", len(encoded)))


def write_branch(group: h5py.Group, frequency: Array, modes: int, units: OutputUnits) -> None:
    """Lay out one branch, all its points not run yet; datasets are allocated, so that no later write moves one."""
    blank = FrequencyResponse.empty(frequency, modes)
    scales: dict[str, Values] = {"impact": np.arange(1, VELOCITIES_KEPT + 1), "mode": np.arange(1, modes + 1)}
    for name, values in scales.items():
        _scale(group.create_dataset(name, data=values), f"{name} number", "1")
    for name, quantity in LAYOUT.items():
        _quantity(group, name, quantity, getattr(blank, name), unit_of(quantity, units))
    rows = np.full((len(frequency), modes), np.nan)
    blanks: tuple[Values, ...] = (rows, rows, np.zeros(len(frequency), dtype=np.int64))
    for (name, quantity), values, text in zip(STATES.items(), blanks, (*MODAL_UNITS[units.length], "1"), strict=True):
        _quantity(group, name, quantity, values, text)
    checksums = Quantity("CRC-32 of all values of the point, its branch and what decides them", "1")
    _quantity(group, CHECKSUM, checksums, np.zeros(len(frequency), dtype=np.uint32), "1")
    group["ended"].attrs.update(_meanings())
    group.attrs["done"] = np.int64(0)


def write_curves(group: h5py.Group, curves: MotionCurves, units: OutputUnits) -> None:
    """Write all motions known to a solver; flags as 0 and 1."""
    group.attrs["periods"] = np.int64(curves.periods)
    _scale(group.create_dataset("branch", data=np.arange(1, BRANCHES + 1)), "branch number, the larger first", "1")
    for name, quantity in CURVES.items():
        values: Values = getattr(curves, name)
        values = values.astype(np.int64) if values.dtype == bool else values
        _quantity(group, name, quantity, values, unit_of(quantity, units))


def read_curves(group: h5py.Group) -> MotionCurves:
    """Read all motions known to a solver."""
    values = {name: group[name][()] for name in CURVES}
    flags = {name: values[name].astype(bool) for name in ("stable", "admissible")}
    return MotionCurves(**(values | flags), periods=int(group.attrs["periods"]))


def _quantity(group: h5py.Group, name: str, quantity: Quantity, values: Values, unit: str) -> None:
    dataset = group.create_dataset(name, data=values)
    if name == "frequency":
        return _scale(dataset, quantity.long_name, unit)
    _describe(dataset, quantity.long_name, unit)
    dataset.dims[0].attach_scale(group["frequency"])
    if quantity.dimension is not None:
        dataset.dims[1].attach_scale(group[quantity.dimension])
    return None


def _scale(dataset: h5py.Dataset, long_name: str, unit: str) -> None:
    dataset.make_scale(dataset.name.rsplit("/", 1)[-1])
    _describe(dataset, long_name, unit)


def _describe(dataset: h5py.Dataset, long_name: str, unit: str) -> None:
    dataset.attrs["long_name"] = long_name
    dataset.attrs["units"] = unit


def _meanings() -> dict[str, object]:
    """Meanings of the codes of ``ended``: as flag attributes of the CF conventions, and in words."""
    return {
        "flag_values": np.array([end.code for end in Ended], dtype=np.int64),
        "flag_meanings": " ".join(end.name for end in Ended),
        "meaning": "; ".join(f"{end.code}: {end.value}" for end in Ended),
    }
