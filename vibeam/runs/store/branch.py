"""One branch in the file: its points, their number, and the state after the last of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.runs.store.checksum import CHECKSUM, of_rows
from vibeam.runs.store.layout import STATES, fixed, write_branch
from vibeam.system.quantities import LAYOUT, OutputUnits
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State, StatesAfter
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    import h5py


Values = Mapping[str, NDArray[Any]]
ROWS = (*LAYOUT, *STATES)


@dataclass(frozen=True)
class Branch:
    """Identity of a group in the file: a fidelity swept in one direction over ``frequency`` (Hz, in the order swept).

    ``key``: of all else that decides its numbers. ``carried``: whether a state is carried from point to point.
    """

    fidelity: str
    direction: str
    frequency: Array
    modes: int
    key: str = ""
    carried: bool = True

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


def lay_out(parent: h5py.Group, branch: Branch, units: OutputUnits) -> h5py.Group:
    """Create the group of ``branch``, without points; ``units``: of the output."""
    group = parent.create_group(branch.group)
    write_branch(group, branch.frequency, branch.modes, units)
    group.attrs["key"] = fixed(branch.key or " ")
    return group


def read_branch(group: h5py.Group, branch: Branch) -> StoredBranch:
    """Read the stored part of ``branch``; ValueError where it is not as it was laid out and written."""
    values, done = read_rows(group), points_of(group)
    if values["mode_energy"].shape != (len(branch.frequency), branch.modes):
        raise ValueError(f"{values['mode_energy'].shape} points and modes, not those of the case")
    if not np.array_equal(values["frequency"], branch.frequency):
        raise ValueError("other frequencies than the case's")
    response = FrequencyResponse(**{name: values[name] for name in LAYOUT})
    after = StatesAfter(values["state_displacement"], values["state_velocity"])
    return StoredBranch(response, done, _state(values, done - 1) if done and branch.carried else None, after)


def read_rows(group: h5py.Group) -> Values:
    """Read all columns by name, points not run included; ValueError where a point that was run fails its checksum."""
    values, done = {name: group[name][()] for name in ROWS}, points_of(group)
    wrong = np.flatnonzero(_checksums(group, values, slice(done)) != group[CHECKSUM][:done])
    if len(wrong):
        raise ValueError(f"the checksum of its point {wrong[0] + 1} does not fit")
    return values


def points_of(group: h5py.Group) -> int:
    """Number of points in the group; ValueError for an impossible number."""
    done, points = int(group.attrs["done"]), len(group["frequency"])
    if not 0 <= done <= points:
        raise ValueError(f"{done} of {points} points done")
    return done


def last_with_state(group: h5py.Group, points: int) -> int:
    """Largest number of the first ``points`` after which a state is stored to resume from."""
    known = np.all([np.isfinite(group[name][:points]).all(axis=1) for name in list(STATES)[:2]], axis=0)
    return int(np.flatnonzero(known)[-1]) + 1 if known.any() else 0


def key_of(group: h5py.Group) -> str:
    """Key of the branch stored in a group."""
    return str(group.attrs["key"].decode())


def write_rows(group: h5py.Group, start: int, values: Values) -> None:
    """Write the ``values`` of all columns at the points from ``start`` on, and their checksums."""
    points = slice(start, start + len(values["frequency"]))
    datasets = {name: group[name] for name in ROWS}
    grid = datasets.pop("frequency")[points]  # the grid's own value, to the last bit
    stored = {"frequency": grid} | {name: np.asarray(values[name], each.dtype) for name, each in datasets.items()}
    for name, dataset in datasets.items():
        dataset[points] = stored[name]
    group[CHECKSUM][points] = _checksums(group, stored, slice(None))


def count_points(group: h5py.Group, done: int) -> None:
    """Store the number of points, in place: a new attribute would move."""
    group.attrs.modify("done", np.int64(done))


def rows_of(block: FrequencyResponse, states: Sequence[State]) -> Values:
    """Columns of ``block`` with the ``states`` after its last points, as many as are known."""
    displacement, velocity = np.full((2, *block.mode_energy.shape), np.nan)
    resting = np.zeros(len(block), dtype=np.int64)
    for at, state in enumerate(states, len(block) - len(states)):
        displacement[at], velocity[at], resting[at] = state.displacement, state.velocity, int(state.resting)
    after = dict(zip(STATES, (displacement, velocity, resting), strict=True))
    return {name: getattr(block, name) for name in LAYOUT} | after


def _checksums(group: h5py.Group, values: Values, points: slice) -> NDArray[np.uint32]:
    return of_rows([values[name][points] for name in ROWS], f"{group.name} {key_of(group)}")


def _state(values: Values, point: int) -> State:
    displacement, velocity, resting = (values[name][point] for name in STATES)
    if not np.all(np.isfinite([displacement, velocity])):
        raise ValueError(f"the state after its point {point + 1} is not finite")
    return State(displacement, velocity, bool(resting))
