"""Records beside the branches, each replaced as a whole: curves, comparisons, estimates; properties of the models.

The attributes of ``/comparison/FIDELITY`` and the datasets of ``/estimates/FIDELITY/up`` and ``down`` are for other
programs too; a dataset beside the first has all of a comparison as JSON. With ``/models/FIDELITY`` a finished run
builds no system.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from vibeam.case.held import Held
from vibeam.runs.comparison.differences import BothChoices, HeldComparison, OwnLimit
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate, FidelityEstimate
from vibeam.runs.store.branches import write_quantity
from vibeam.runs.systems import ModelProperties
from vibeam.store.hdf5 import describe_codes, described, fixed, scale, text_of
from vibeam.system.curves import BRANCHES, Difference, MotionCurves
from vibeam.system.quantities import LAYOUT, DatasetQuantity, OutputUnits, unit_of

if TYPE_CHECKING:
    import h5py

Kept = TypeVar("Kept")
MODELS, COMPARISON, ESTIMATES = "models", "comparison", "estimates"  # groups of the file, in each one for each fidelity
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
        groups[each.finest] = _known(
            held=each.held.label, other_choice=other, limit_peak=each.limit.held.peak, limit_rms=each.limit.held.rms,
            limit_peak_other_choice=each.limit.other.peak, limit_unknown=each.limit.why,
        )  # fmt: skip
        for row in each.rows:
            groups[row.fidelity] = _known(
                held=each.held.label, other_choice=other, finest=each.finest, peak=row.held.peak,
                peak_other_choice=row.other.peak, verdict_turns="yes" if row.turns else "no", unknown=row.why,
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
    each = (_with_differences(row) | {"uncertainty": tuple(row["uncertainty"])} for row in values["rows"])
    rows, limit = tuple(BothChoices(**row) for row in each), OwnLimit(**_with_differences(values["limit"]))
    return HeldComparison(**values | {"held": Held(**values["held"]), "other": other, "rows": rows, "limit": limit})


def _with_differences(values: dict[str, Any]) -> dict[str, Any]:
    return values | {name: Difference(**values[name]) for name in ("held", "other")}


COMPARISONS = KeyedRecord[tuple[HeldComparison, ...]](COMPARISON, _write_comparisons, read_comparisons)

ESTIMATE_ROWS = {
    **{name: f"{name.replace('_', ' ')} over that of the full model, less 1, estimated" for name in QUANTITIES},
    **{
        f"{name}_bound": f"estimated size of the error in {name.replace('_', ' ')} against the full model"
        for name in QUANTITIES
    },
    "correction": "first Newton correction of the impacts, rad and share of the impulse",
    "basis": "what the estimate is of, or why there is none",
}
HEAD = ("modes", "whole", "cpu_seconds", "swept", "short")


def _write_estimates(home: h5py.Group, found: Mapping[str, FidelityEstimate]) -> None:
    for name, each in found.items():
        group = home.create_group(name)
        group.attrs.update({field: getattr(each, field) for field in HEAD})
        group.attrs["why"] = fixed(each.why)
        for direction, branch in each.branches.items():
            _write_estimate(group.create_group(direction), branch)
    home.attrs["order"] = fixed(" ".join(found))


def _write_estimate(group: h5py.Group, branch: ErrorEstimate) -> None:
    frequency = scale(group, "frequency", branch.frequency, "drive frequency, Ω/2π", "Hz")
    for name, meaning in ESTIMATE_ROWS.items():
        described(group, name, getattr(branch, name), meaning, "1", frequency)
    describe_codes(group["basis"], Basis)


def read_estimates(home: h5py.Group) -> dict[str, FidelityEstimate]:
    """Read the stored error estimates."""
    return {name: _estimate(home[name]) for name in text_of(home, "order").split()}


def _estimate(group: h5py.Group) -> FidelityEstimate:
    head = {field: group.attrs[field].item() for field in HEAD if field in group.attrs}
    branches = {
        way: ErrorEstimate(group[way]["frequency"][()], **{name: group[way][name][()] for name in ESTIMATE_ROWS})
        for way in ("up", "down")
        if way in group
    }
    return FidelityEstimate(**head, branches=branches, why=text_of(group, "why"))


ESTIMATED = KeyedRecord[dict[str, FidelityEstimate]](ESTIMATES, _write_estimates, read_estimates)

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
