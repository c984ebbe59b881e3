"""Study of a case's ``accuracy``: model and solver for each point, the resulting curve, its verification."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.run.accuracy.candidates import Candidate, rungs_of
from vibeam.run.accuracy.choice import Choice
from vibeam.run.accuracy.choices import BranchChoice
from vibeam.run.accuracy.closed_forms import ClosedForms
from vibeam.run.accuracy.finest import Finest, Position, track
from vibeam.run.accuracy.unsettled import Unsettled
from vibeam.run.accuracy.verification import POINTS, Verified, verify
from vibeam.run.models import Model, equal
from vibeam.system.response import FrequencyResponse

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


Array = NDArray[np.float64]

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
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    models = ladder_models(case, systems)
    offered = [_offered(case, model, omega, quantities) for model in models]
    rungs = [rung for several in offered for rung in several]
    _warm_up(case, models, omega, quantities, within)
    begun = time.thread_time()
    sheets = _sheets(case, models[-1], rungs, omega, quantities, within)
    spent = time.thread_time() - begun
    verified = verify(sheets, rungs[-1], case.sweep, within, checks)
    total = sum(len(sheet.grid) for sheet in sheets)
    everywhere = total * float(np.mean([each.seconds for each in verified])) if verified else 0.0
    chosen = tuple(_share(rung, number, sheets) for number, rung in enumerate(rungs))
    curves = {sheet.way: _curve(sheet, rungs) for sheet in sheets}
    return AccuracyChoice(within, quantities, models[-1].name, curves, chosen, tuple(verified), spent, everywhere)


def _warm_up(
    case: Case, models: Sequence[Model], omega: Array, quantities: tuple[str, ...], within: float
) -> None:  # fmt: skip
    """Run the whole choice at the first frequency, unmeasured, with candidates that are then discarded."""
    short = replace(case, sweep=replace(case.sweep, frequency=omega[:1] / (2 * np.pi), settle=1, hold=2))
    rungs = [rung for model in models for rung in _offered(short, model, omega[:1], quantities)]
    for rung in rungs:
        if rung.solver == "flight":
            rung.fly(np.array([0]), None, 1, 2)
    _sheets(short, models[-1], rungs, omega[:1], quantities, within)


def ladder_models(case: Case, systems: Mapping[str, ImpactSystem] | None = None) -> list[Model]:
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


def _offered(case: Case, model: Model, omega: Array, quantities: tuple[str, ...]) -> Sequence[Candidate]:
    amplitude = np.broadcast_to(np.asarray(case.amplitude_of(model.name, omega), dtype=float), omega.shape)
    return rungs_of(model.name, ClosedForms(model.system, omega, amplitude), quantities, case.sweep.output)


def _sheets(
    case: Case, model: Model, rungs: list[Candidate], omega: Array, quantities: tuple[str, ...], within: float
) -> list[BranchChoice]:
    flown = [i for i, rung in enumerate(rungs) if rung.solver == "flight"]
    formulas = [i for i, rung in enumerate(rungs) if rung.solver != "flight"]
    ladder = Choice([rungs[i] for i in formulas], formulas, quantities, within)
    loose = Unsettled([rungs[i] for i in flown], flown, quantities, within, case.sweep)
    finest = Finest(rungs[formulas[-1]], formulas[-1], rungs[flown[-1]], flown[-1], case.sweep, within)
    up, here, sheets = np.arange(len(omega)), Position(), []
    for way in ENDS[case.sweep.direction]:
        sheet = BranchChoice.blank(way, up if way == "up" else up[::-1], omega / (2 * np.pi), model.system.size)
        here = track(sheet, finest, here, ladder.settle, loose.settle)
        loose.remember(sheet)
        sheets.append(sheet)
    return sheets


def _share(rung: Candidate, number: int, sheets: list[BranchChoice]) -> Chosen:
    taken = sum(int(np.count_nonzero(sheet.rung == number)) for sheet in sheets)
    claims = np.concatenate([sheet.estimate[sheet.rung == number] for sheet in sheets])
    worst = float(np.max(claims)) if len(claims) else float("nan")
    spent = rung.spent
    return Chosen(rung.fidelity, rung.solver, rung.known.system.size, taken, spent.points, spent.seconds, worst)


def _curve(sheet: BranchChoice, rungs: list[Candidate]) -> Curve:
    names = [rungs[number].fidelity for number in sheet.rung]
    solvers = [rungs[number].solver for number in sheet.rung]
    return Curve(sheet.response, tuple(names), tuple(solvers), sheet.estimate, sheet.statistical, sheet.scatter)
