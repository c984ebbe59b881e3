"""One branch in the file: its points, how many are there, and the state after the last of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.response import Array, FrequencyResponse
from vibeam.state import State
from vibeam.store.layout import LAYOUT

if TYPE_CHECKING:
    import h5py


@dataclass(frozen=True)
class Branch:
    """What one group of the file is for: a fidelity swept one way over ``frequency`` (Hz, in the order swept)."""

    fidelity: str
    direction: str
    frequency: Array
    modes: int

    @property
    def group(self) -> str:
        """The group's path in the file."""
        return f"{self.fidelity}/{self.direction}"


@dataclass(frozen=True)
class Kept:
    """What a file holds of a branch: ``done`` points of ``response`` and the state after the last of them."""

    response: FrequencyResponse
    done: int
    state: State | None


def read_branch(group: h5py.Group, branch: Branch) -> Kept:
    """What is there of ``branch``; ValueError where it is not as it was laid out."""
    response, done = read_response(group), int(group.attrs["done"])
    expected = (len(branch.frequency), branch.modes)
    if response.mode_energy.shape != expected or not 0 <= done <= expected[0]:
        raise ValueError(f"{response.mode_energy.shape} points and modes with {done} done, not {expected}")
    if not np.array_equal(response.frequency, branch.frequency):
        raise ValueError("other frequencies than the case's")
    return Kept(response, done, _state(group, done - 1) if done else None)


def read_response(group: h5py.Group) -> FrequencyResponse:
    """The values of all points, those not run too."""
    return FrequencyResponse(**{name: group[name][()] for name in LAYOUT})


def write_points(group: h5py.Group, start: int, block: FrequencyResponse, state: State) -> None:
    """Put ``block`` at the points from ``start`` on, and the state after its last point.

    In two steps, the values and then the count of points that are there, each flushed: a run that is killed between
    the two leaves points that nobody counts, and the next run writes them again.
    """
    stop = start + len(block)
    for name in LAYOUT:
        if name != "frequency":
            group[name][start:stop] = getattr(block, name)
    group["state_displacement"][stop - 1] = state.displacement
    group["state_velocity"][stop - 1] = state.velocity
    group["state_resting"][stop - 1] = int(state.resting)
    group.file.flush()
    group.attrs.modify("done", np.int64(stop))  # in place: an attribute made anew could be lost half-way
    group.file.flush()


def _state(group: h5py.Group, point: int) -> State:
    displacement, velocity = group["state_displacement"][point], group["state_velocity"][point]
    return State.reached(displacement, velocity, resting=bool(group["state_resting"][point]))
