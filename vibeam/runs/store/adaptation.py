"""Adaptation of a results file to its case: a new file, the branches of an old one that stay, or whose file it is."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.files import dotted
from vibeam.runs.store.branches import (
    BranchPlan,
    branch_names,
    last_with_state,
    lay_out,
    points_of,
    read_rows,
    write_rows,
)
from vibeam.runs.store.records import COMPARED, COMPARISON, CURVES, MODELS
from vibeam.store.hdf5 import fixed, in_memory, text_of
from vibeam.store.provenance import write_provenance
from vibeam.system.quantities import METRES, OutputUnits
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    import h5py


FORMAT = "vibeam results 4"


@dataclass(frozen=True)
class Requirements:
    """Requirements of a case on its results file.

    ``text``: what decides the numbers of the case, ``key``: of all of it; ``shared``: the part of it common to all
    fidelities; ``units``: of the output; ``whole``: the case as TOML, titles, checks and figures included; ``name`` of
    the case file.
    """

    text: str
    key: str
    shared: str
    branches: Sequence[BranchPlan]
    whole: str
    name: str
    units: OutputUnits = METRES


@dataclass(frozen=True)
class Reuse:
    """Reuse of one branch: ``kept`` of its ``stored`` points stay; ``fits``: its group has the layout needed."""

    branch: BranchPlan
    stored: int
    kept: int
    fits: bool

    def __str__(self) -> str:
        return f"{self.branch.group} ({self.kept} of {len(self.branch.frequency)} points)"


def blank(wanted: Requirements) -> h5py.File:
    """New file in memory: the case, the provenance, every branch with room for all its points."""
    file = in_memory()
    file.attrs["format"] = fixed(FORMAT)
    write_case(file, wanted)
    write_provenance(file.create_group("provenance"))
    for branch in wanted.branches:
        lay_out(file, branch, wanted.units)
    return file


def adapted(file: h5py.File, wanted: Requirements) -> str | None:
    """Adapt the file to ``wanted``: the changes in one line, empty where no number changes, None without any."""
    reuses = _reuses(file, wanted)
    if all(reuse.fits for reuse in reuses) and _says(file, wanted):
        if wanted.whole == case_text(file, "whole"):
            return None
        write_case(file, wanted)  # title, checks and figures, which decide no number of a branch
        return ""
    named = {branch.group for branch in wanted.branches}
    others = [name for name in _groups_with_points(file) if name not in named]
    for reuse in reuses:
        _lay_out_anew(file, reuse, wanted.units)
    for record in (MODELS, COMPARISON, COMPARED.place):  # of the case before
        file.pop(record, None)
    write_case(file, wanted)
    return _reported(reuses, others)


def difference(file: h5py.File, wanted: Requirements) -> str:
    """First difference in physics, if the file has points of another one than ``wanted``; else empty."""
    if case_text(file, "shared") == wanted.shared:
        return ""
    same = {reuse.branch.group for reuse in _reuses(file, wanted) if reuse.kept or not reuse.stored}
    if all(name in same for name in _groups_with_points(file)):
        return ""
    stored, present = _flat(case_text(file, "shared")), _flat(wanted.shared)
    key = next((key for key in {**stored, **present} if stored.get(key) != present.get(key)), "its key")
    there, here = (repr(values.get(key, "nothing")) for values in (stored, present))
    return f"{key} = {there} there, {here} here"


def loses(file: h5py.File, wanted: Requirements) -> bool:
    """Test whether ``adapted`` would lose points."""
    return any(reuse.kept < reuse.stored for reuse in _reuses(file, wanted))


def write_case(file: h5py.File, wanted: Requirements) -> None:
    """Write the case that the file is of, in place of one that is there."""
    file.pop("case", None)
    group = file.create_group("case")
    group.attrs["key"], group.attrs["name"] = fixed(wanted.key), fixed(wanted.name)
    group["text"], group["shared"], group["whole"] = map(fixed, (wanted.text, wanted.shared, wanted.whole))


def case_text(file: h5py.File, name: str) -> str:
    """A text of the case that the file is of: ``"text"``, ``"shared"`` or ``"whole"``, as in ``Requirements``."""
    return str(file["case"][name][()].decode())


def _says(file: h5py.File, wanted: Requirements) -> bool:
    """Test whether the file says of its case what ``wanted`` says."""
    found = (text_of(file["case"], "key"), case_text(file, "text"), case_text(file, "shared"))
    return found == (wanted.key, wanted.text, wanted.shared)


def _reuses(file: h5py.File, wanted: Requirements) -> list[Reuse]:
    return [_reuse_of(file, branch) for branch in wanted.branches]


def _reuse_of(file: h5py.File, branch: BranchPlan) -> Reuse:
    """Reusable part of ``branch``: all points up to the first different frequency, where its key is the same.

    With a carried state every point beyond that frequency changes, and the state to continue from
    must be stored.
    """
    group = file.get(branch.group)
    if group is None:
        return Reuse(branch, 0, 0, fits=False)
    stored, frequency = points_of(group), group["frequency"][()]
    if text_of(group, "key") != branch.key or group["mode_energy"].shape[1:] != (branch.modes,):
        return Reuse(branch, stored, 0, fits=False)
    common = _common(frequency, branch.frequency)
    kept = min(stored, common)
    if kept < stored:
        kept = last_with_state(group, kept)
    return Reuse(branch, stored, kept, common == len(frequency) == len(branch.frequency))


def _common(one: Array, other: Array) -> int:
    """Number of first frequencies equal to the last bit."""
    length = min(len(one), len(other))
    differing = np.flatnonzero(one[:length] != other[:length])
    return int(differing[0]) if len(differing) else length


def _lay_out_anew(file: h5py.File, reuse: Reuse, units: OutputUnits) -> None:
    """Lay out anew a branch that does not fit, with the points that it keeps."""
    if reuse.fits:
        return
    file.pop(f"{reuse.branch.fidelity}/{CURVES}", None)
    name, rows = reuse.branch.group, {}
    if name in file:
        rows = {key: column[: reuse.kept] for key, column in read_rows(file[name]).items()}
        del file[name]
    group = lay_out(file, reuse.branch, units)
    if reuse.kept:
        write_rows(group, 0, rows)


def _groups_with_points(file: h5py.File) -> list[str]:
    """Branches of the file that have points."""
    return [f"{name}/{way}" for name, way in branch_names(file) if points_of(file[name][way])]


def _reported(reuses: Sequence[Reuse], others: Iterable[str]) -> str:
    """One line on kept, added and recomputed branches; ``others``: branches the case does not name."""
    parts = {
        "kept": [reuse.branch.group for reuse in reuses if reuse.fits],
        "extended": [str(reuse) for reuse in reuses if not reuse.fits and reuse.kept == reuse.stored > 0],
        "swept anew": [
            reuse.branch.group + f" (after {reuse.kept} points)" * bool(reuse.kept)
            for reuse in reuses
            if reuse.stored > reuse.kept
        ],
        "added": [reuse.branch.group for reuse in reuses if not reuse.stored and not reuse.fits],
        "left as they are, the case does not name them": list(others),
    }
    return "; ".join(f"{what}: {', '.join(names)}" for what, names in parts.items() if names)


def _flat(text: str) -> Mapping[str, Any]:
    """Values of a case by dotted key, less what is empty."""
    return {key: value for key, value in dotted(tomllib.loads(text)) if value != []}
