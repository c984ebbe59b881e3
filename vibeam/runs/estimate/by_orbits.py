"""Errors of a model's response against a fuller model by the orbits of both, of every contact law.

The state after a point of the response is refined to the model's own orbit by shooting. Its contact forces and the
drive move the fuller model periodically, in closed form (``lifted``): from there Newton's method goes on in that model.
Where its corrections do not contract, the fuller model is flown on from there instead, and counts where it comes to a
motion of the same period with as many contacts. Both orbits are exact, and so is the error.

A fuller model of many modes takes two steps: to the orbit of its lower modes, which costs little, and from there to
that of all. Along a contact that is integrated the tangent maps of many modes take minutes; there the second step goes
by those of the lower modes alone, and the others, which die out within a period, are left as the flight ends
(Newton–Picard: Lust, Roose, Spence & Champneys, SIAM J. Sci. Comput. 19 (1998) 1188). The orbit is that of all modes,
its stability that of the lower ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vibeam.flight.solver import ExactSolver, exact_solver
from vibeam.periodic.lift import lifted, response_alone
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import near
from vibeam.periodic.shooting import NoOrbit, shoot
from vibeam.periodic.stroboscopic import NEAR, Flown, MotionEnded, StroboscopicMap
from vibeam.runs.comparison.limit import lowest_modes
from vibeam.runs.estimate.records import QUANTITIES, Basis
from vibeam.runs.estimate.work import CountedMap, CountedWork, TooDear
from vibeam.system.curves import evenly
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse, complete
from vibeam.system.state import State, StatesAfter
from vibeam_models.arrays import Array, Flags, Index

SETTLED = 1e-3  # largest relative difference between a point and its exact orbit
ALIKE = 1e-6  # the same of two points of one frequency that are on one motion
POINTS = 13  # frequencies of a direction, evenly spread, beside those around the peak
FLOWN = 64  # drive periods of the fuller model where Newton's method leads nowhere
CONTRACTS = 0.5  # share of the first correction that the second is at most
SMALL = 1e-4  # correction that leads to no other motion
SETTLE, HOLD = 300, 32  # drive periods flown to an orbit that nothing is known of, and watched
LEAST_MODES, LASTS = 16, 14.0  # lower modes at least, and nepers a period by which all others decay
KEPT = 4  # steps of Newton's method with one Jacobian of the lower modes


def in_order(response: FrequencyResponse, which: Index) -> Index:
    """Points ``which``, the highest first, then evenly spread, ever finer."""
    spread = sorted(range(len(which)), key=lambda place: f"{place:032b}"[::-1])  # van der Corput's sequence
    done = complete(response)[which]
    top = int(np.argmax(np.where(done, response.amplitude[which], -np.inf))) if done.any() else 0
    return which[[top, *(place for place in spread if place != top)]] if len(which) else which


def looked_at(response: FrequencyResponse) -> Flags:
    """Mask (points,) of a direction's points whose orbits are found: evenly spread, the highest, its neighbours."""
    chosen, done = np.zeros(len(response), dtype=bool), complete(response)
    chosen[evenly(0, len(response) - 1, POINTS)] = True
    if done.any():
        top = int(np.argmax(np.where(done, response.amplitude, -np.inf)))
        chosen[max(top - 1, 0) : top + 2] = True
    return chosen


class BesidePoint(NamedTuple):
    """Errors of the quantities at one point against the fuller model, NaN where ``basis`` is a refusal."""

    basis: Basis
    errors: Array
    correction: float = np.nan


def refused(basis: Basis) -> BesidePoint:
    """A point of which nothing is known, for a reason."""
    return BesidePoint(basis, np.full(len(QUANTITIES), np.nan))


class ModelPair(NamedTuple):
    """A model, a fuller one, the output read of both; ``drift`` (points,): growth of their gaps, m."""

    system: ImpactSystem
    full: ImpactSystem
    output: str
    drift: Array | None = None


