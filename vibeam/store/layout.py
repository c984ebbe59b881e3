"""How a results file is laid out: one declaration makes the groups, their scales and their attributes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from vibeam.motions import BRANCHES, MotionCurves
from vibeam.response import VELOCITIES_KEPT, Array, Ended, FrequencyResponse
from vibeam.store.checksum import CHECKSUM

if TYPE_CHECKING:
    import h5py

Values = NDArray[Any]
#: q: unit of the outputs; q/s: their velocity; E: energy; anything else is the unit itself
Unit = Literal["q", "q/s", "E", "Hz", "s", "1"]


@dataclass(frozen=True)
class Quantity:
    """One dataset: the paper's name where it has one, its unit, and its dimension beyond the frequency."""

    long_name: str
    unit: Unit
    dimension: Literal["impact", "mode", "branch"] | None = None


LAYOUT: Mapping[str, Quantity] = {
    "frequency": Quantity("drive frequency, Ω/2π", "Hz"),
    "amplitude": Quantity("amplitude of the output, ½(max − min)", "q"),
    "reach": Quantity("largest distance of the contact point from the stop, Q = Δ − min q", "q"),
    "maximum": Quantity("maximum of the output", "q"),
    "minimum": Quantity("minimum of the output", "q"),
    "impacts_per_period": Quantity("impacts a drive period", "1"),
    "impact_velocity": Quantity("mean velocity just before impact, q̇₋", "q/s"),
    "impact_velocities": Quantity("last velocities just before impact, q̇₋, oldest first", "q/s", "impact"),
    "period": Quantity("drive periods after which the motion repeats; 0: it does not; −1: no contact", "1"),
    "rest": Quantity("share of the time at rest on the stop", "1"),
    "mode_energy": Quantity("time-mean energy of each mode", "E", "mode"),
    "ended": Quantity("why the computation ended", "1"),
    "impacts": Quantity("impacts computed, settling included", "1"),
    "evaluations": Quantity("evaluations of the contact displacement", "1"),
    "cpu_seconds": Quantity("CPU time of the point", "s"),
}
CURVES: Mapping[str, Quantity] = {
    "frequency": LAYOUT["frequency"],
    "amplitude": Quantity(LAYOUT["amplitude"].long_name, "q", "branch"),
    "reach": Quantity(LAYOUT["reach"].long_name, "q", "branch"),
    "velocity": Quantity("velocity just before impact, q̇₋", "q/s", "branch"),
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


def unit_of(quantity: Quantity, output: str) -> str:
    """The unit as text, for outputs in metres (``"m"``) or of no dimension (``"1"``)."""
    plain = output == "1"
    named = {"q": output, "q/s": "s-1" if plain else f"{output} s-1", "E": "s-2" if plain else "J"}
    return named.get(quantity.unit, quantity.unit)


def fixed(text: str) -> NDArray[np.bytes_]:
    """Text of fixed length: text of any length lies in a heap, in which h5py can search forever if it is damaged."""
    import h5py

    encoded = text.encode()
    return np.array(encoded, dtype=h5py.string_dtype("utf-8", len(encoded)))


def write_branch(group: h5py.Group, frequency: Array, modes: int, unit: str) -> None:
    """Lay out one branch, all its points not run yet; every dataset is allocated, so that no later write moves one."""
    blank = FrequencyResponse.empty(frequency, modes)
    scales: dict[str, Values] = {"impact": np.arange(1, VELOCITIES_KEPT + 1), "mode": np.arange(1, modes + 1)}
    for name, values in scales.items():
        _scale(group.create_dataset(name, data=values), f"{name} number", "1")
    for name, quantity in LAYOUT.items():
        _quantity(group, name, quantity, getattr(blank, name), unit_of(quantity, unit))
    rows = np.full((len(frequency), modes), np.nan)
    blanks: tuple[Values, ...] = (rows, rows, np.zeros(len(frequency), dtype=np.int64))
    for (name, quantity), values, text in zip(STATES.items(), blanks, (*MODAL_UNITS[unit], "1"), strict=True):
        _quantity(group, name, quantity, values, text)
    checksums = Quantity("CRC-32 of all values of the point, its branch and what decides them", "1")
    _quantity(group, CHECKSUM, checksums, np.zeros(len(frequency), dtype=np.uint32), "1")
    group["ended"].attrs.update(_meanings())
    group.attrs["done"] = np.int64(0)


def write_curves(group: h5py.Group, curves: MotionCurves, unit: str) -> None:
    """Lay out all motions that a solver knows; flags as 0 and 1."""
    group.attrs["periods"] = np.int64(curves.periods)
    _scale(group.create_dataset("branch", data=np.arange(1, BRANCHES + 1)), "branch number, the larger first", "1")
    for name, quantity in CURVES.items():
        values: Values = getattr(curves, name)
        values = values.astype(np.int64) if values.dtype == bool else values
        _quantity(group, name, quantity, values, unit_of(quantity, unit))


def read_curves(group: h5py.Group) -> MotionCurves:
    """What ``write_curves`` put there."""
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
    """What the codes of ``ended`` mean: as the CF conventions have it, and in words."""
    return {
        "flag_values": np.array([end.code for end in Ended], dtype=np.int64),
        "flag_meanings": " ".join(end.name for end in Ended),
        "meaning": "; ".join(f"{end.code}: {end.value}" for end in Ended),
    }
