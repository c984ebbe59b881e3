"""Error estimates of a case's fidelities against the full models of their own scenes: all modes, same restitution.

Where several motions coexist the full model may make another one than the reduced model, though the same motion exists
in it, is stable and clear of the stop: only a sweep of the full model itself tells. It carries its state through all
frequencies and is left at each of them as soon as it is on a motion that was predicted, which takes a fraction of the
settling. Where none was, the state is carried on for the same fraction; from there a motion counts as the full model's
own where the sweep comes to it from several states of what was before, since which one it has is not known.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.fidelity import Fidelity, system
from vibeam.flight.kernels import layout
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.motions import unsuited
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.estimate.error import estimate_error
from vibeam.runs.estimate.records import QUANTITIES, Basis, ErrorEstimate, FidelityEstimate
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, complete, join
from vibeam.system.state import State, StatesAfter
from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of
from vibeam_models.scene import AnyScene, RigScene

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.response import Branches

AGREES = 1e-3  # largest relative difference in amplitude and impact velocity between a flight and its motion
FIRST = 8  # the first look is after this part of the settling, each further one after as many periods again as before
LONGEST = 1000  # periods of settling at most
MOST = 300  # impacts a drive period, above which a flight is given up
STARTS = 8  # states of a motion that is not known, from which the next one that is known is to be reached
READ = 8  # repetitions of a motion over which it is read


@dataclass(frozen=True)
class Motion:
    """Motions at the points of a branch as far as they are compared, (points,): NaN and 0 where not known."""

    amplitude: Array
    velocity: Array
    impacts: Array  #: a drive period
    period: NDArray[np.int64]

    @classmethod
    def of(cls, response: FrequencyResponse) -> Motion:
        """Motions of a response."""
        done = complete(response)
        values = (response.amplitude, response.impact_velocity, response.impacts_per_period)
        amplitude, velocity, impacts = (np.where(done, each, np.nan) for each in values)
        return cls(amplitude, velocity, impacts, response.period)

    @classmethod
    def predicted(cls, response: FrequencyResponse, estimate: ErrorEstimate) -> Motion:
        """Motions of the full model that an estimate says are those of a response."""
        own = cls.of(response)
        amplitude, velocity = (
            np.where(estimate.known, values / (1 + error), np.nan)
            for values, error in ((own.amplitude, estimate.amplitude), (own.velocity, estimate.impact_velocity))
        )
        return cls(amplitude, velocity, own.impacts, own.period)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Points (points,) of which it is known."""
        return np.isfinite(self.amplitude)

    def agrees(self, other: Motion) -> NDArray[np.bool_]:
        """Test (points,) whether two are one motion, within what a flight that still settles may be off."""
        velocity = np.abs(self.velocity / other.velocity - 1) <= AGREES
        same = np.where(self.impacts == 0, other.impacts == 0, velocity)
        near = np.abs(self.impacts - other.impacts) <= 1 / READ
        return np.asarray(same & near & (np.abs(self.amplitude / other.amplitude - 1) <= AGREES))

    def at(self, point: int) -> Motion:
        """Motion at one point."""
        return Motion(*(getattr(self, name)[point : point + 1] for name in NAMES))


NAMES = tuple(field.name for field in fields(Motion))
_NAN = np.full(1, np.nan)
UNKNOWN = Motion(_NAN, _NAN, _NAN, np.zeros(1, dtype=np.int64))