def beside(
    pair: ModelPair, response: FrequencyResponse, base: Array, after: StatesAfter, which: Index, work: CountedWork
) -> Iterator[tuple[int, BesidePoint]]:
    """Motions of the fuller model beside the points ``which`` of the other's response, one after the other.

    ``base`` amplitudes (points,), m; ``after``: states after the points. Points of one motion are computed once, the
    highest first, then evenly spread, until the ``work`` is done; one that would take too much of it is given up.
    """
    known: dict[float, list[tuple[int, BesidePoint]]] = {}
    slowest, drift, made = 2 * np.pi * float(response.frequency.min()), pair.drift, dict[float, TwoModels]()
    for point in in_order(response, which).tolist():
        if work.done:
            return
        there = known.setdefault(float(response.frequency[point]), [])
        found = next((each for other, each in there if _alike(response, point, other)), None)
        if found is None:
            grown = 0.0 if drift is None else float(drift[point])
            if grown not in made:
                made = {grown: TwoModels(pair, grown, slowest, work)}
            found = made[grown].beside(response, point, float(base[point]), after.at(point))
            there.append((point, found))
        yield point, found


class TwoModels:
    """Both models with gaps grown by so much, each made ready once for drives of ``slowest`` rad/s and more."""

    def __init__(self, pair: ModelPair, grown: float, slowest: float, work: CountedWork) -> None:
        system, full = (replace(each, gap=each.gap + grown) if grown else each for each in pair[:2])
        self.output = pair.output
        self._work = work
        self._own, self._fuller = ReadyModel(system, slowest, work), ReadyModel(full, slowest, work)

    def beside(self, response: FrequencyResponse, point: int, base: float, state: State | None) -> BesidePoint:
        """Motion of the fuller model beside one point of the other's response."""
        self._work.begin()
        try:
            return self._beside(response, point, base, state)
        except TooDear:
            return refused(Basis.DEAR)

    def _beside(self, response: FrequencyResponse, point: int, base: float, state: State | None) -> BesidePoint:
        if response.ended[point] != Ended.COMPLETE.code:
            return refused(Basis.FAILED)
        drive, periods = Drive(2 * np.pi * float(response.frequency[point]), base), int(response.period[point])
        if periods == -1:
            return self._free(drive, np.array([getattr(response, name)[point] for name in QUANTITIES]))
        if periods == 0 or state is None:
            return refused(Basis.UNSETTLED if periods else Basis.APERIODIC)
        try:
            own = near(self._own.section(drive), state, periods)
            seen = own.watched(self.output)
        except (NoOrbit, MotionEnded):
            return refused(Basis.UNSETTLED)
        if any(abs(getattr(seen, n)[0] / getattr(response, n)[point] - 1) > SETTLED for n in ("amplitude", "reach")):
            return refused(Basis.UNSETTLED)
        return self._from(own, seen)

    def _free(self, drive: Drive, own: Array) -> BesidePoint:
        """Beside a point with the values ``own`` that stays clear of the stop."""
        fuller, state = self._fuller, response_alone(self._fuller.system, drive, 0.0)
        seen = fuller.runner.steady([drive.omega], drive.amplitude, state, 0, 1, self.output)[0]
        self._work.flight(fuller.system, int(seen.evaluations[0]), int(seen.impacts[0]))
        return refused(Basis.TOUCHES) if seen.impacts[0] else BesidePoint(Basis.FREE, own / _values(seen) - 1, 0.0)

    def _from(self, own: Orbit, seen: FrequencyResponse) -> BesidePoint:
        """Beside the other model's orbit ``own``, read as ``seen``."""
        basis, found = self._fuller.orbit_from(own)
        if found is None:
            return refused(basis)
        return BesidePoint(basis, _values(seen) / _values(found.watched(self.output)) - 1, found.corrections[0])


def _contracted(section: StroboscopicMap, state: State, periods: int) -> Orbit | None:
    """Orbit near a state, None where the corrections to it do not contract and it may be another one."""
    try:
        found = shoot(section, state, periods)
    except (NoOrbit, MotionEnded):
        return None
    first, second = (*found.corrections, 0.0)[:2]
    return found if second <= CONTRACTS * first or first <= SMALL else None


def _reached(section: StroboscopicMap, state: State, periods: int) -> Orbit | None:
    """Orbit that a model comes to from a state; None where its motion does not repeat so."""
    there, here = section.in_flight(section.flown(state, FLOWN).state, periods)
    before, after = there.vector(here), there.vector(there.flown(here, periods).state)
    returns = np.linalg.norm(after - before) <= NEAR * np.linalg.norm(before)
    return shoot(there, here, periods) if returns else None


