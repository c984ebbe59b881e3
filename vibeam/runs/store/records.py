"""Records beside the branches, each replaced as a whole: curves, comparisons; properties of the models.

The attributes of ``/comparison/FIDELITY`` and ``/compared/FIDELITY`` are for other programs too; a dataset beside them
has all of the comparisons as JSON. With ``/models/FIDELITY`` a finished run builds no system.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from vibeam.case.held import Held
from vibeam.periodic.motion_kind import SteadyKind
from vibeam.runs.comparison.differences import BothChoices, HeldComparison
from vibeam.runs.comparison.ends import SweptEnd
from vibeam.runs.comparison.errors import AmplitudeError, ComparedFidelity, EndError, KindDifference, ResponseComparison
from vibeam.runs.store.branches import write_quantity
from vibeam.runs.systems import ModelProperties
from vibeam.store.hdf5 import fixed, scale, text_of
from vibeam.system.curves import BRANCHES, MotionCurves
from vibeam.system.quantities import LAYOUT, DatasetQuantity, OutputUnits, unit_of

if TYPE_CHECKING:
    import h5py

Kept = TypeVar("Kept")
MODELS, COMPARISON = "models", "comparison"  # groups of the file, in each one for each fidelity
CURVES = "curves"  # group of all motions known to a solver, beside those of the directions


@dataclass(frozen=True)
class KeyedRecord(Generic[Kept]):
    """Group ``place`` of the file, how it is written and read; it has the key of all that decides it."""

    place: str
    write: Callable[[h5py.Group, Kept], None]
    read: Callable[[h5py.Group], Kept]


def kept(file: h5py.File, record: KeyedRecord[Kept], key: str) -> Kept | None:
    """The record stored for ``key``; None without one."""
    fits = key and record.place in file and text_of(file[record.place], "key") == key
    return record.read(file[record.place]) if fits else None


def keep(file: h5py.File, record: KeyedRecord[Kept], key: str, value: Kept) -> None:
    """Replace a record by ``value``."""
    file.pop(record.place, None)
    group = file.create_group(record.place)
    record.write(group, value)
    group.attrs["key"] = fixed(key)


CURVE_ROWS: Mapping[str, DatasetQuantity] = {
    "frequency": LAYOUT["frequency"],
    "amplitude": DatasetQuantity(LAYOUT["amplitude"].long_name, "q", "branch"),
    "reach": DatasetQuantity(LAYOUT["reach"].long_name, "c", "branch"),
    "velocity": DatasetQuantity("velocity just before impact, q̇₋", "c/s", "branch"),
    "stable": DatasetQuantity("all Floquet multipliers within the unit circle (1: yes)", "1", "branch"),
    "admissible": DatasetQuantity("clear of the stop between its impacts (1: yes)", "1", "branch"),
}


def curves_of(fidelity: str, units: OutputUnits) -> KeyedRecord[MotionCurves]:
    """Record of all motions known to the solver of a fidelity; ``units``: of the output."""

    def write(group: h5py.Group, curves: MotionCurves) -> None:
        group.attrs["periods"] = np.int64(curves.periods)
        scale(group, "branch", np.arange(1, BRANCHES + 1), "branch number, the larger first", "1")
        for name, quantity in CURVE_ROWS.items():
            values = getattr(curves, name)
            values = values.astype(np.int64) if values.dtype == bool else values
            write_quantity(group, name, quantity, values, unit_of(quantity, units))

    return KeyedRecord(f"{fidelity}/{CURVES}", write, read_curves)


def read_curves(group: h5py.Group) -> MotionCurves:
    """Read all motions known to a solver."""
    values = {name: group[name][()] for name in CURVE_ROWS}
    flags = {name: values[name].astype(bool) for name in ("stable", "admissible")}
    return MotionCurves(**(values | flags), periods=int(group.attrs["periods"]))


WHOLE = "whole.json"  # dataset of a comparison, by a name that no fidelity can have
Attributes = Mapping[str, Mapping[str, str | float]]


def comparison_attributes(found: Sequence[HeldComparison]) -> Attributes:
    """Attributes of each fidelity's group: shares of the amplitude, NaN left out; texts where something is named."""
    groups: dict[str, dict[str, str | float]] = {}
    for each in found:
        other = "" if each.other is None else each.other.label
        groups[each.finest] = _known(held=each.held.label, other_choice=other)
        for row in each.rows:
            groups[row.fidelity] = _known(
                held=each.held.label, other_choice=other, finest=each.finest, peak=row.held,
                peak_other_choice=row.other, verdict_turns="yes" if row.turns else "no", unknown=row.why,
            )  # fmt: skip
    return groups


