"""Branches in the results file: their layout, their points, and the blocks of points that are not gathered yet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.store.blocks import Values, read_block, write_block
from vibeam.store.hdf5 import describe_codes, described, fixed, scale, text_of
from vibeam.system.quantities import LAYOUT, DatasetQuantity, OutputUnits, unit_of
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam.system.state import State, StatesAfter
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    import h5py


STATES: Mapping[str, DatasetQuantity] = {
    "state_displacement": DatasetQuantity("modal displacement η at the end of the point", "1", "mode"),
    "state_velocity": DatasetQuantity("modal velocity η̇ at the end of the point", "1", "mode"),
    "state_resting": DatasetQuantity("in lasting contact with the stop at the end of the point (1: yes)", "1"),
}
ROWS = (*LAYOUT, *STATES)
#: mass-normalised modal coordinates: displacement in √kg m where the outputs are in m
MODAL_UNITS = {"m": ("kg(1/2) m", "kg(1/2) m s-1"), "1": ("1", "s-1")}


@dataclass(frozen=True)
class BranchPlan:
    """Identity of a group in the file: a fidelity swept in one direction over ``frequency`` (Hz, in the order swept).

    ``key``: of all else that decides its numbers.
    """

    fidelity: str
    direction: str
    frequency: Array
    modes: int
    key: str = ""

    @property
    def group(self) -> str:
        """Path of the group in the file."""
        return f"{self.fidelity}/{self.direction}"


@dataclass(frozen=True)
class StoredBranch:
    """Stored part of a branch: ``done`` points of ``response``, the state after the last of them, all states known."""

    response: FrequencyResponse
    done: int
    state: State | None
    after: StatesAfter


def branch_names(file: h5py.File) -> list[tuple[str, str]]:
    """Fidelity and direction of every branch of the file, up before down."""
    pairs = ((fidelity, direction) for fidelity in file for direction in sorted(file[fidelity], reverse=True))
    return [(fidelity, direction) for fidelity, direction in pairs if "done" in file[fidelity][direction].attrs]


def lay_out(file: h5py.File, branch: BranchPlan, units: OutputUnits) -> h5py.Group:
    """Create the group of ``branch``, all its points not run yet; ``units``: of the output."""
    group, points, modes = file.create_group(branch.group), len(branch.frequency), branch.modes
    blank = FrequencyResponse.empty(branch.frequency, modes)
    scale(group, "impact", np.arange(1, VELOCITIES_KEPT + 1), "impact number", "1")
    scale(group, "mode", np.arange(1, modes + 1), "mode number", "1")
    for name, quantity in LAYOUT.items():
        write_quantity(group, name, quantity, getattr(blank, name), unit_of(quantity, units))
    rows = np.full((points, modes), np.nan)
    blanks: tuple[NDArray[Any], ...] = (rows, rows, np.zeros(points, dtype=np.int64))
    for (name, quantity), values, unit in zip(STATES.items(), blanks, (*MODAL_UNITS[units.length], "1"), strict=True):
        write_quantity(group, name, quantity, values, unit)
    describe_codes(group["ended"], Ended)
    group.attrs["done"] = np.int64(0)
    group.attrs["key"] = fixed(branch.key)
    return group


def write_quantity(group: h5py.Group, name: str, quantity: DatasetQuantity, values: Any, unit: str) -> None:
    """Write a quantity over ``frequency``, the scale among them, and over its own dimension where it has one."""
    if name == "frequency":
        scale(group, name, values, quantity.long_name, unit)
    else:
        scales = ("frequency", *([quantity.dimension] if quantity.dimension else []))
        described(group, name, values, quantity.long_name, unit, *(group[each] for each in scales))


def read_branch(group: h5py.Group, branch: BranchPlan) -> StoredBranch:
    """Read the stored part of ``branch``; ValueError where the state after its last point is not finite."""
    values, done = read_rows(group), points_of(group)
    state = state_after(values, done - 1) if done else None
    if done and state is None:
        raise ValueError(f"the state after its point {done} is not finite")
    return StoredBranch(
        response_of(values), done, state, StatesAfter(values["state_displacement"], values["state_velocity"])
    )


def response_of(values: Values) -> FrequencyResponse:
    """Response of the columns of a branch."""
    return FrequencyResponse(**{name: values[name] for name in LAYOUT})


def read_rows(group: h5py.Group) -> Values:
    """Read all columns by name, points not run included."""
    return {name: group[name][()] for name in ROWS}


def points_of(group: h5py.Group) -> int:
    """Number of points that were run."""
    return int(group.attrs["done"])


def last_with_state(group: h5py.Group, points: int) -> int:
    """Largest number of the first ``points`` after which a state is stored to resume from."""
    known = np.all([np.isfinite(group[name][:points]).all(axis=1) for name in list(STATES)[:2]], axis=0)
    return int(np.flatnonzero(known)[-1]) + 1 if known.any() else 0


def rows_of(block: FrequencyResponse, states: Sequence[State]) -> Values:
    """Columns of ``block`` with the ``states`` after its last points, as many as are known."""
    displacement, velocity = np.full((2, *block.mode_energy.shape), np.nan)
    resting = np.zeros(len(block), dtype=np.int64)
    for at, state in enumerate(states, len(block) - len(states)):
        displacement[at], velocity[at], resting[at] = state.displacement, state.velocity, int(state.resting)
    after = dict(zip(STATES, (displacement, velocity, resting), strict=True))
    return {name: getattr(block, name) for name in LAYOUT} | after


def write_rows(group: h5py.Group, start: int, values: Mapping[str, NDArray[Any]]) -> None:
    """Write the columns at the points from ``start`` on, and count them; the grid's own frequencies stay."""
    stop = start + len(values["frequency"])
    for name in ROWS:
        if name != "frequency":
            group[name][start:stop] = values[name]
    group.attrs.modify("done", np.int64(stop))


def keep_block(path: Path, folder: Path, group: h5py.Group, start: int, values: Values) -> None:
    """Keep the points of a branch from ``start`` on as a block; StoreError, naming ``path``, where the disk fails."""
    write_block(path, _file(folder, group, start), _identity(group, start), values)


def join_blocks(file: h5py.File, folder: Path) -> int:
    """Put the blocks in ``folder`` that go on from the branches of the file into it, and say how many there are."""
    return sum(1 for fidelity, way in branch_names(file) for _ in _joined(file[fidelity][way], folder))


def _joined(group: h5py.Group, folder: Path) -> Iterator[int]:
    """Points of a branch after each of its blocks: one that is damaged or of another branch is not there."""
    while (block := _next_block(group, folder)) is not None:
        write_rows(group, points_of(group), block)
        yield points_of(group)


def _next_block(group: h5py.Group, folder: Path) -> Values | None:
    start = points_of(group)
    return read_block(_file(folder, group, start), _identity(group, start)) if folder.exists() else None


def _file(folder: Path, group: h5py.Group, start: int) -> Path:
    return folder / f"{group.name.strip('/').replace('/', '-')}-{start:09d}.npz"


def _identity(group: h5py.Group, start: int) -> str:
    grid = sha256(group["frequency"][()].tobytes()).hexdigest()
    return f"{group.name} {text_of(group, 'key')} {grid} {group['mode_energy'].shape[1]} {start}"


def state_after(values: Values, point: int) -> State | None:
    """State at the end of a point; None where it is not known."""
    displacement, velocity, resting = (values[name][point] for name in STATES)
    known = np.all(np.isfinite([displacement, velocity]))
    return State(displacement, velocity, bool(resting)) if known else None