class FullSweep:
    """Sweep of the full model ``system``, branch after branch, its state carried; see the module."""

    def __init__(self, system: ImpactSystem, slowest: float, settle: int, output: str) -> None:
        self._flight, self._output = FlightSolver(system, slowest, limit=MOST), output
        self._settle = min(settle, LONGEST)
        self._part = max(self._settle // FIRST, 1)
        self._starts: list[State | None] = [None]

    def branch(self, omega: Array, base: Array, expected: Sequence[Motion]) -> Motion:
        """Motions at drives ``omega`` (points,) rad/s, ``base`` m, in the order swept, beside those ``expected``."""
        known = np.append(np.any([each.known for each in expected], axis=0), True)
        points = [
            self._beside(omega[i], base[i], [each.at(i) for each in expected if each.known[i]])
            if known[i]
            else self._between(omega[i], base[i], last=bool(known[i + 1]))
            for i in range(len(omega))
        ]
        return Motion(*(np.concatenate([getattr(p, name) for p in points]) for name in NAMES))

    def _beside(self, omega: float, base: float, expected: Sequence[Motion]) -> Motion:
        """Motion at one drive: one of those expected where it ends there from all starts, else another one."""
        found = UNKNOWN
        for start in self._starts or [None]:
            found, state = self._settled(omega, base, expected, start)
            self._starts = [] if state is None else [state]
            if not any(each.agrees(found)[0] for each in expected):
                break
        return found

    def _settled(
        self, omega: float, base: float, expected: Sequence[Motion], state: State | None
    ) -> tuple[Motion, State | None]:
        """Motion from one start, on one of those expected or after all of the settling, and its state."""
        hold, flown, more = READ * max(abs(int(each.period[0])) for each in expected), 0, self._part
        while True:
            found, state = self._on(omega, base, state, more, hold)
            flown += more + hold
            if state is None or flown >= self._settle or any(each.agrees(found)[0] for each in expected):
                return found, state
            more = min(flown, self._settle - flown)

    def _between(self, omega: float, base: float, last: bool) -> Motion:
        """Motion at a drive at which none is known: only carried on; ``last``: the next one has several starts."""
        if not self._starts:
            return UNKNOWN
        found, state = self._on(omega, base, self._starts[0], self._settle if last else self._part, 1)
        self._starts = [state]
        for periods in range(1, STARTS) if last else ():
            if state is not None:
                _, state = self._on(omega, base, state, periods, 1)
                self._starts.append(state)
        self._starts = [each for each in self._starts if each is not None]
        return found

    def _on(
        self, omega: float, base: float, state: State | None, settle: int, hold: int
    ) -> tuple[Motion, State | None]:
        """Motion of so many periods, and the state after it; None where it was given up."""
        response, after = self._flight.steady(
            [omega], float(base), state, settle, hold, self._output, layout.OUTPUT_ALONE
        )
        return Motion.of(response), after if complete(response)[0] else None


def without_another_motion(estimate: ErrorEstimate, expected: Motion, flown: Motion) -> ErrorEstimate:
    """Estimate without the points at which the full model was ``flown`` to another motion than was ``expected``."""
    other = expected.known & ~expected.agrees(flown)
    names = (*QUANTITIES, *(f"{name}_bound" for name in QUANTITIES))
    rows = {name: np.where(other, np.nan, getattr(estimate, name)) for name in names}
    return replace(estimate, basis=np.where(other, Basis.ANOTHER.code, estimate.basis), **rows)


LARGEST = 1500  # coordinates of a structure all of whose modes are computed


def full_model(scene: AnyScene, omega: Array) -> ImpactSystem:
    """Impact system with all modes of a scene; ValueError says why it has no closed-form motions over ``omega``."""
    if why := without_closed_forms(scene, omega):
        raise ValueError(why)
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no fuller model")
    if not scene.all_modes:
        raise ValueError("the case gives a few modes, and no structure that has more")
    if scene.stop.law is not None:
        raise ValueError(f'no closed-form motions with the contact law "{scene.stop.law.name}"')
    if (size := structure_of(scene).size) > LARGEST:
        raise ValueError(f"the full model has {size} coordinates, too many to know all of its modes")
    full = system(scene, Fidelity("full model", "full"))
    if why := unsuited(full):
        raise ValueError(f"the full model: {why}")
    return full


def estimates(
    case: Case, systems: Mapping[str, ImpactSystem], branches: Mapping[str, Branches],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Estimate the error of every fidelity; ``after``: states after the points of each branch.

    The full model of a scene is made once for all fidelities of that scene, and flown once: see ``FullSweep``.
    """
    found: dict[str, FidelityEstimate] = {}
    for names in _scenes(case, branches):
        begun = time.thread_time()
        try:
            full = full_model(case.scene_of(names[0]), 2 * np.pi * case.sweep.frequency)
        except ValueError as refusal:
            found |= dict.fromkeys(names, FidelityEstimate(0, {}, str(refusal)))
            continue
        made = {
            name: _estimate(case, name, (systems[name], full), branches[name], after.get(name, {})) for name in names
        }
        made |= _of_own_motions(case, full, made, branches)
        each = (time.thread_time() - begun) / len(names)
        found |= {name: replace(one, cpu_seconds=each) for name, one in made.items()}
    return {name: found[name] for name in branches}


def _scenes(case: Case, names: Iterable[str]) -> list[list[str]]:
    """Fidelities by scene: those whose changes to the case's own are the same."""
    groups: dict[str, list[str]] = {}
    for name in names:
        own = case.fidelities[name]
        groups.setdefault(repr((own.changes, own.without)), []).append(name)
    return list(groups.values())


def _estimate(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter],
) -> FidelityEstimate:  # fmt: skip
    system, full = models
    if why := unsuited(system):
        return FidelityEstimate(0, {}, why)
    if system.size == full.size:
        return FidelityEstimate(full.size, {}, whole=True)
    return FidelityEstimate(full.size, _of_branches(case, name, models, branches, after))


def _of_branches(
    case: Case, name: str, models: tuple[ImpactSystem, ImpactSystem], branches: Branches,
    after: Mapping[str, StatesAfter],
) -> dict[str, ErrorEstimate]:  # fmt: skip
    """Both directions at once: what they have in common is computed once."""
    system, full = models
    parts = dict(branches.items())
    response = join(list(parts.values()))
    known = [after.get(way) or StatesAfter.unknown(len(part), system.size) for way, part in parts.items()]
    states = StatesAfter(*(np.concatenate([getattr(each, f.name) for each in known]) for f in fields(StatesAfter)))
    amplitude = case.amplitude_of(name, 2 * np.pi * response.frequency)
    whole = estimate_error(response, system, full, amplitude, case.sweep.output, states)
    ends = np.cumsum([len(part) for part in parts.values()])[:-1]
    pieces = {field.name: np.split(getattr(whole, field.name), ends) for field in fields(ErrorEstimate)}
    return {way: ErrorEstimate(**{name: pieces[name][i] for name in pieces}) for i, way in enumerate(parts)}


def _of_own_motions(
    case: Case, full: ImpactSystem, made: Mapping[str, FidelityEstimate], branches: Mapping[str, Branches]
) -> dict[str, FidelityEstimate]:
    """Estimates of one scene's fidelities, without the points at which its full model makes another motion."""
    expected = {
        name: {way: Motion.predicted(response, made[name].branches[way]) for way, response in branches[name].items()}
        for name in made
        if made[name].branches
    }
    if not expected:
        return dict(made)
    whole = next((n for n, each in made.items() if each.whole and case.fidelities[n].solver == "flight"), None)
    if whole is None:
        ways = [way for way, _ in branches[next(iter(expected))].items()]
        flown = _flown(case, next(iter(expected)), full, {way: [own[way] for own in expected.values()] for way in ways})
    else:
        flown = {way: Motion.of(response) for way, response in branches[whole].items()}
    return dict(made) | {
        name: replace(
            made[name],
            branches={
                way: without_another_motion(each, own[way], flown[way]) for way, each in made[name].branches.items()
            },
        )
        for name, own in expected.items()
    }


def _flown(case: Case, name: str, full: ImpactSystem, expected: Mapping[str, Sequence[Motion]]) -> Mapping[str, Motion]:
    """Motions of the full model of a fidelity's scene by direction, wherever some are expected."""
    if not any(each.known.any() for several in expected.values() for each in several):
        return {way: several[0] for way, several in expected.items()}
    omega = np.sort(2 * np.pi * case.sweep.frequency)
    sweep = FullSweep(full, float(omega[0]), case.sweep.settle, case.sweep.output)
    grids = {way: omega if way == "up" else omega[::-1] for way in expected}
    return {
        way: sweep.branch(grid, np.broadcast_to(case.amplitude_of(name, grid), grid.shape), expected[way])
        for way, grid in grids.items()
    }