class ReadyModel:
    """A model made ready once, and that of its lower modes where it has many."""

    def __init__(self, system: ImpactSystem, slowest: float, work: CountedWork | None = None) -> None:
        self.system, self.runner, self._work = system, exact_solver(system, slowest), work or CountedWork()
        decays = 2 * np.pi / slowest * system.zeta * system.omega
        count = max(LEAST_MODES, int(np.count_nonzero(decays < LASTS)))
        few = system.coupling is None and system.further is None and 2 * count <= system.size
        self.lower = ReadyModel(lowest_modes(system, count), slowest, self._work) if few else None

    def section(self, drive: Drive) -> CountedMap:
        """The stroboscopic map at phase 0 of a drive."""
        if self.lower is None or not self.system.contact_law.integrated:
            return CountedMap(self.system, drive, self.runner, self._work)
        return MapByLowerModes(self.system, drive, self.runner, self._work, self.lower.section(drive))

    def settled(self, drive: Drive) -> Orbit | None:
        """The orbit settled on from static equilibrium; None where the motion does not repeat, or is clear of stops."""
        seen, state = self.runner.steady([drive.omega], drive.amplitude, None, SETTLE, HOLD, "contact")
        try:
            return near(self.section(drive), state, int(seen.period[0])) if seen.period[0] > 0 else None
        except (NoOrbit, MotionEnded):
            return None

    def orbit_from(self, own: Orbit) -> tuple[Basis, Orbit | None]:
        """The stable orbit of this model beside that of another, or the reason why there is none."""
        basis = Basis.ORBIT
        for model in filter(None, (self.lower, self)):
            section = model.section(own.drive)
            self._work.matrices(section.system)
            self._work.lift(own, section.system)
            time, state = lifted(own, section.system)
            section.tried(state, own.periods, time)
            try:
                found = _contracted(section.at(time), state, own.periods)
                if found is None:
                    found, basis = _reached(section.at(time), state, own.periods), Basis.REACHED
            except (NoOrbit, MotionEnded):
                return Basis.NO_ORBIT, None
            if found is None or (basis is Basis.REACHED and len(found.times) != len(own.times)):
                return Basis.ANOTHER, None
            own = found
        return (basis, own) if own.stable else (Basis.UNSTABLE, None)


class MapByLowerModes(CountedMap):
    """Stroboscopic map with the Jacobian of the lower modes, in which all others are forgotten; it is kept a while."""

    def __init__(
        self, system: ImpactSystem, drive: Drive, runner: ExactSolver, work: CountedWork, lower: StroboscopicMap
    ) -> None:
        super().__init__(system, drive, runner, work)
        self._lower = lower
        self._kept: list[Array] = []

    def jacobian(self, state: State, periods: float, flown: Flown) -> Array:
        """See the base class; along the motion of the lower modes alone."""
        if not self._kept:
            self._kept = [self._made(state, periods)] * KEPT
        return self._kept.pop()

    def _made(self, state: State, periods: float) -> Array:
        n, whole = self._lower.system.size, self.system.size
        lower, begun = self._lower.at(self.time), State(state.displacement[:n], state.velocity[:n])
        matrix, kept = np.zeros((2 * whole, 2 * whole)), np.concatenate([np.arange(n), whole + np.arange(n)])
        matrix[np.ix_(kept, kept)] = lower.jacobian(begun, periods, lower.flown(begun, periods))
        return matrix


def _alike(response: FrequencyResponse, one: int, other: int) -> bool:
    """Test whether two points of one frequency are on one motion."""
    if response.period[one] != response.period[other] or response.period[one] == 0:
        return False
    clear = response.period[one] == -1
    names = (name for name in (*QUANTITIES, "impacts_per_period") if not (clear and name == "impact_velocity"))
    pairs = (getattr(response, name)[[one, other]] for name in names)
    return all(abs(a - b) <= ALIKE * abs(b) for a, b in pairs)


def _values(seen: FrequencyResponse) -> Array:
    return np.array([getattr(seen, name)[0] for name in QUANTITIES])
