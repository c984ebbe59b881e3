"""What of a results file a case can keep: the branches whose numbers are the same, point by point from the first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.run.store.branch import (
    Branch,
    count_points,
    key_of,
    last_with_state,
    lay_out,
    points_of,
    read_rows,
    write_rows,
)
from vibeam.run.store.checksum import CHECKSUM
from vibeam.system.response import Array

if TYPE_CHECKING:
    import h5py


@dataclass(frozen=True)
class Wanted:
    """What a case wants of its results file.

    ``text``: the case, ``key``: of all of it; ``shared``: the part of it that no fidelity has for itself; ``unit``: of
    the outputs.
    """

    text: str
    key: str
    shared: str
    branches: Sequence[Branch]
    unit: str = "m"


@dataclass(frozen=True)
class Reuse:
    """One branch: of the ``there`` points of the file ``kept`` stay; ``fits``: its group is as the branch needs it."""

    branch: Branch
    there: int
    kept: int
    fits: bool

    @property
    def shrinks(self) -> bool:
        """Whether more points would be lost than the case asks for."""
        return self.kept < self.there and len(self.branch.frequency) < self.there

    def __str__(self) -> str:
        return f"{self.branch.group} ({self.kept} of {len(self.branch.frequency)} points)"


def reuse_of(file: h5py.File, branch: Branch) -> Reuse:
    """What the file keeps of ``branch``: all points up to the first other frequency, where its key is the same.

    A state is carried from point to point: beyond that frequency every point would be another, and where the sweep goes
    on the state must be there.
    """
    group = file.get(branch.group)
    if group is None:
        return Reuse(branch, 0, 0, fits=False)
    there, frequency = points_of(group), group["frequency"][()]
    if key_of(group) != branch.key or group["mode_energy"].shape[1:] != (branch.modes,):
        return Reuse(branch, there, 0, fits=False)
    common = _common(frequency, branch.frequency)
    kept = min(there, common)
    if kept < there and branch.carried:
        kept = last_with_state(group, kept)
    return Reuse(branch, there, kept, common == len(frequency) == len(branch.frequency))


def adapt(file: h5py.File, reuses: Iterable[Reuse], unit: str) -> None:
    """Lay out anew the branches that do not fit, with the points that they keep."""
    for reuse in reuses:
        if reuse.fits:
            continue
        name, values = reuse.branch.group, None
        if name in file:
            values = {key: column[: reuse.kept] for key, column in read_rows(file[name]).items()}
            del file[name]
            file[reuse.branch.fidelity].attrs.pop(CHECKSUM, None)  # what is beside the branch no longer fits it
        group = lay_out(file, reuse.branch, unit)
        if values is not None and reuse.kept:
            write_rows(group, 0, values)
            count_points(group, reuse.kept)


def lost_with(file: h5py.File, reuses: Sequence[Reuse]) -> bool:
    """Whether a branch of the file with points has no place in another physics, or keeps none there."""
    same = {reuse.branch.group for reuse in reuses if reuse.kept or not reuse.there}
    return any(name not in same for name in groups_with_points(file))


def groups_with_points(file: h5py.File) -> list[str]:
    """The branches of the file that have points."""
    return [f"{fidelity}/{way}" for fidelity, way in branch_names(file) if points_of(file[fidelity][way])]


def branch_names(file: h5py.File) -> list[tuple[str, str]]:
    """Fidelity and direction of every branch of the file, up before down."""
    ways = ((fidelity, way) for fidelity in file for way in sorted(file[fidelity], reverse=True))
    return [(fidelity, way) for fidelity, way in ways if "done" in file[fidelity][way].attrs]


def said(reuses: Sequence[Reuse], others: Iterable[str]) -> str:
    """One line on what stays, what is added and what is swept anew; ``others``: branches the case does not name."""
    parts = {
        "kept": [reuse.branch.group for reuse in reuses if reuse.fits],
        "extended": [str(reuse) for reuse in reuses if not reuse.fits and reuse.kept == reuse.there > 0],
        "swept anew": [_anew(reuse) for reuse in reuses if reuse.there > reuse.kept],
        "added": [reuse.branch.group for reuse in reuses if not reuse.there and not reuse.fits],
        "left as they are, the case does not name them": list(others),
    }
    return "; ".join(f"{what}: {', '.join(names)}" for what, names in parts.items() if names)


def _anew(reuse: Reuse) -> str:
    return f"{reuse.branch.group} (after {reuse.kept} points)" if reuse.kept else reuse.branch.group


def _common(one: Array, other: Array) -> int:
    """How many first frequencies are the same to the last bit."""
    length = min(len(one), len(other))
    differing = np.flatnonzero(one[:length] != other[:length])
    return int(differing[0]) if len(differing) else length
