"""Integration with event detection: scipy's solvers stop at each impact and restart after it.

Difficulties of event detection at impacts, and their treatment:

- A flight starts on the stop, where the distance is zero already. The event function is therefore the contact's
  excess over the stop *divided by the time since the impact*: it starts at minus the speed of leaving, so that even a
  flight that ends within the first step has a sign change, and the start itself is no root.
- A step may go through the stop and come back. The cubics through the contact's values and rates at the ends of every
  step are searched for such a turn, and the step's dense output for the impact before it.
- An accumulation of impacts never ends. A flight that would rise less than ``atol`` (u²/2a with a the acceleration
  toward the stop) is none: the contact is plastic there, and the system held on the stop is integrated until the
  contact force changes sign. Where no flight gets that small (R = 1 on a pressed stop) ``limit`` events in one drive
  period end the run.
- Modes far too fast for an explicit method would take for ever: ``EVALUATIONS`` in one drive period end the run too.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from contextlib import nullcontext
from threading import Lock
from typing import Any

import numpy as np

from vibeam.solvers.integration.coordinates import Frame, IntegrationSettings
from vibeam.solvers.integration.samples import SampledPiece, SteppedOutcome, turning_points
from vibeam.solvers.integration.stepper import NO_MARKS, AdaptiveStepper, Watch, cycle, pause_at, slack
from vibeam.system.impact_system import Drive
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array

PER_STEP = 4  # samples a step of the integrator
LONGEST = 1 / 8  # longest step, as a share of the drive period
TINY = 1e-300
DEEP = 1e-2  # tolerance, as a share of atol, before a passage of the stop counts as an impact
ROUNDING = 1e-15
STUCK = 1e-12  # share of a period below which a flight counts as not begun
EVALUATIONS = 1_000_000  # of the right-hand side in a drive period: modes far too fast take more
ONE_AT_A_TIME = Lock()  # before scipy 1.17, LSODA keeps its state in one place for all threads


class TooManyEvaluations(Exception):
    """More evaluations than may be in a drive period."""


class EvaluationCount:
    """Number of evaluations; more than ``limit`` in one ``period`` (s) are TooManyEvaluations."""

    def __init__(self, period: float, limit: int) -> None:
        self.period, self.limit, self.all = period, limit, 0
        self._turn, self._before = -1.0, 0

    def add(self, t: float) -> None:
        """Count one more, at time ``t`` s."""
        pause_at(self.all)
        self.all += 1
        turn = t // self.period
        if turn > self._turn:
            self._turn, self._before = turn, self.all
        if self.all - self._before > self.limit:
            raise TooManyEvaluations


class EventSolver(AdaptiveStepper):
    """Base class of the solvers with events; they differ in the ``Frame`` of their flights."""

    @abstractmethod
    def enter(self, drive: Drive, state: State) -> tuple[Frame, Array]:
        """Frame and state of the first flight."""

    def run(
        self, drive: Drive, state: State, start: float, end: float, watch: Watch | None = None, marks: Array = NO_MARKS
    ) -> SteppedOutcome:
        """See ``Stepper.run``."""
        frame, y = self.enter(drive, state)
        event_run = EventRun(frame, y, self.settings, cycle(self.system, drive), start, end, watch, marks)
        with np.errstate(all="ignore"):
            ended = event_run.advance(slack(self.system, state.displacement) + self.settings.atol, state.resting)
        return event_run.outcome(ended)


class EventRun:
    """Progress of one run: its present state and its counters."""

    def __init__(
        self, frame: Frame, y: Array, settings: IntegrationSettings, period: float, start: float, end: float,
        watch: Watch | None, marks: Array,
    ) -> None:  # fmt: skip
        self.frame, self.y, self.settings, self.period = frame, y, settings, period
        self.t, self.end, self.watch, self.marks = start, end, watch, marks
        self.touching = self.resting = False
        self.impacts, self.evaluations = 0, EvaluationCount(period, EVALUATIONS)
        self.turn, self.events, self.longest = -1.0, 0, LONGEST * period
        self.atol = settings.atol * frame.scale
        self.deep = max(DEEP * settings.atol, ROUNDING * float(np.max(np.abs(y / frame.scale))))

    def advance(self, allowed: float, resting: bool) -> Ended:
        """Advance through flights, impacts and rests to the end; the start may lie ``allowed`` m beyond the stop."""
        try:
            return self._advanced(allowed, resting)
        except TooManyEvaluations:
            return Ended.UNRESOLVED

    def outcome(self, ended: Ended) -> SteppedOutcome:
        """Outcome of the run, which ended so."""
        pose = self.frame.outward(self.y[:, None])[0]
        state = State.reached(pose[0], pose[1], self.resting)
        return SteppedOutcome(ended, self.t, state, self.impacts, self.evaluations.all)

    def _advanced(self, allowed: float, resting: bool) -> Ended:
        excess = self.frame.excess(self.y)
        if excess > allowed:
            return Ended.PENETRATED
        if excess >= 0 or (resting and excess >= -allowed):
            self.touch_down()
        while self.t < self.end:
            if not self._within_limit():
                return Ended.EVENT_LIMIT
            before = self.t
            struck = self.rest() if self.resting else self.integrate_flight()
            if not np.all(np.isfinite(self.y)):
                return Ended.NOT_FINITE
            if struck:
                self.touch_down(self.t - before < STUCK * self.period)
        if self.frame.excess(self.y) > 0:
            self.y = self.frame.touch(self.y)
        return Ended.COMPLETE

    def _within_limit(self) -> bool:
        turn = self.t // self.period
        self.events = self.events + 1 if turn == self.turn else 1
        self.turn = turn
        return self.events <= self.settings.limit

    def touch_down(self, stuck: bool = False) -> None:
        """Treat contact at the stop: impact if approached, then a flight, or rest where that would rise below atol.

        ``stuck``: the last flight ended where it began: a start without speed under a growing force.
        """
        self.y = self.frame.touch(self.y)
        if self.frame.approach(self.y) > 0:
            self.frame, self.y = self.frame.strike(self.y)
            self.impacts += 1
        away, press = self.frame.approach(self.y), self.frame.press(self.t, self.y)
        self.touching = True
        self.resting = bool(stuck or (press > 0 and away**2 <= 2 * press * self.settings.atol))
        if self.resting:
            self.y = self.frame.hold(self.y)

    def integrate_flight(self) -> bool:
        """Integrate one flight; return whether it ends at the stop."""
        event = self._event()
        found = self._solve(self.frame.rate, event, self.watch is not None)
        if found is None:
            return False
        times, states, struck = found.t, found.y, bool(found.status == 1)
        passed = self._missed_passage(times, states)
        if passed is not None:
            found = found if found.sol is not None else self._solve(self.frame.rate, event, True)
            root = self._first_root(event, found.sol, *passed)
            if root is not None:
                times, struck = np.append(times[times < root], root), True
                states = found.sol(times)
        self._advance_to(found, times, states, struck)
        return struck

    def rest(self) -> bool:
        """Integrate the rest on the stop until the contact force changes sign; then, or at the end, nothing strikes."""
        event = self.frame.press
        found = self._solve(self.frame.rate_at_rest, _terminal(lambda t, y: event(t, y), -1.0), self.watch is not None)
        if found is not None:
            self._advance_to(found, found.t, found.y, False, rest=float(found.t[-1]) - self.t)
            self.y = self.frame.hold(self.y)
            self.resting, self.touching = found.status == 0, True
        return False

    def _event(self) -> Any:
        """Event function: excess over the stop; for a start on the stop, divided by the time since then."""
        frame, start, leaving = self.frame, self.t, min(self.frame.approach(self.y), -TINY)
        if not self.touching:
            return _terminal(lambda t, y: frame.excess(y), 1.0)
        height = frame.excess(self.y)
        return _terminal(lambda t, y: (frame.excess(y) - height) / (t - start) if t > start else leaving, 1.0)

    def _solve(self, rate: Callable[[float, Array], Any], event: Any, dense: bool) -> Any:
        from scipy.integrate import solve_ivp

        def interruptible(t: float, y: Array) -> Any:
            self.evaluations.add(t)
            return rate(t, y)

        with ONE_AT_A_TIME if self.settings.method == "LSODA" else nullcontext():
            found = solve_ivp(
                interruptible, (self.t, self.end), self.y, method=self.settings.method, rtol=self.settings.rtol,
                atol=self.atol, events=event, dense_output=dense, max_step=self.longest,
            )  # fmt: skip
        if found.status < 0:
            self.y = np.full_like(self.y, np.nan)
            return None
        return found

    def _missed_passage(self, times: Array, states: Array) -> tuple[float, float] | None:
        """Begin of the first step inside which the contact turns beyond the stop, and time of that turn."""
        shares, heights = turning_points(times, self.frame.excess(states), self.frame.approach(states))
        beyond = np.where(shares * (1 - shares) > 0, heights, -np.inf)
        steps = np.flatnonzero(np.max(beyond, axis=0) > self.deep)
        if not len(steps):
            return None
        i = steps[0]
        share = shares[np.argmax(beyond[:, i]), i]
        return float(times[i]), float(times[i] + share * (times[i + 1] - times[i]))

    @staticmethod
    def _first_root(event: Any, dense: Any, before: float, turn: float) -> float | None:
        """Impact before the turn; None where the dense output does not reach the stop."""
        from scipy.optimize import brentq

        if event(turn, dense(turn)) <= 0:
            return None
        return float(brentq(lambda t: event(t, dense(t)), before, turn, xtol=1e-14 * abs(turn) + TINY, rtol=1e-15))

    def _advance_to(self, found: Any, times: Array, states: Array, struck: bool, rest: float = 0.0) -> None:
        """Move to the last state and pass the stretch to the observer."""
        self.t, self.y, self.touching = float(times[-1]), states[:, -1], False
        if self.watch is None:
            return
        speed = float(self.frame.approach(self.y))
        count = 1 if struck and speed > 0 else 0
        at = samples(times, self.marks)
        values = self.frame.outward(found.sol(at))
        self.watch(SampledPiece(at, values, np.full(count, self.t), np.full(count, speed), rest))


def samples(times: Array, marks: Array) -> Array:
    """Sample times: ``PER_STEP`` a step, and the marks inside."""
    shares = np.arange(PER_STEP) / PER_STEP
    between = (times[:-1, None] + np.diff(times)[:, None] * shares).ravel()
    inside = marks[(marks > times[0]) & (marks < times[-1])]
    return np.unique(np.concatenate([between, times[-1:], inside]))


def _terminal(function: Callable[[float, Array], Any], direction: float) -> Any:
    function.terminal, function.direction = True, direction  # type: ignore[attr-defined]
    return function
