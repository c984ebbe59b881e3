"""Models in the results file: their properties, ``/models/FIDELITY``, and comparisons, ``/comparison/FIDELITY``.

With the properties a finished run builds no system. The attributes of a comparison are for other programs; a dataset
beside them has all of it as JSON, and the group the key of what it was computed from.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from vibeam.case.held import Held
from vibeam.runs.comparison.differences import BothChoices, HeldComparison, OwnLimit
from vibeam.runs.store.checksum import sign, verify
from vibeam.runs.store.layout import fixed
from vibeam.runs.systems import ModelProperties
from vibeam.system.curves import Difference

if TYPE_CHECKING:
    import h5py


MODELS = "models"  # group of the file, one group in it for each fidelity
Keyed = Mapping[str, tuple[str, ModelProperties]]  # by fidelity: the key of all that decides them, and the properties


def read_models(file: h5py.File) -> Keyed:
    """Read the properties of every model; empty without any, ValueError if damaged."""
    found = {name: _read(group) for name, group in file[MODELS].items()} if MODELS in file else {}
    return {name: each for name, each in found.items() if each is not None}


def _read(group: h5py.Group) -> tuple[str, ModelProperties] | None:
    """Key and properties of one model; None where an earlier version wrote fewer."""
    verify(group)
    names = [field.name for field in fields(ModelProperties)]
    if any(name not in group.attrs for name in names):
        return None
    return group.attrs["key"].decode(), ModelProperties(**{name: group.attrs[name].item() for name in names})


def write_models(file: h5py.File, models: Keyed) -> None:
    """Replace the properties of all models."""
    if MODELS in file:
        del file[MODELS]
    for name, (key, properties) in models.items():
        group = file.create_group(f"{MODELS}/{name}")
        group.attrs.update(asdict(properties))
        group.attrs["key"] = fixed(key)
        sign(group)


COMPARISON = "comparison"  # group of the file, one group in it for each fidelity
WHOLE = "whole.json"  # dataset in it, by a name that no fidelity can have
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


def write_comparisons(file: h5py.File, key: str, found: Sequence[HeldComparison]) -> None:
    """Replace the stored comparisons, none of them included; ``key``: of what they were computed from."""
    if COMPARISON in file:
        del file[COMPARISON]
    if not found:
        return
    home = file.create_group(COMPARISON)
    for name, attributes in comparison_attributes(found).items():
        home.create_group(name).attrs.update(attributes)
    home.attrs["key"] = fixed(key or " ")
    home.create_dataset(WHOLE, data=fixed(json.dumps([asdict(each) for each in found])))
    sign(home)


def key_of_comparisons(file: h5py.File) -> str:
    """Key of the stored comparisons; empty without any."""
    return file[COMPARISON].attrs.get("key", b"").decode() if COMPARISON in file else ""


def read_comparisons(file: h5py.File) -> tuple[HeldComparison, ...]:
    """Read the stored comparisons; ValueError if damaged."""
    verify(file[COMPARISON])
    return tuple(map(_comparison, json.loads(file[COMPARISON][WHOLE][()].decode())))


def _comparison(values: dict[str, Any]) -> HeldComparison:
    other = None if values["other"] is None else Held(**values["other"])
    rows, limit = tuple(map(_choices, values["rows"])), OwnLimit(**_with_differences(values["limit"]))
    return HeldComparison(**values | {"held": Held(**values["held"]), "other": other, "rows": rows, "limit": limit})


def _choices(values: dict[str, Any]) -> BothChoices:
    return BothChoices(**_with_differences(values) | {"uncertainty": tuple(values["uncertainty"])})


def _with_differences(values: dict[str, Any]) -> dict[str, Any]:
    return values | {name: Difference(**values[name]) for name in ("held", "other")}
