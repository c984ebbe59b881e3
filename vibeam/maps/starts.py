"""Starts of a motion: given at the contact, or drawn at random."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from vibeam.maps.points import GridPoints

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Starts:
    """``count`` random starts a point: displacement of the contact within ``spread`` m of 0 and short of the stop,
    velocity within Ω times that; the same for equal seeds, whatever the blocks."""

    count: int
    seed: int
    spread: float


def random_starts(points: GridPoints, first: int, starts: Starts) -> tuple[Array, Array]:
    """Displacement (m) and velocity (m/s) of the contact, (lines, points, starts) each; ``first``: number of the line.

    A pressed stop is short of 0: the displacement is then drawn between −``spread`` and the gap.
    """
    lines, columns = points.omega.shape
    drawn = np.stack(
        [np.random.default_rng([starts.seed, first + line]).random((columns, starts.count, 2)) for line in range(lines)]
    )
    highest = np.clip(points.gap, -starts.spread, starts.spread)[..., None]
    displacement = -starts.spread + (highest + starts.spread) * drawn[..., 0]
    return displacement, starts.spread * points.omega[..., None] * (2 * drawn[..., 1] - 1)


def start_states(points: GridPoints, displacement: Array, velocity: Array) -> Array:
    """States (lines, points, starts, 2n) with that motion of the contact, all of it in the first mode.

    ValueError where that mode does not move the contact, or the systems have different numbers of modes.
    """
    if len({system.size for system in points.systems}) > 1:
        raise ValueError("a start cannot be given to models with different numbers of modes")
    first = np.array([system.contact[0] for system in points.systems])[points.which]
    if not np.all(first):
        raise ValueError("a start moves the first mode alone, and here it does not move the contact")
    n = points.systems[0].size
    state = np.zeros((*displacement.shape, 2 * n))
    state[..., 0], state[..., n] = displacement / first[..., None], velocity / first[..., None]
    return state
