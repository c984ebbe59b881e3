"""Estimated error of a model's response against a fuller model, point by point, along its own exact orbits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.closed_orbits import AdmissibilityCheck
from vibeam.periodic.modal_sums import resonant
from vibeam.periodic.motions import Motions, OrbitKind, predicted, predicted_free, unsuited
from vibeam.periodic.nearby_orbits import nearby_orbits
from vibeam.periodic.trains import Trains
from vibeam.runs.estimate.by_orbits import SETTLED, ModelPair, beside
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate
from vibeam.runs.estimate.work import CountedWork
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import StatesAfter
from vibeam_models.arrays import Array, Flags, Index

MOST = 8  # impacts before the motion repeats


@dataclass(frozen=True, eq=False)
class SweptMotions:
    """Points of a response, by what is known of their motions.

    ``trains``: those with impacts, and the points they belong to; ``free``: points that stay clear of the stop;
    ``basis`` (points,): code of the reason for all others.
    """

    trains: tuple[tuple[Index, Trains], ...]
    free: Index
    basis: NDArray[np.int64]


def swept_motions(
    system: ImpactSystem, response: FrequencyResponse, amplitude: Array, after: StatesAfter | None = None
) -> SweptMotions:
    """Exact orbits of the points of ``response``, under base motion ``amplitude`` (points,) m.

    Those with several impacts need the states ``after`` the points. Each agrees with its point in impact velocity.
    """
    count = np.rint(np.nan_to_num(response.impacts_per_period * response.period)).astype(int)
    basis = _reasons(response, count)
    found: list[tuple[Index, Trains]] = []
    open_ = basis == Basis.UNSETTLED.code
    for periods, m in sorted({(int(n), int(k)) for n, k in zip(response.period[open_], count[open_], strict=True)}):
        which = np.flatnonzero(open_ & (response.period == periods) & (count == m))
        one = _closed_form(system, response, amplitude, which, periods) if m == 1 else None
        several = one or _from_flights(system, response, amplitude, which, (periods, m), after)
        if several is not None:
            found.append(several)
            basis[several[0]] = Basis.ORBIT.code
    free = np.flatnonzero((response.ended == Ended.COMPLETE.code) & (response.period == -1))
    return SweptMotions(tuple(found), free, basis)


def _reasons(response: FrequencyResponse, count: Index) -> NDArray[np.int64]:
    """Codes of why nothing is known; UNSETTLED where an exact orbit is to be looked for."""
    reasons = np.full(len(response), Basis.UNSETTLED.code)
    tests = (
        (count > MOST, Basis.SEVERAL), (response.rest > 0, Basis.RESTS), (response.period == 0, Basis.APERIODIC),
        (response.period == -1, Basis.FREE), (response.ended != Ended.COMPLETE.code, Basis.FAILED),
    )  # fmt: skip
    for mask, basis in tests:
        reasons[mask] = basis.code
    return reasons


def _closed_form(
    system: ImpactSystem, response: FrequencyResponse, amplitude: Array, which: Index, periods: int
) -> tuple[Index, Trains] | None:
    """Orbits with one impact, of the two at each point the one whose velocity the point has."""
    omega, base = 2 * np.pi * response.frequency[which], amplitude[which]
    roots = motions(system, periods, omega, base, np.full(len(which), system.gap)).roots
    off = np.abs(roots.velocity / response.impact_velocity[which, None] - 1)
    off = np.where(np.isfinite(roots.phase) & (roots.impulse < 0), off, np.inf)
    rows, nearer = np.arange(len(which)), np.argmin(off, axis=1)
    kept = off[rows, nearer] < SETTLED
    phase, impulse = (row[rows, nearer][kept][:, None] for row in (roots.phase, roots.impulse))
    return which[kept], Trains(phase, impulse, omega[kept], base[kept], periods)


def _from_flights(
    system: ImpactSystem, response: FrequencyResponse, amplitude: Array, which: Index, repeats: tuple[int, int],
    after: StatesAfter | None,
) -> tuple[Index, Trains] | None:  # fmt: skip
    """Orbits with m impacts in n drive periods: one more repetition is flown by the model itself, and refined."""
    if after is None or not len(which):
        return None
    rows = list(_strikes(system, response, amplitude, which, repeats, after))
    if not rows:
        return None
    points = np.array([point for point, _, _ in rows])
    impulses = -(1 + system.restitution) / system.mobility * np.array([v for _, _, v in rows])
    start = Trains(
        np.array([phases for _, phases, _ in rows]), impulses, 2 * np.pi * response.frequency[points],
        amplitude[points], repeats[0],
    )  # fmt: skip
    near = nearby_orbits(system, start)
    off = np.abs(near.trains.impulses / impulses - 1).max(axis=1)
    kept = np.flatnonzero(near.found & (off < SETTLED))
    return points[kept], near.trains.at(kept)


def _strikes(
    system: ImpactSystem, response: FrequencyResponse, amplitude: Array, which: Index, repeats: tuple[int, int],
    after: StatesAfter,
) -> Iterator[tuple[int, Array, Array]]:  # fmt: skip
    """Point, drive phases and velocities of the impacts of one repetition, where there are as many as expected."""
    periods, m = repeats
    slowest = 2 * np.pi * float(response.frequency[which].min())
    witness = AdmissibilityCheck(system, slowest)
    for point in which.tolist():
        state = after.at(point)
        if state is not None:
            omega = 2 * np.pi * float(response.frequency[point])
            drive, end = Drive(omega, float(amplitude[point])), 2 * np.pi * periods / omega
            times, velocities = witness.strikes(drive, state, 0.0, end, m + 1)
            if len(times) == m:
                yield point, omega * times, velocities


READ_OFF = 2e-6  # share to which a flight is read off


def estimate_error(
    response: FrequencyResponse, system: ImpactSystem, full: ImpactSystem, amplitude: ArrayLike,
    output: str = "contact", after: StatesAfter | None = None, points: Flags | None = None,
    drift: Array | None = None, work: CountedWork | None = None,
) -> ErrorEstimate:  # fmt: skip
    """Estimate the error of ``response``, of the model ``system``, against the same motion of the model ``full``.

    Where several motions coexist, a sweep of ``full`` may be on another one: ``of_case`` tells.

    ``amplitude`` of the base motion, m, one number or one a point; ``output``: what the response was read of;
    ``drift`` (points,): growth of the gap, m. The states ``after`` its points are needed for motions that no closed
    form of both models knows: these go by orbits (``by_orbits``), where the models have none at all at the ``points``
    (mask, None: all), the highest first, until the ``work`` is done (None: at all).

    >>> import vibeam
    >>> full = vibeam.ImpactSystem.from_modes([1.0, 7.0], 0.05, [1.0, 0.1], [1.0, 0.1], restitution=0.5)
    >>> one = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> found = vibeam.estimate_error(vibeam.sweep(one, omega=[2.0], amplitude=0.1), one, full, 0.1)
    >>> found.known.tolist(), bool(abs(found.amplitude[0]) < 0.1)
    ([True], True)
    """
    base = np.array(np.broadcast_to(np.asarray(amplitude, dtype=float), len(response)))
    closed = drift is None and not (unsuited(system) or unsuited(full))
    nothing = SweptMotions((), np.zeros(0, dtype=np.int64), np.full(len(response), Basis.LEFT_OUT.code))
    swept = swept_motions(system, response, base, after) if closed else nothing
    made = _Rows(np.full((len(QUANTITIES), len(response)), np.nan), np.full((4, len(response)), np.nan), swept.basis)
    for which, trains in _without_resonance(full, swept):
        different, back = _distinct(trains)
        there = predicted(full, trains.at(different), output)
        made.enter(response, which, there.at(back), Basis.ORBIT)
    if len(swept.free):
        omega = 2 * np.pi * response.frequency[swept.free]
        made.enter(response, swept.free, predicted_free(full, omega, base[swept.free], output), Basis.FREE)
    open_ = np.isin(swept.basis, [Basis.RESTS.code, Basis.SEVERAL.code]) if closed else np.ones(len(response), bool)
    if open_.any():
        which = np.flatnonzero(open_ if closed or points is None else points)
        made.basis[open_] = Basis.LEFT_OUT.code
        states = after or StatesAfter.unknown(len(response), system.size)
        pair, work = ModelPair(system, full, output, drift), work or CountedWork()
        for point, shot in beside(pair, response, base, states, which, work):
            made.signed[:, point], made.basis[point] = shot.errors, shot.basis.code
            size = np.abs(shot.errors)
            made.bounds[:, point] = *(size + (1 + size) * READ_OFF), shot.correction
    names = (*QUANTITIES, *(f"{name}_bound" for name in QUANTITIES), "correction")
    rows = dict(zip(names, (*made.signed, *made.bounds), strict=True))
    return ErrorEstimate(frequency=response.frequency.copy(), basis=made.basis, **rows)


def _distinct(trains: Trains) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Motions that differ, and for each motion its place among them: a sweep down repeats most of the one up."""
    rows = np.column_stack([trains.omega, trains.amplitude, trains.phases, trains.impulses])
    _, first, back = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, back.ravel()


