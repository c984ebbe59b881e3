"""Explanation of measured points at given keys: by a motion of the closed-form family, or one that the model flies.

Points outside the closed-form family have no exact derivatives here; where their motion repeats alike at neighbouring
keys it has a difference quotient. It steers the keys while points are explained, and takes no part in the estimate.

The family has, at each point, the two roots of the closed-form orbit and the motion without contact. One that passes
through the stop between its impacts, or is not stable, is no motion. Where none of the family is near to a point the
model is flown there, upward and downward: what it does may be outside the family (several impacts until it repeats,
another period, rest on the stop, no repeat), and lie nearer. Then the point is left out of the misfit, by name, since
its derivatives by the keys are not known; what it is off still counts wherever two sets of keys are compared, so that
no set is the better for leaving points out.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.batches.batch import batch
from vibeam.periodic.bifurcation_functions import clearances
from vibeam.periodic.bifurcation_functions import motions as motions_at
from vibeam.periodic.orbit_curve import stability
from vibeam.periodic.tangents import ModalData
from vibeam.runs.sweep import sweep
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import IMPOSSIBLE, LEFT, NO_CONTACT, Problem, robust, value_of
from vibeam.studies.fit.surface import ModalSurface
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.quantities import Ended
from vibeam.system.response import Branches, FrequencyResponse
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, Flags, Index

if TYPE_CHECKING:
    from vibeam.batches.response import BatchResponse

SETTLE, HOLD = 300, 32  # drive periods
UNTOLD = 9.0  # least squared residual of a motion that does not repeat, whose value is that of no one record
VARIES = 0.1  # share by which records of such a motion are taken to differ


@dataclass(frozen=True)
class OtherMotion:
    """Motion outside the family: ``period`` drive periods until it repeats (0: not within 16), ``impacts`` in these.

    ``rest``: share of the time at rest on the stop. ``value``: of the reference's quantity, SI; NaN where it is not
    comparable. ``cost``: squared residual of the measured point.
    """

    period: int
    impacts: int
    rest: float
    value: float
    cost: float

    @property
    def called(self) -> str:
        """The motion in words."""
        if self.rest > 0:
            return "rests on the stop in every period"
        if self.period == 0:
            return "does not repeat within 16 periods"
        span = "a period" if self.period == 1 else f"in {self.period} periods"
        return f"has {counted(self.impacts, 'impact')} {span}"


def other_motions(problem: Problem, x: Array, which: Index) -> dict[int, list[OtherMotion]]:
    """Motions outside the family at the points ``which``, flown upward and downward from their neighbours on."""
    found: dict[int, list[OtherMotion]] = {}
    for group, at, own in problem.parts():
        asked = np.flatnonzero(np.isin(at, which))
        if not len(asked) or group.unstable:
            continue
        forward = problem.forward[group.fidelity]
        drive = problem.surfaces[group.fidelity].at(x).drive[own]
        frequency, first = np.unique(group.frequency, return_index=True)
        near = _with_neighbours(np.searchsorted(frequency, group.frequency[asked]), len(frequency))
        system = forward.system(problem.values(x))
        branches = sweep(
            system, omega=2 * np.pi * frequency[near], amplitude=drive[first[near]], settle=SETTLE, hold=HOLD,
            direction="both", output=forward.output,
        )  # fmt: skip
        assert isinstance(branches, Branches)
        for _, flown in branches.items():
            for j in asked.tolist():
                k = int(np.argmin(np.abs(flown.frequency - group.frequency[j])))
                found.setdefault(int(at[j]), []).extend(_outside(group, j, flown, k))
    return {j: each for j, each in found.items() if each}


def _with_neighbours(places: Index, count: int) -> Index:
    """Places and those beside them, ascending."""
    every = np.unique(np.concatenate([places - 1, places, places + 1]))
    return every[(every >= 0) & (every < count)]


def _outside(group: Points, j: int, flown: FrequencyResponse, k: int) -> Iterator[OtherMotion]:
    """The motion at place ``k`` of a sweep, where it is outside the family of point ``j``."""
    period, rest = int(flown.period[k]), float(flown.rest[k])
    if flown.ended[k] != Ended.COMPLETE.code or period < 0:
        return
    impacts = round(float(flown.impacts_per_period[k]) * max(period, 1))
    if (period, impacts) == (group.periods, 1) and rest == 0:
        return
    value = float(getattr(flown, group.quantity)[k]) if group.gain is None else float("nan")
    off, told = value - float(group.value[j]), period > 0
    spread = float(np.hypot(group.uncertainty[j], 0.0 if told else VARIES * value))
    cost = (off / spread) ** 2 if np.isfinite(off) else 0.0
    yield OtherMotion(period, impacts, rest, value if told else float("nan"), cost if told else max(cost, UNTOLD))


SHORT = 150  # drive periods settled where starts are looked for
STEP = 1e-3  # of a difference quotient, share of the bounds
NEAR = 3.0  # residual of a flown motion up to which it is taken to be that of the point


@dataclass(frozen=True)
class LinearRows:
    """Linear residuals about shares ``x``: ``residual`` (rows,) and ``jacobian`` (rows, P)."""

    x: Array
    residual: Array
    jacobian: Array

    def after(self, own: tuple[Array, Array], x: Array) -> tuple[Array, Array]:
        """Residuals and Jacobian with these rows below them."""
        moved = self.residual + self.jacobian @ (x - self.x)
        return np.concatenate([own[0], moved]), np.concatenate([own[1], self.jacobian])


def flown_losses(problem: Problem, every: Array) -> Array:
    """Losses (m,) of shares (m, P): every point against the model's motion from rest."""
    cost = np.empty((len(every), problem.count))
    for group, at, own in problem.parts():
        value = _flown(problem, group, own, every, SHORT)[0]
        off = (value - group.value) / group.uncertainty
        cost[:, at] = np.where(np.isfinite(off), off**2, 1e300)
    return np.array([robust(each) for each in cost])


