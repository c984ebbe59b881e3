"""Assignment of measured points to motions: the nearest one, or the nearest that the model actually has.

Beyond a fold both roots have the value of the fold, so that the distance to it does not tell on which of the two
branches a point was measured. The branches near the fold do: with the fold at the drive B*, both roots exist at the
drive B*²/B on its other side, and a point that may lie on either takes the nearer of these. Without this a point of the
lower branch would stay with the upper one while the fold is moved past it, which is another minimum of the misfit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vibeam.orbits.tangents import ModalData, Tangents
from vibeam.studies.fit.motions import actual
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import IMPOSSIBLE, NO_CONTACT, Index, Problem, value_of

Array = NDArray[np.float64]

ROOTS = (0, 1)  # of the quadratic

FURTHEST = 1.0  # ln(B*/B) up to which the drive beyond the fold is taken


def costs(problem: Problem, value: Array, beyond: Array) -> Array:
    """Squared residuals (3, points) of all motions."""
    off = (value - problem.measured) / problem.uncertainty
    cost = off**2 + (beyond * problem.hardness) ** 2
    return np.where(np.isfinite(cost), cost, 1e300)


def nearest(problem: Problem, x: Array) -> tuple[Index, float]:
    """Motion of each point that is nearest to it, whether admissible and stable or not, and the sum of squares."""
    try:
        value, beyond = problem.motions(x)
    except ValueError:
        return np.zeros(problem.count, dtype=np.int64), IMPOSSIBLE**2
    cost = costs(problem, value, beyond)
    return unfolded(problem, x, beyond, np.argmin(cost, axis=0)), float(cost.min(axis=0).sum())


def nearest_actual(problem: Problem, x: Array) -> tuple[Index, NDArray[np.bool_]]:
    """For each point the nearest actual motion, or the nearest one at all; and whether it is actual."""
    value, beyond = problem.motions(x)
    cost, allowed = costs(problem, value, beyond), actual(problem, x, beyond)
    chosen = np.argmin(np.where(allowed.any(axis=0) & ~allowed, np.inf, cost), axis=0)
    chosen = unfolded(problem, x, beyond, chosen)
    return chosen, allowed[chosen, np.arange(problem.count)]


def unfolded(problem: Problem, x: Array, beyond: Array, chosen: Index) -> Index:
    """The same choice, with the branch of the points beyond a fold told by the fold's other side."""
    found, first = chosen.copy(), 0
    for group in problem.groups:
        at = first + np.arange(len(group))
        lost = (beyond[:2, at] > 0).all(axis=0) & (chosen[at] != NO_CONTACT) & group.unstable
        if lost.any():
            data, still = problem.still(group, x)
            found[at[lost]] = _nearer_root(group, _mirrored(data, beyond[0, at]), still)[lost]
        first += len(group)
    return found


def _mirrored(data: ModalData, beyond: Array) -> ModalData:
    """The drive as far above the fold's, by its logarithm, as it is below."""
    return replace(data, drive=data.drive * np.exp(2 * np.clip(np.nan_to_num(beyond), 0.0, FURTHEST)))


def _nearer_root(group: Points, data: ModalData, still: Tangents) -> Index:
    both = np.stack([value_of(group, data, still, root).value for root in ROOTS])
    return np.asarray(np.argmin(np.nan_to_num(np.abs(both - group.value), nan=np.inf), axis=0))
