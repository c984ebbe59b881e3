"""Explanation of measured points at given keys: by a motion of the closed-form family, or another of the model's.

The family has, at each point, the two roots of the closed-form orbit and the motion without contact. One that passes
through the stop between its impacts, or is not stable, is no motion. Where none of the family is near to a point the
model is flown there, upward and downward: what it does may be outside the family (several impacts until it repeats,
another period, rest on the stop, no repeat), and lie nearer. Then the point is left out of the misfit, by name, since
its derivatives by the keys are not known; what it is off still counts wherever two sets of keys are compared, so that
no set is the better for leaving points out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vibeam.periodic.bifurcation_functions import clearances
from vibeam.periodic.bifurcation_functions import motions as motions_at
from vibeam.periodic.orbit_curve import stability
from vibeam.periodic.tangents import ModalData
from vibeam.studies.fit.flown import OtherMotion, other_motions
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import IMPOSSIBLE, LEFT, NO_CONTACT, Problem, robust, value_of
from vibeam.studies.fit.surface import ModalSurface
from vibeam_models.arrays import Array, Flags, Index

ROOTS = (0, 1)  # of the quadratic
FURTHEST = 1.0  # ln(B*/B) up to which the drive beyond the fold is taken
FAR = 4.0  # residual from which on another motion is looked for
HANDICAP = 9.0  # of a motion that does not exist at this drive against one that does, in squared residuals


@dataclass(frozen=True)
class Explanation:
    """Motion of each point (``LEFT``: out of the family), whether the model has it, squared residuals (points,).

    ``others``: the motion of each point that is left out.
    """

    chosen: Index
    actual: Flags
    cost: Array
    others: dict[int, OtherMotion]

    @property
    def loss(self) -> float:
        """Sum of Cauchy's loss over all points, those left out included."""
        return robust(self.cost)


def costs(problem: Problem, value: Array, beyond: Array, factor: float = 1.0) -> Array:
    """Squared residuals (3, points) of all motions, of the measured values times a ``factor``."""
    off = (value / factor - problem.measured) / problem.uncertainty
    cost = off**2 + (beyond * problem.hardness) ** 2
    return np.where(np.isfinite(cost), cost, 1e300)


def nearest(problem: Problem, x: Array) -> tuple[Index, float]:
    """Motion of each point that is nearest to it, whether the model has it or not, and the loss."""
    try:
        value, beyond = problem.motions(x)
    except ValueError:
        return np.zeros(problem.count, dtype=np.int64), IMPOSSIBLE
    cost = costs(problem, value, beyond)
    return _unfolded(problem, x, beyond, np.argmin(cost, axis=0)), robust(cost.min(axis=0))


def explained(problem: Problem, x: Array, dropped: tuple[int, ...] = ()) -> Explanation:
    """Explanation of every point at shares ``x``: the motion that it is least off from; ``dropped`` are left out."""
    value, beyond = problem.motions(x)
    cost, allowed = costs(problem, value, beyond), actual(problem, x, beyond)
    asked = np.where(allowed, cost, np.where(beyond > 0, cost + HANDICAP, np.inf))
    asked = np.where(np.isinf(asked).all(axis=0), cost + HANDICAP, asked)
    chosen = _unfolded(problem, x, beyond, np.argmin(asked, axis=0))
    at = np.arange(problem.count)
    found, real, others = cost[chosen, at], allowed[chosen, at], {}
    for j, motions in other_motions(problem, x, np.flatnonzero(~real | (found > FAR**2))).items():
        other = min(motions, key=lambda each: each.cost)
        if other.cost < asked[chosen[j], j] and not problem.unstable[j]:
            chosen[j], found[j], others[j] = LEFT, other.cost, other
    chosen[list(dropped)] = LEFT
    others = {j: each for j, each in others.items() if j not in dropped}
    return Explanation(chosen, real & (chosen != LEFT), found, others)


def actual(problem: Problem, x: Array, beyond: Array) -> Flags:
    """Motions (3, points) that the model has; ``beyond`` of ``Problem.motions``."""
    found = np.zeros(beyond.shape, dtype=bool)
    found[NO_CONTACT] = beyond[NO_CONTACT] == 0
    systems = {name: each.system(problem.values(x)) for name, each in problem.forward.items()}
    for group, at, own in problem.parts():
        system, drive = systems[group.fidelity], problem.surfaces[group.fidelity].at(x).drive[own]
        points = motions_at(system, group.periods, group.omega, drive, np.full(len(group), system.gap))
        clear = np.stack([clearances(system, points, root) > 0 for root in ROOTS], axis=1)
        clear &= points.roots.impulse < 0
        held = clear if group.unstable else stability(system, points.total, points.roots, clear)
        found[:2, at] = held.T & (beyond[:2, at] == 0)
    return found


def _unfolded(problem: Problem, x: Array, beyond: Array, chosen: Index) -> Index:
    """The same choice, with the branch of controlled points beyond a fold told by the fold's other side.

    Beyond a fold both roots have the value of the fold, so that the distance to it does not tell on which of the two
    branches a point was measured. The branches near the fold do: with the fold at the drive B*, both roots exist at the
    drive B*²/B on its other side, and a point that may lie on either takes the nearer of these. Without this a point of
    the lower branch would stay with the upper one while the fold is moved past it, which is another minimum.
    """
    found = chosen.copy()
    for group, at, own in problem.parts():
        lost = (beyond[:2, at] > 0).all(axis=0) & (chosen[at] != NO_CONTACT) & group.unstable
        if lost.any():
            surface = problem.surfaces[group.fidelity]
            data = _mirrored(surface.at(x).driven(own), beyond[0, at])
            found[at[lost]] = _nearer_root(group, data, surface)[lost]
    return found


def _mirrored(data: ModalData, beyond: Array) -> ModalData:
    """The drive as far above the fold's, by its logarithm, as it is below."""
    return replace(data, drive=data.drive * np.exp(2 * np.clip(np.nan_to_num(beyond), 0.0, FURTHEST)))


def _nearer_root(group: Points, data: ModalData, surface: ModalSurface) -> Index:
    both = np.stack([value_of(group, data, surface.still(len(group)), root).value for root in ROOTS])
    return np.asarray(np.argmin(np.nan_to_num(np.abs(both - group.value), nan=np.inf), axis=0))
