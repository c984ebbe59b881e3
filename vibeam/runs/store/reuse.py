"""Reuse of a results file: the branches with the same numbers, point by point from the first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.runs.store.branch import (
    Branch,
    count_points,
    key_of,
    last_with_state,
    lay_out,
    points_of,
    read_rows,
    write_rows,
)
from vibeam.runs.store.checksum import CHECKSUM
from vibeam.system.quantities import METRES, OutputUnits
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    import h5py


@dataclass(frozen=True)
class Wanted:
    """Requirements of a case on its results file.

    ``text``: what decides the numbers of the case, ``key``: of all of it; ``shared``: the part of it common to all
    fidelities; ``units``: of the output; ``whole``: the case as TOML, titles, checks and figures included.
    """

    text: str
    key: str
    shared: str
    branches: Sequence[Branch]
    units: OutputUnits = METRES
    whole: str = ""


@dataclass(frozen=True)
class Reuse:
    """Reuse of one branch: ``kept`` of its ``stored`` points stay; ``fits``: its group has the layout needed."""

    branch: Branch
    stored: int
    kept: int
    fits: bool

    @property
    def shrinks(self) -> bool:
        """True where more points would be lost than the case asks for."""
        return self.kept < self.stored and len(self.branch.frequency) < self.stored

    def __str__(self) -> str:
        return f"{self.branch.group} ({self.kept} of {len(self.branch.frequency)} points)"


def reuse_of(file: h5py.File, branch: Branch) -> Reuse:
    """Reusable part of ``branch``: all points up to the first different frequency, where its key is the same.

    With a carried state every point beyond that frequency changes, and the state to continue from
    must be stored.
    """
    group = file.get(branch.group)
    if group is None:
        return Reuse(branch, 0, 0, fits=False)
    stored, frequency = points_of(group), group["frequency"][()]
    if key_of(group) != branch.key or group["mode_energy"].shape[1:] != (branch.modes,):
        return Reuse(branch, stored, 0, fits=False)
    common = _common(frequency, branch.frequency)
    kept = min(stored, common)
    if kept < stored and branch.carried:
        kept = last_with_state(group, kept)
    return Reuse(branch, stored, kept, common == len(frequency) == len(branch.frequency))


def adapt(file: h5py.File, reuses: Iterable[Reuse], units: OutputUnits) -> None:
    """Lay out anew the branches that do not fit, with the points that they keep."""
    for reuse in reuses:
        if reuse.fits:
            continue
        name, values = reuse.branch.group, None
        if name in file:
            values = {key: column[: reuse.kept] for key, column in read_rows(file[name]).items()}
            del file[name]
            file[reuse.branch.fidelity].attrs.pop(CHECKSUM, None)  # data beside the branch no longer fit it
        group = lay_out(file, reuse.branch, units)
        if values is not None and reuse.kept:
            write_rows(group, 0, values)
            count_points(group, reuse.kept)


def lost_with(file: h5py.File, reuses: Sequence[Reuse]) -> bool:
    """Test whether a stored branch with points would lose them to a change of physics."""
    same = {reuse.branch.group for reuse in reuses if reuse.kept or not reuse.stored}
    return any(name not in same for name in groups_with_points(file))


def groups_with_points(file: h5py.File) -> list[str]:
    """Branches of the file that have points."""
    return [
        f"{fidelity}/{direction}" for fidelity, direction in branch_names(file) if points_of(file[fidelity][direction])
    ]


def branch_names(file: h5py.File) -> list[tuple[str, str]]:
    """Fidelity and direction of every branch of the file, up before down."""
    pairs = ((fidelity, direction) for fidelity in file for direction in sorted(file[fidelity], reverse=True))
    return [(fidelity, direction) for fidelity, direction in pairs if "done" in file[fidelity][direction].attrs]


def reported(reuses: Sequence[Reuse], others: Iterable[str]) -> str:
    """One line on kept, added and recomputed branches; ``others``: branches the case does not name."""
    parts = {
        "kept": [reuse.branch.group for reuse in reuses if reuse.fits],
        "extended": [str(reuse) for reuse in reuses if not reuse.fits and reuse.kept == reuse.stored > 0],
        "swept anew": [_anew(reuse) for reuse in reuses if reuse.stored > reuse.kept],
        "added": [reuse.branch.group for reuse in reuses if not reuse.stored and not reuse.fits],
        "left as they are, the case does not name them": list(others),
    }
    return "; ".join(f"{what}: {', '.join(names)}" for what, names in parts.items() if names)


def _anew(reuse: Reuse) -> str:
    return f"{reuse.branch.group} (after {reuse.kept} points)" if reuse.kept else reuse.branch.group


def _common(one: Array, other: Array) -> int:
    """Number of first frequencies equal to the last bit."""
    length = min(len(one), len(other))
    differing = np.flatnonzero(one[:length] != other[:length])
    return int(differing[0]) if len(differing) else length
