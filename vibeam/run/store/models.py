"""Properties of the models in the file, ``/models/FIDELITY``, so that a finished run builds no system."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import TYPE_CHECKING

from vibeam.run.store.checksum import sign, verify
from vibeam.run.store.layout import fixed
from vibeam.run.systems import ModelProperties

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
