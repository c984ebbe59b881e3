"""Explanation of measured points at given keys: by a motion of the closed-form family, or one that the model flies.

The closed-form family has, at each point, the two roots of the closed-form orbit and the motion without contact. One
that passes through the stop between its impacts, or is not stable, is no motion. Where none of the family is within
twice the uncertainty of a point the model is swept over it and its neighbours, upward and downward: what it does may be
outside the family (several impacts until it repeats, another period, rest on the stop, no repeat), and lie nearer. A
periodic one is followed from there (``orbits``). Of a model without closed forms (a stop that yields or is on both
sides, R(v), damping that couples the modes) every motion is simulated and followed. A point far from the family whose
motion does not repeat is left out of the misfit, by name, since such a motion has no value of its own; what it is off
still counts wherever two sets of keys are compared, so that no set is the better for leaving points out.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from vibeam.periodic.bifurcation_functions import clearances
from vibeam.periodic.bifurcation_functions import motions as motions_at
from vibeam.periodic.multipliers import stability
from vibeam.periodic.shooting import NoOrbit
from vibeam.periodic.tangents import ModalData
from vibeam.studies.fit.orbits import FollowedOrbit, OtherMotion, Shooting
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import FOLLOWED, IMPOSSIBLE, LEFT, NO_CONTACT, Problem, robust, value_of
from vibeam.studies.fit.surface import ModalSurface
from vibeam.studies.fit.trails import HOLD, LONG, SHORT, SettledPoint, Trails, settled_points
from vibeam.system.quantities import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array, Flags, Index

SETTLED = 1e-3  # share of its size within which a flight is on a motion that is known
UNTOLD = 9.0  # least squared residual of a motion that does not repeat, whose value is that of no one record
VARIES = 0.1  # share by which records of such a motion are taken to differ


def other_motions(problem: Problem, x: Array, which: Index) -> dict[int, list[OtherMotion]]:
    """Motions outside the family at the points ``which``: flown from their neighbours on, and those that are known."""
    found: dict[int, list[OtherMotion]] = {int(j): [] for j in which}
    for group, at, _ in problem.parts():
        asked, forward = np.flatnonzero(np.isin(at, which)), problem.forward[group.fidelity]
        if not len(asked) or (group.unstable and forward.closed):
            continue
        model = problem.trails.model(forward, problem.omega_of(group.fidelity))
        places, settle = _with_neighbours(group, asked), LONG if forward.closed else SHORT
        for each in settled_points(group, model.at(x), places, settle):
            if int(at[each.place]) in found:
                shooting = Shooting(model, group, float(group.omega[each.place]), int(at[each.place]))
                found[shooting.point] += _outside(problem, x, shooting, each)
        for j in asked.tolist():
            known = [each.number for each in found[int(at[j])]]
            for number, orbit in problem.trails.known(int(at[j]), x):
                if number not in known and (orbit.stable or group.unstable):
                    found[int(at[j])].append(_followed(group, j, orbit, number))
    return {j: each for j, each in found.items() if each}


def _with_neighbours(group: Points, asked: Index) -> Index:
    """Points asked for and those beside them in frequency, one a frequency."""
    frequency, first = np.unique(group.frequency, return_index=True)
    places = np.searchsorted(frequency, group.frequency[asked])
    every = np.unique(np.concatenate([places - 1, places, places + 1]))
    return np.unique(np.concatenate([asked, first[every[(every >= 0) & (every < len(frequency))]]]))


def _followed(group: Points, j: int, orbit: FollowedOrbit, number: int) -> OtherMotion:
    cost = ((orbit.value - float(group.value[j])) / float(group.uncertainty[j])) ** 2
    return OtherMotion(orbit.period, orbit.impacts, orbit.rest, orbit.resting, orbit.value, cost, number)


def _outside(problem: Problem, x: Array, shooting: Shooting, flown: SettledPoint) -> Iterator[OtherMotion]:
    """The motion that a flight settles on, where it is outside the family: followed from there, where that goes."""
    seen = _seen(shooting, x, flown)
    if seen is None:
        return
    number = _number(problem.trails, shooting, x, flown.state, seen)
    if number is None and seen.period == 0 and not shooting.model.forward.closed:  # it may not have settled yet
        beside = shooting.points.omega[flown.place : flown.place + 1]
        read, (after,) = shooting.model.at(x).swept(beside, flown.state, LONG, HOLD, shooting.points.quantity)
        seen = _seen(shooting, x, SettledPoint(flown.place, read, 0, after)) or seen
        number = _number(problem.trails, shooting, x, after, seen) if seen.period else None
    if number is not None:
        seen = _followed(shooting.points, flown.place, problem.trails.every[number].at(x), number)
    yield seen


def _number(trails: Trails, shooting: Shooting, x: Array, state: State, seen: OtherMotion) -> int | None:
    """Number of the periodic motion that a flight settles on; one that has not repeated yet: of a stable one near."""
    number = trails.alike(shooting.point, x, shooting.model.at(x).row(state), max(seen.period, 1), SETTLED)
    if number is None and (seen.period or not shooting.model.forward.closed):
        with suppress(NoOrbit):
            found = shooting.settled(x, state, seen)
            return trails.number(found) if seen.period or found.stable else None
    return number


def _seen(shooting: Shooting, x: Array, flown: SettledPoint) -> OtherMotion | None:
    """The motion that a flight settles on; None where it is of the family, or the flight fails."""
    group, j, read, k = shooting.points, flown.place, flown.read, flown.k
    closed, period, rest = shooting.model.forward.closed, int(read.period[k]), shooting.model.at(x).rest(read)[k]
    impacts = round(float(read.impacts_per_period[k]) * max(period, 1)) if np.isfinite(rest) else 0
    own = (period, impacts) == (group.periods, 1) and rest == 0 and not group.several
    if read.ended[k] != Ended.COMPLETE.code or (closed and (period < 0 or own)):
        return None
    value = float(getattr(read, group.quantity)[k]) if group.gain is None else float("nan")
    off, told = value - float(group.value[j]), period != 0
    spread = float(np.hypot(group.uncertainty[j], 0.0 if told else VARIES * value))
    cost = (off / spread) ** 2 if np.isfinite(off) else 0.0
    told_value, told_cost = (value, cost) if told else (float("nan"), max(cost, UNTOLD))
    return OtherMotion(period, impacts, rest, flown.state.resting, told_value, told_cost)


def flown_losses(problem: Problem, every: Array) -> Array:
    """Losses (m,) of shares (m, P): every point against what the model has soon after a start upward."""
    cost = np.full((len(every), problem.count), 1e300)
    for (k, x), (group, at, _) in product(enumerate(every), problem.parts()):
        with suppress(ValueError):  # keys that make no system
            value = problem.trails.soon(group, problem.forward[group.fidelity], x)[0]
            off = (value - group.value) / group.uncertainty
            cost[k, at] = np.where(np.isfinite(off), off**2, 1e300)
    return np.array([robust(each) for each in cost])


ROOTS = (0, 1)  # of the quadratic
FURTHEST = 1.0  # ln(B*/B) up to which the drive beyond the fold is taken
DOUBTED = 2.0  # residual from which on another motion is looked for
SAME = 0.1  # squared residual within which it may be the closed form's own, of twice its period
FAR = 4.0  # residual from which on a point is also left out for a motion that is not followed
HANDICAP = 9.0  # of a motion that does not exist at this drive against one that does, in squared residuals


@dataclass(frozen=True)
class Explanation:
    """Motion of each point (``LEFT``: none), whether the model has it, squared residuals (points,).

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
    cost, known = costs(problem, value, beyond), np.isfinite(value).any(axis=0)
    chosen = np.where(known, _unfolded(problem, x, beyond, np.argmin(cost, axis=0)), LEFT)
    return chosen, robust(cost.min(axis=0)[known])


