"""Impacts of the motions that a sweep found: exact orbits of its own model at the points of a response."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.bifurcation_functions import motions
from vibeam.periodic.orbit import AdmissibilityCheck
from vibeam.periodic.predicted_response import nearby_orbits
from vibeam.periodic.train_sums import Trains
from vibeam.runs.estimate.records import Basis
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import StatesAfter
from vibeam_models.arrays import Array, Index

SETTLED = 1e-3  # largest relative difference in impact velocity between a point and its exact orbit
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
