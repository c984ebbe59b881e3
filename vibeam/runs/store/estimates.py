"""Error estimates in the file, ``/estimates/FIDELITY/up`` and ``down``: ``frequency`` as scale."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate, FidelityEstimate
from vibeam.runs.store.checksum import sign, verify
from vibeam.runs.store.layout import fixed

if TYPE_CHECKING:
    import h5py


ESTIMATES = "estimates"  # group of the file, one group in it for each fidelity

MEANINGS = {
    **{name: f"{name.replace('_', ' ')} over that of the full model, less 1, estimated" for name in QUANTITIES},
    **{
        f"{name}_bound": f"estimated size of the error in {name.replace('_', ' ')} against the full model"
        for name in QUANTITIES
    },
    "correction": "first Newton correction of the impacts, rad and share of the impulse",
    "basis": "what the estimate is of, or why there is none",
}

HEAD = ("modes", "whole", "cpu_seconds")


def write_estimates(file: h5py.File, key: str, found: Mapping[str, FidelityEstimate]) -> None:
    """Replace the stored estimates; ``key``: of what they were computed from."""
    if ESTIMATES in file:
        del file[ESTIMATES]
    home = file.create_group(ESTIMATES)
    for name, each in found.items():
        group = home.create_group(name)
        group.attrs.update({field: getattr(each, field) for field in HEAD})
        group.attrs["why"] = fixed(each.why or " ")
        for direction, branch in each.branches.items():
            _write(group.create_group(direction), branch)
    home.attrs["key"] = fixed(key or " ")
    home.attrs["order"] = fixed(" ".join(found) or " ")
    sign(home)


def _write(group: h5py.Group, branch: ErrorEstimate) -> None:
    scale = group.create_dataset("frequency", data=branch.frequency)
    scale.make_scale("frequency")
    scale.attrs["long_name"], scale.attrs["units"] = "drive frequency, Ω/2π", "Hz"
    for name, meaning in MEANINGS.items():
        dataset = group.create_dataset(name, data=getattr(branch, name))
        dataset.attrs["long_name"], dataset.attrs["units"] = meaning, "1"
        dataset.dims[0].attach_scale(scale)
    group["basis"].attrs["flag_values"] = np.array([each.code for each in Basis], dtype=np.int64)
    group["basis"].attrs["flag_meanings"] = " ".join(each.name for each in Basis)
    group["basis"].attrs["meaning"] = "; ".join(f"{each.code}: {each.value}" for each in Basis)


def key_of_estimates(file: h5py.File) -> str:
    """Key of the stored estimates; empty without any."""
    return file[ESTIMATES].attrs.get("key", b"").decode() if ESTIMATES in file else ""


def read_estimates(file: h5py.File) -> dict[str, FidelityEstimate]:
    """Read the stored estimates; ValueError if damaged."""
    verify(file[ESTIMATES])
    home = file[ESTIMATES]
    return {name: _read(home[name]) for name in home.attrs["order"].decode().split()}


def _read(group: h5py.Group) -> FidelityEstimate:
    head = {field: group.attrs[field].item() for field in HEAD}
    branches = {
        direction: ErrorEstimate(group[direction]["frequency"][()], **{n: group[direction][n][()] for n in MEANINGS})
        for direction in ("up", "down")
        if direction in group
    }
    return FidelityEstimate(**head, branches=branches, why=group.attrs["why"].decode().strip())
