"""Study of a case's ``accuracy``: model and solver for each point, the resulting curve, its verification."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import require_one_harmonic
from vibeam.runs.accuracy.candidates import Candidate, candidates_of
from vibeam.runs.accuracy.choice import BranchChoice, Choice
from vibeam.runs.accuracy.closed_forms import ClosedForms
from vibeam.runs.accuracy.finest import Finest, Position, track
from vibeam.runs.accuracy.unsettled import Unsettled
from vibeam.runs.accuracy.verification import POINTS, Verified, verify
from vibeam.runs.models import Model, equal
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


ENDS = {"up": ("up",), "down": ("down",), "both": ("up", "down")}


@dataclass(frozen=True)
class Chosen:
    """Use of one candidate: ``taken`` points of the result, ``asked`` in all, CPU seconds; largest ``estimate``."""

    fidelity: str
    solver: str
    modes: int
    taken: int
    asked: int
    cpu_seconds: float
    estimate: float


@dataclass(frozen=True, eq=False)
class Curve:
    """One direction: ``response`` in the order swept, and the fidelity and solver of each point.

    ``estimate``: relative error; ``statistical``: of the mean, because the motion is aperiodic, and ``scatter`` that of
    a single reading about it, NaN elsewhere. Quantities that were not asked for are NaN in the response.
    """

    response: FrequencyResponse
    fidelity: tuple[str, ...]
    solver: tuple[str, ...]
    estimate: Array
    statistical: NDArray[np.bool_]
    scatter: Array


@dataclass(frozen=True, eq=False)
class AccuracyChoice:
    """Result of a case's ``accuracy``. CPU time of the choice is everything but building the
    models, as that of a sweep is, and the verification.

    ``finest_seconds``: cost of the finest fidelity at every point by flight, extrapolated from the verified points.
    """

    within: float
    quantities: tuple[str, ...]
    finest: str
    curves: dict[str, Curve]
    chosen: tuple[Chosen, ...]
    verified: tuple[Verified, ...]
    cpu_seconds: float
    finest_seconds: float

    @property
    def points(self) -> int:
        """Number of points of all directions."""
        return sum(len(curve.response) for curve in self.curves.values())

    @property
    def share(self) -> float:
        """Cost relative to that of the finest fidelity at every point."""
        return self.cpu_seconds / self.finest_seconds if self.finest_seconds else float("nan")

    @property
    def missed(self) -> tuple[Verified, ...]:
        """Verified points outside the accuracy."""
        return tuple(each for each in self.verified if not each.passed)


def study(
    case: Case,
    within: float,
    quantities: tuple[str, ...] = ("amplitude",),
    systems: Mapping[str, ImpactSystem] | None = None,
    checks: int = POINTS,
) -> AccuracyChoice:
    """Compute the case's sweep within the relative error ``within`` of the finest fidelity by flight.

    ``systems`` of the fidelities, where built already; ``checks``: number of random points to verify.
    ValueError for a fidelity that cannot be built, or that knows more than modes, one stop and one restitution.
    """
    require_one_harmonic(case, "a choice within an accuracy")
    frequency = np.sort(case.sweep.frequency)
    omega = 2 * np.pi * frequency
    models = ordered_models(case, systems)
    offered = [_candidates(case, model, omega, quantities) for model in models]
    candidates = [candidate for several in offered for candidate in several]
    _warm_up(case, models, omega, quantities, within)
    begun = time.thread_time()
    branches = _branches(case, models[-1], candidates, omega, quantities, within)
    spent = time.thread_time() - begun
    verified = verify(branches, candidates[-1], case.sweep, within, checks)
    total = sum(len(branch.grid) for branch in branches)
    everywhere = total * float(np.mean([each.seconds for each in verified])) if verified else 0.0
    chosen = tuple(_use(candidate, number, branches) for number, candidate in enumerate(candidates))
    curves = {branch.direction: _curve(branch, candidates, frequency) for branch in branches}
    return AccuracyChoice(within, quantities, models[-1].name, curves, chosen, tuple(verified), spent, everywhere)


def _warm_up(
    case: Case, models: Sequence[Model], omega: Array, quantities: tuple[str, ...], within: float
) -> None:  # fmt: skip
    """Run the whole choice at the first frequency, unmeasured, with candidates that are then discarded."""
    short = replace(case, sweep=replace(case.sweep, frequency=omega[:1] / (2 * np.pi), settle=1, hold=2))
    candidates = [candidate for model in models for candidate in _candidates(short, model, omega[:1], quantities)]
    for candidate in candidates:
        if candidate.solver == "flight":
            candidate.fly(np.array([0]), None, 1, 2)
    _branches(short, models[-1], candidates, omega[:1], quantities, within)


def ordered_models(case: Case, systems: Mapping[str, ImpactSystem] | None = None) -> list[Model]:
    """Models of a case by number of modes, the finest one last; of equal systems the first.

    The finest has most modes, preferably among those without changes to the physics, and is the first of
    several. Others with as many modes cost as much, and are left out. ValueError for one that cannot be built.
    """
    found: list[Model] = []
    for name, fidelity in case.fidelities.items():
        model = Model(name, fidelity, case.system(name) if systems is None else systems[name])
        if not any(equal(model.system, other.system) for other in found):
            found.append(model)
    own = [model for model in found if not model.fidelity.changes] or found
    finest = max(own, key=lambda model: model.system.size)
    cheaper = [model for model in found if model.system.size < finest.system.size]
    return [*sorted(cheaper, key=lambda model: model.system.size), finest]


def _candidates(case: Case, model: Model, omega: Array, quantities: tuple[str, ...]) -> Sequence[Candidate]:
    amplitude = np.broadcast_to(np.asarray(case.amplitude_of(model.name, omega), dtype=float), omega.shape)
    return candidates_of(model.name, ClosedForms(model.system, omega, amplitude), quantities, case.sweep.output)


def _branches(
    case: Case, model: Model, candidates: list[Candidate], omega: Array, quantities: tuple[str, ...], within: float
) -> list[BranchChoice]:
    flown = [i for i, candidate in enumerate(candidates) if candidate.solver == "flight"]
    formulas = [i for i, candidate in enumerate(candidates) if candidate.solver != "flight"]
    choice = Choice([candidates[i] for i in formulas], formulas, quantities, within)
    unsettled = Unsettled([candidates[i] for i in flown], flown, quantities, within, case.sweep)
    finest = Finest(candidates[formulas[-1]], formulas[-1], candidates[flown[-1]], flown[-1], case.sweep, within)
    up, position, branches = np.arange(len(omega)), Position(), []
    for direction in ENDS[case.sweep.direction]:
        branch = BranchChoice.blank(
            direction, up if direction == "up" else up[::-1], omega / (2 * np.pi), model.system.size
        )
        position = track(branch, finest, position, choice.settle, unsettled.settle)
        unsettled.remember(branch)
        branches.append(branch)
    return branches


def _use(candidate: Candidate, number: int, branches: list[BranchChoice]) -> Chosen:
    taken = sum(int(np.count_nonzero(branch.candidate == number)) for branch in branches)
    claims = np.concatenate([branch.estimate[branch.candidate == number] for branch in branches])
    worst = float(np.max(claims)) if len(claims) else float("nan")
    spent = candidate.spent
    return Chosen(
        candidate.fidelity, candidate.solver, candidate.known.system.size, taken, spent.points, spent.seconds, worst
    )


def _curve(branch: BranchChoice, candidates: list[Candidate], frequency: Array) -> Curve:
    """A branch at the very frequencies of the case, which the rates in between hold to their last digit only."""
    names = [candidates[number].fidelity for number in branch.candidate]
    solvers = [candidates[number].solver for number in branch.candidate]
    response = replace(branch.response, frequency=frequency[branch.grid])
    return Curve(response, tuple(names), tuple(solvers), branch.estimate, branch.statistical, branch.scatter)
