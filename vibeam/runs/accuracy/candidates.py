"""Candidates of the choice: one model with one solver, evaluated at single frequencies; distances of two."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.solver import FlightSolver
from vibeam.runs.accuracy.closed_forms import FREE, HARDER, ClosedForms, size
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arrays import Array, Index

OVER_AMPLITUDE = ("maximum", "minimum")  # quantities that may be zero: their errors are shares of the amplitude


def reading_of(quantities: Sequence[str]) -> int:
    """Level of detail that the flight solver must read off for the quantities."""
    return layout.REACH_TOO if "reach" in quantities else layout.OUTPUT_ALONE


def values(response: FrequencyResponse, quantities: Sequence[str]) -> Array:
    """Values (points, quantities)."""
    return np.stack([getattr(response, name) for name in quantities], axis=1)


def distance(found: FrequencyResponse, truth: FrequencyResponse, quantities: Sequence[str]) -> Array:
    """Signed relative errors (points, quantities); those of maximum and minimum over the amplitude.

    Zero where neither has a value (no impact, no velocity), ∞ where one alone has.
    """
    ours, theirs = values(found, quantities), values(truth, quantities)
    scales = [truth.amplitude if name in OVER_AMPLITUDE else getattr(truth, name) for name in quantities]
    with np.errstate(divide="ignore", invalid="ignore"):
        error = (ours - theirs) / np.abs(np.stack(scales, axis=1))
    error = np.where(ours == theirs, 0.0, error)
    neither = np.isnan(ours) & np.isnan(theirs)
    return np.asarray(np.where(neither, 0.0, np.where(np.isnan(error), np.inf, error)))


EXACT = 1e-5  # claimed error of the finest model itself: a flight is read off to about 1e-6
CLOSES = 1e-6  # tolerance, as a share of the state, for a state to be periodic
COLUMNS = tuple(each.name for each in fields(FrequencyResponse) if each.name != "frequency")
AVERAGED = ("amplitude", "reach", "impact_velocity")  # quantities that averaging gives


@dataclass
class Spent:
    """CPU seconds and number of points of one candidate, accumulated."""

    seconds: float = 0.0
    points: int = 0

    def add(self, begun: float, points: int) -> None:
        """Add the time since ``begun`` (``time.thread_time``) and ``points``."""
        self.seconds += time.thread_time() - begun
        self.points += points


class Evaluation(NamedTuple):
    """Values at some points, and a bound on the relative error of each against its model; NaN where failed."""

    response: FrequencyResponse
    error: Array


@dataclass(frozen=True, eq=False)
class Candidate:
    """Model ``fidelity`` with ``solver``; ``spent``: total cost of its evaluations."""

    fidelity: str
    solver: str
    known: ClosedForms
    quantities: tuple[str, ...]
    output: str
    flight: FlightSolver
    spent: Spent = field(default_factory=Spent)
    evaluated: dict[int, tuple[Evaluation, NDArray[np.bool_]]] = field(
        default_factory=dict
    )  # values by kind, and where known

    @property
    def label(self) -> str:
        """Name in tables."""
        return f"{self.fidelity} by {self.solver}"

    def evaluate(self, which: Index, kind: int) -> Evaluation:
        """Evaluate the motion of ``kind`` at the points ``which``; absent, unstable or inadmissible motions are NaN.

        Such a motion does not depend on the sweep's direction: values once computed are kept.
        """
        first = not self.evaluated
        if kind not in self.evaluated:
            self.evaluated[kind] = _nothing(self.known), np.zeros(len(self.known.omega), dtype=bool)
        kept, known_there = self.evaluated[kind]
        asked = np.unique(which[~known_there[which]])
        if len(asked):
            begun = time.thread_time()
            known = self.known.at(asked) if first else self.known
            found = _averaged(self, asked) if self.solver == "averaging" else _by_formula(self, known, asked, kind)
            put(kept.response, asked, found.response)
            kept.error[asked], known_there[asked] = found.error, True
            self.spent.add(begun, len(asked))
        return Evaluation(rows(kept.response, which), kept.error[which])

    def fly(self, points: Index, state: State | None, settle: int, hold: int) -> tuple[FrequencyResponse, list[State]]:
        """Points in order by flight, the state carried from each to the next; and the states after each."""
        begun = time.thread_time()
        states: list[State] = []
        reading, amplitude = reading_of(self.quantities), self.known.amplitude[points]
        alike = [points] if np.all(amplitude == amplitude[0]) else points[:, None]
        parts = []
        for some in alike:
            omega, base = self.known.omega[some], float(self.known.amplitude[some[0]])
            part, state = self.flight.steady(omega, base, state, settle, hold, self.output, reading, states)
            parts.append(part)
        self.spent.add(begun, len(points))
        return join(parts) if len(parts) > 1 else parts[0], states


def _nothing(known: ClosedForms) -> Evaluation:
    return Evaluation(
        FrequencyResponse.empty(known.omega / (2 * np.pi), known.system.size), np.full(len(known.omega), np.nan)
    )


def rows(response: FrequencyResponse, which: Index) -> FrequencyResponse:
    """Select some of the points."""
    return FrequencyResponse(**{name: getattr(response, name)[which] for name in ("frequency", *COLUMNS)})


def _by_formula(candidate: Candidate, known: ClosedForms, which: Index, kind: int) -> Evaluation:
    """Closed-form motion, verified by one period of flight: it must return, so that nothing was struck in between.

    ``known``: the candidate's closed forms at all points or at ``which``.
    """
    which = which if known is candidate.known else np.arange(len(which))
    response = FrequencyResponse.empty(known.omega[which] / (2 * np.pi), known.system.size)
    response.ended[:], error = Ended.NO_ORBIT.code, np.full(len(which), np.nan)
    stable = np.flatnonzero(known.radius(kind)[which] < 1)
    if not len(stable):
        return Evaluation(response, error)
    points = which[stable]
    states = known.states(points, kind)
    evaluated, after = candidate.flight.rounds(
        known.omega[points], known.amplitude[points], states, candidate.output, reading_of(candidate.quantities)
    )
    omega, system = known.omega[points], known.system
    misses = size(system, omega, after - states) / size(system, omega, states)
    closed = misses < CLOSES
    _put(response, stable[closed], replace(evaluated, **_impact_columns(known.velocity(points, kind), kind)), closed)
    error[stable[closed]] = EXACT
    return Evaluation(response, error)


def _impact_columns(velocity: Array, kind: int) -> dict[str, Any]:
    """Count the impact exactly once, wherever in the period it falls."""
    count, hits = len(velocity), kind != FREE
    kept = np.full((count, VELOCITIES_KEPT), np.nan)
    kept[:, -1] = velocity
    return {
        "impacts_per_period": np.full(count, 1.0 if hits else 0.0),
        "impact_velocity": velocity,
        "impact_velocities": kept,
        "period": np.full(count, 1 if hits else -1),
        "rest": np.zeros(count),
    }


def _averaged(candidate: Candidate, which: Index) -> Evaluation:
    """Stable averaged motion; its error against its model is unknown."""
    from vibeam.solvers.averaging import AveragingSolver

    curves = AveragingSolver(candidate.known.system).curves(
        candidate.known.omega[which], candidate.known.amplitude[which], candidate.output
    )
    response = FrequencyResponse.empty(candidate.known.omega[which] / (2 * np.pi), candidate.known.system.size)
    response.ended[:] = Ended.NO_ORBIT.code
    stable = curves.stable.any(axis=1)
    column = np.argmax(curves.stable, axis=1)
    rows = np.arange(len(which))
    parts = {"amplitude": curves.amplitude, "reach": curves.reach, "impact_velocity": curves.velocity}
    for name, part in parts.items():
        getattr(response, name)[stable] = part[rows, column][stable]
    response.ended[stable], response.period[stable] = Ended.COMPLETE.code, 1
    response.impacts_per_period[stable] = 1.0
    return Evaluation(response, np.where(stable, 0.0, np.nan))


def put(target: FrequencyResponse, at: Index, source: FrequencyResponse) -> None:
    """Copy points; modal energies are left out where the numbers of modes differ; the grid stays."""
    _put(target, at, source, np.ones(len(source), dtype=bool))


def _put(target: FrequencyResponse, at: Index, source: FrequencyResponse, chosen: NDArray[np.bool_]) -> None:
    for name in COLUMNS:
        ours, theirs = getattr(target, name), getattr(source, name)
        if ours.shape[1:] == theirs.shape[1:]:
            ours[at] = theirs[chosen]


def candidates_of(name: str, known: ClosedForms, quantities: tuple[str, ...], output: str) -> Sequence[Candidate]:
    """Candidates of a model, the cheapest first: averaging where possible, closed form, and flight for the rest."""
    flight = FlightSolver(known.system, float(np.min(known.omega)))
    solvers = ["averaging"] if _averages(known, quantities) else []
    return [Candidate(name, each, known, quantities, output, flight) for each in (*solvers, "orbit", "flight")]


def _averages(known: ClosedForms, quantities: Sequence[str]) -> bool:
    from vibeam.solvers.averaging import AveragingSolver

    if known.system.size > 1 or not set(quantities) <= set(AVERAGED):
        return False
    try:
        AveragingSolver(known.system)
    except ValueError:
        return False
    return True


def takes(candidate: Candidate, kind: int) -> bool:
    """Test whether the candidate can compute motions of that kind."""
    return candidate.solver != "averaging" or kind == HARDER
