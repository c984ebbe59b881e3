"""State passed from one computation to the next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam_models.arguments import read_only
from vibeam_models.arrays import Array, ValueRecord


@dataclass(frozen=True, eq=False, repr=False)
class State(ValueRecord):
    """Modal displacement and velocity (n,) of an ImpactSystem; ``resting``: in lasting contact with the stop.

    The drive's phase is not part of it: a computation says at which time it starts. Both may be lists; they are kept
    as read-only arrays. ValueError where they are not as many finite numbers each.

    >>> import vibeam
    >>> vibeam.State([-1.0, 0.0], [0.0, 0.5]) == vibeam.State([-1, 0], [0, 0.5])
    True
    """

    displacement: Array
    velocity: Array
    resting: bool = False

    def __post_init__(self) -> None:
        displacement, velocity = read_only(self.displacement), read_only(self.velocity)
        if displacement is None or velocity is None or not _fit(displacement, velocity):
            raise ValueError("state: displacement and velocity must be as many finite numbers each, one a mode")
        if not isinstance(self.resting, bool | np.bool_):
            raise ValueError(f"state: resting must be True or False, not {self.resting!r}")
        _set(self, displacement, velocity, bool(self.resting))

    @classmethod
    def reached(cls, displacement: Array, velocity: Array, resting: bool = False) -> State:
        """State at the end of a computation, not validated: an overflowed one is not finite."""
        state = object.__new__(cls)
        _set(state, displacement, velocity, resting)
        return state


@dataclass(frozen=True, eq=False)
class StatesAfter:
    """States after the points of a branch: ``displacement``, ``velocity`` (points, n), NaN where unknown."""

    displacement: Array
    velocity: Array

    @classmethod
    def unknown(cls, points: int, modes: int) -> StatesAfter:
        """No state known yet."""
        return cls(np.full((points, modes), np.nan), np.full((points, modes), np.nan))

    def at(self, point: int) -> State | None:
        """State after one point; None where it is unknown."""
        both = self.displacement[point], self.velocity[point]
        return State(*both) if np.all(np.isfinite(both)) else None


def _fit(displacement: Array, velocity: Array) -> bool:
    if displacement.ndim != 1 or not displacement.size or displacement.shape != velocity.shape:
        return False
    return bool(np.isfinite(displacement).all() and np.isfinite(velocity).all())


def _set(state: State, *values: Any) -> None:
    state.__dict__.update(zip(("displacement", "velocity", "resting"), values, strict=True))