def explained(problem: Problem, x: Array, dropped: tuple[int, ...] = ()) -> Explanation:
    """Explanation of every point at shares ``x``: the motion that it is least off from; ``dropped`` are left out."""
    value, beyond = problem.motions(x)
    cost, allowed = costs(problem, value, beyond), actual(problem, x, beyond)
    asked = np.where(allowed, cost, np.where(beyond > 0, cost + HANDICAP, np.inf))
    asked = np.where(np.isinf(asked).all(axis=0), cost + HANDICAP, asked)
    chosen = _unfolded(problem, x, beyond, np.argmin(asked, axis=0))
    at = np.arange(problem.count)
    found, real, others = cost[chosen, at], allowed[chosen, at], {}
    for j, motions in other_motions(problem, x, np.flatnonzero(~real | (found > DOUBTED**2))).items():
        near = real[j] and found[j] <= FAR**2
        rivals = [each for each in motions if not near or each.number is not None]
        other = min(rivals, key=lambda each: each.cost, default=None)
        if other and other.cost < asked[chosen[j], j] - SAME:
            chosen[j] = LEFT if other.number is None else FOLLOWED + other.number
            found[j], real[j], others[j] = other.cost, True, other
    chosen[list(dropped)] = LEFT
    found_none = (chosen < LEFT) & ~np.isfinite(value).any(axis=0)
    chosen[found_none] = LEFT
    others = {j: each for j, each in others.items() if chosen[j] == LEFT and j not in dropped}
    return Explanation(chosen, real & (chosen != LEFT), found, others)


def actual(problem: Problem, x: Array, beyond: Array) -> Flags:
    """Motions (3, points) that the model has; ``beyond`` of ``Problem.motions``."""
    found = np.zeros(beyond.shape, dtype=bool)
    found[NO_CONTACT] = beyond[NO_CONTACT] == 0
    systems = {name: each.system(problem.values(x)) for name, each in problem.forward.items() if each.closed}
    for group, at, own in problem.parts():
        if group.several or group.fidelity not in systems:
            found[:, at] = False
            continue
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
        lost = (beyond[:2, at] > 0).all(axis=0) & (chosen[at] < NO_CONTACT) & group.unstable
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