def flown_rows(problem: Problem, x: Array, others: dict[int, OtherMotion]) -> LinearRows | None:
    """Residuals of points outside the family and their difference quotients; None where there is none."""
    away = np.where(x < 0.5, STEP, -STEP)
    every, residual, jacobian = np.vstack([x, x + np.diag(away)]), [], []
    for group, at, own in problem.parts():
        some = np.flatnonzero(np.isin(at, [j for j, each in others.items() if np.isfinite(each.value)]))
        if not len(some):
            continue
        value, found = _flown(problem, group.some(some), own[some], every, SETTLE)
        alike = np.all(found.period == found.period[0], axis=0) & (found.period[0] > 0)
        for k, j in enumerate(some.tolist()):
            if alike[k] and abs(value[0, k] - others[int(at[j])].value) < NEAR * group.uncertainty[j]:
                residual.append((value[0, k] - group.value[j]) / group.uncertainty[j])
                jacobian.append((value[1:, k] - value[0, k]) / away / group.uncertainty[j])
    return LinearRows(x, np.array(residual), np.array(jacobian)) if residual else None


def _flown(problem: Problem, group: Points, own: Index, every: Array, settle: int) -> tuple[Array, BatchResponse]:
    """Values (m, points) of a group's quantity from rest at shares (m, P), NaN where there is no system; all that is
    read off."""
    surface, omega = problem.surfaces[group.fidelity], group.omega
    known = []
    for k, x in enumerate(every):
        with suppress(ValueError):
            known.append((k, surface.at(x)))
    systems = np.array([_system(data) for _, data in known], dtype=object)[:, None]
    drive = np.array([data.drive[own] for _, data in known])
    flown = batch(systems, omega[None, :], drive, settle=settle, hold=HOLD, output="seen")
    value = np.full((len(every), len(omega)), np.nan)
    value[[k for k, _ in known]] = getattr(flown, group.quantity)
    return value, flown


def _system(data: ModalData) -> ImpactSystem:
    return ImpactSystem(
        data.omega, data.zeta, data.contact, data.load, data.static, data.gap, data.restitution, {"seen": data.row}
    )


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
            data = surface.at(x).driven(own)
            above = 2 * np.clip(np.nan_to_num(beyond[0, at]), 0.0, FURTHEST)
            data = replace(data, drive=data.drive * np.exp(above))  # as far above the fold's as it is below
            found[at[lost]] = _nearer_root(group, data, surface)[lost]
    return found


def _nearer_root(group: Points, data: ModalData, surface: ModalSurface) -> Index:
    both = np.stack([value_of(group, data, surface.still(len(group)), root).value for root in ROOTS])
    return np.asarray(np.argmin(np.nan_to_num(np.abs(both - group.value), nan=np.inf), axis=0))