def _known(**values: str | float) -> dict[str, str | float]:
    return {name: value for name, value in values.items() if value == value and value != ""}  # NaN is not itself


def _write_comparisons(home: h5py.Group, found: tuple[HeldComparison, ...]) -> None:
    for name, attributes in comparison_attributes(found).items():
        home.create_group(name).attrs.update(attributes)
    home.create_dataset(WHOLE, data=fixed(json.dumps([asdict(each) for each in found])))


def read_comparisons(home: h5py.Group) -> tuple[HeldComparison, ...]:
    """Read the stored comparisons."""
    return tuple(map(_comparison, json.loads(home[WHOLE][()].decode())))


def _comparison(values: dict[str, Any]) -> HeldComparison:
    other = None if values["other"] is None else Held(**values["other"])
    rows = tuple(BothChoices(**row) for row in values["rows"])
    return HeldComparison(**values | {"held": Held(**values["held"]), "other": other, "rows": rows})


COMPARISONS = KeyedRecord[tuple[HeldComparison, ...]](COMPARISON, _write_comparisons, read_comparisons)


def _write_compared(home: h5py.Group, found: tuple[ComparedFidelity, ...]) -> None:
    for each in found:
        home.create_group(each.fidelity).attrs.update(_numbers(each))
    home.create_dataset(WHOLE, data=fixed(json.dumps([asdict(each) for each in found])))


def _numbers(each: ComparedFidelity) -> dict[str, str | float]:
    """Numbers of a comparison for other programs."""
    own = each.comparison or ResponseComparison()
    errors = {"amplitude_error": own.amplitude_error, "frequency_error": own.frequency_error, "kinds": own.kind_width}
    known = errors if each.comparison else {}
    return _known(reference=each.reference, modes=each.modes, elements=each.elements, unknown=each.why, **known)


def read_compared(home: h5py.Group) -> tuple[ComparedFidelity, ...]:
    """Read the stored comparisons with the finest fidelities and fuller models."""
    return tuple(map(_compared, json.loads(home[WHOLE][()].decode())))


def _compared(values: dict[str, Any]) -> ComparedFidelity:
    own = values["comparison"]
    return ComparedFidelity(**values | {"comparison": None if own is None else _response_comparison(own)})


def _response_comparison(values: dict[str, Any]) -> ResponseComparison:
    amplitude, scattered = (_amplitude(values[name]) for name in ("amplitude", "scattered"))
    kinds = (each | {way: SteadyKind(*each[way]) for way in ("ours", "reference")} for each in values["kinds"])
    ends = (each | {way: _end(each[way]) for way in ("ours", "reference")} for each in values["ends"])
    return ResponseComparison(
        amplitude,
        scattered,
        tuple(EndError(**each) for each in ends),
        tuple(KindDifference(**each) for each in kinds),
        values["places"],
        tuple((way, low, high) for way, low, high in values["unknown"]),
    )


def _amplitude(values: dict[str, Any] | None) -> AmplitudeError | None:
    return None if values is None else AmplitudeError(**values)


def _end(values: dict[str, Any]) -> SweptEnd:
    return SweptEnd(**values | {way: SteadyKind(*values[way]) for way in ("before", "after")})


COMPARED = KeyedRecord[tuple[ComparedFidelity, ...]]("compared", _write_compared, read_compared)

Keyed = Mapping[str, tuple[str, ModelProperties]]  # by fidelity: the key of all that decides them, and the properties


def read_models(file: h5py.File) -> Keyed:
    """Read the properties of every model; empty without any."""
    names = [field.name for field in fields(ModelProperties)]
    return {
        name: (text_of(group, "key"), ModelProperties(**{field: group.attrs[field].item() for field in names}))
        for name, group in (file[MODELS].items() if MODELS in file else ())
    }


def write_models(file: h5py.File, models: Keyed) -> None:
    """Replace the properties of all models."""
    file.pop(MODELS, None)
    for name, (key, properties) in models.items():
        group = file.create_group(f"{MODELS}/{name}")
        group.attrs.update(asdict(properties))
        group.attrs["key"] = fixed(key)