def _without_resonance(full: ImpactSystem, swept: SweptMotions) -> list[tuple[NDArray[np.int64], Trains]]:
    """Trains at whose drives the full model has a steady response."""
    found = []
    for which, trains in swept.trains:
        bad = np.array([bool(resonant(full, float(omega), trains.periods)) for omega in trains.omega], dtype=bool)
        swept.basis[which[bad]] = Basis.RESONANT.code
        if not bad.all():
            found.append((which[~bad], trains.at(np.flatnonzero(~bad))))
    return found


@dataclass(frozen=True, eq=False)
class _Rows:
    """Signed differences, their bounds and the correction, and the basis, filled part by part."""

    signed: Array
    bounds: Array
    basis: NDArray[np.int64]

    def enter(self, response: FrequencyResponse, which: NDArray[np.int64], there: Motions, same: Basis) -> None:
        """Enter the other model's motions at the points ``which``; ``same``: basis where its motion is the same."""
        values = [np.where(there.stable, getattr(there, name), np.nan) for name in QUANTITIES]
        unsure = there.uncertainty, there.reach_uncertainty, np.zeros(len(which))
        for row, (name, value, off) in enumerate(zip(QUANTITIES, values, unsure, strict=True)):
            with np.errstate(invalid="ignore", divide="ignore"):
                signed = getattr(response, name)[which] / value - 1
                self.signed[row, which] = signed
                self.bounds[row, which] = np.abs(signed) + (1 + np.abs(signed)) * (off / np.abs(value) + READ_OFF)
        self.bounds[3, which] = there.first
        codes = np.array([same.code, *(Basis[each.name].code for each in OrbitKind if each is not OrbitKind.ORBIT)])
        self.basis[which] = codes[there.found]
