"""Motions of a case under its record: which there are, the key of each, flown and read off."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.observe.decimation import BINS, MOST_BINS, History
from vibeam.runs.transient.reading import Reading, reading_of
from vibeam.runs.transient.signals import TransientSignal, signals_of, with_signals
from vibeam.solvers import SOLVERS, solver
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.observe.motion import Path
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.record import Record

SCALED = ("level", "speed")  # factors of the record itself
READ_AS = 2  # raised where readings mean something else: motions of older files are run anew
WARM_UP = 1e-3  # share of a motion that is flown before
NUDGE = 1e-6  # by which the load of a twin is larger, or the start of a free one smaller


@dataclass(frozen=True)
class Realisation:
    """Realisation, one motion of a case: fidelity, numbers of its value and seed; ``shown``: its histories are kept.

    ``twin``: of the finest fidelity, under a load larger by 1e-6. ``key``: of all that decides its numbers.
    """

    fidelity: str
    value: int
    seed: int
    shown: bool
    twin: bool
    key: str


def shown_at(case: Case) -> tuple[int, int]:
    """Numbers of the value and the seed of the motion whose histories are kept: the level or speed nearest 1."""
    values = np.asarray(plan_of_record(case).values, dtype=float)
    nearest = int(np.argmin(np.abs(values - 1))) if plan_of_record(case).over in SCALED else 0
    return nearest, 0


def motions_of(case: Case, name: str, twins: bool = False) -> Iterator[Realisation]:
    """Motions of one fidelity, of one seed after the other; ``twins``: the finest's, of the first seed."""
    plan, shown = plan_of_record(case), shown_at(case)
    for j, seed in enumerate((0,) if twins else plan.seeds or (0,)):
        for i, value in enumerate(plan.values):
            kept = (i, j) == shown and not twins
            said = f"{READ_AS} {case.own[name]} {value!r} {seed if plan.seeds else None} {kept} {twins}"
            yield Realisation(name, i, j, kept, twins, sha256(said.encode()).hexdigest())


class MotionMaker:
    """Maker of the motions of one fidelity: its systems, loads and starts, made when first asked for."""

    def __init__(self, case: Case, name: str) -> None:
        self.case, self.name = case, name
        self._cases: dict[int, Case] = {}
        self._starts: dict[int, State] = {}
        self._systems: dict[int, tuple[ImpactSystem, tuple[TransientSignal, ...]]] = {}

    @property
    def fidelity(self) -> Fidelity:
        """The fidelity."""
        return self.case.fidelities[self.name]

    @property
    def duration(self) -> float:
        """Duration of each motion, s."""
        return plan_of_record(self.case).duration

    @property
    def exact(self) -> bool:
        """Test whether its motions are exact, and not known by samples alone."""
        return SOLVERS[self.fidelity.solver].motion == "exact"

    @property
    def signals(self) -> tuple[TransientSignal, ...]:
        """Signals of the fidelity."""
        return self.system(0)[1]

    def system(self, value: int) -> tuple[ImpactSystem, tuple[TransientSignal, ...]]:
        """System at one of the values, with its signals; they are the same at all values of level and speed."""
        at = self._number(value)
        if at not in self._systems:
            bare = self._at(value).system(self.name)
            signals = tuple(signals_of(self.case, bare, plan_of_record(self.case).outputs))
            self._systems[at] = with_signals(bare, signals), signals
        return self._systems[at]

    def load(self, value: int, seed: int) -> Record:
        """Load of a motion."""
        plan = plan_of_record(self.case)
        own = {plan.over: plan.values[value]} if plan.over in SCALED else {}
        made: Record = self._at(value).input(self.name, plan.seeds[seed] if plan.seeds else None, **own)
        return made

    def made(self, motion: Realisation) -> Reading:
        """Reading of a motion."""
        record = self.load(motion.value, motion.seed)
        path, seconds = self.path(motion.value, record, nudged=motion.twin)
        if not path.t_end > path.t_start:
            return {"ended": np.asarray(getattr(path, "ended", Ended.NOT_FINITE).code)}  # where it began
        bins = self.bins_of(path.t_end - path.t_start) if motion.shown else None
        return reading_of(path, record, self.system(motion.value)[1], seconds, bins)

    def bins_of(self, span: float) -> int:
        """Bins of the histories that are kept of a motion of ``span`` s."""
        rate = plan_of_record(self.case).rate
        return BINS if rate is None else int(np.clip(round(rate * span), 1, MOST_BINS))

    def warm_up(self) -> None:
        """Fly the first thousandth of a motion, unmeasured: loading and compiling are no part of a motion's cost."""
        self.path(0, self.load(0, 0), WARM_UP * self.duration)

    def path(
        self, value: int, record: Record, until: float | None = None, nudged: bool = False
    ) -> tuple[Path, float]:  # fmt: skip
        """Motion under a load at one of the values, and its CPU time, s; ``until``: its end, None: the record's.

        ``nudged``: what it does to the system is larger by 1e-6; of a free motion its start is smaller by that.
        """
        system, plan, fidelity = self.system(value)[0], plan_of_record(self.case), self.fidelity
        start, end = self._start(value), self.duration if until is None else until
        if nudged and record.peak:
            system = replace(system, load=(1 + NUDGE) * system.load)
        elif nudged:
            start = State((1 - NUDGE) * start.displacement, (1 - NUDGE) * start.velocity, start.resting)
        begun = time.thread_time()
        if self.exact:
            from vibeam.flight.trajectory import simulate

            path: Any = simulate(system, record, end, start, certify=plan.certify)
        else:
            runner = solver(fidelity.solver, system, 2 * np.pi / end, end, **fidelity.options)
            path = runner.record_motion(record, start, 0.0, end)
        taken = time.thread_time() - begun
        return path, getattr(path, "stats", {}).get("cpu_seconds", taken)

    def period(self) -> float:
        """First natural period, s; NaN of a system without stiffness."""
        rates = self.system(0)[0].omega
        return 2 * np.pi / float(np.min(rates[rates > 0])) if np.any(rates > 0) else float("nan")

    def _number(self, value: int) -> int:
        """Number of the system at one of the values: level and speed have one."""
        return 0 if plan_of_record(self.case).over in SCALED else value

    def _start(self, value: int) -> State:
        """State at the start at one of the values."""
        at = self._number(value)
        if at not in self._starts:
            self._starts[at] = self._at(value).start(self.name)
        return self._starts[at]

    def _at(self, value: int) -> Case:
        """The case at one of the values of a key."""
        plan = plan_of_record(self.case)
        if plan.over in SCALED:
            return self.case
        if value not in self._cases:
            self._cases[value] = self.case.with_keys({plan.over: plan.values[value]})
        return self._cases[value]


def histories_of(reading: Reading, signals: tuple[TransientSignal, ...]) -> dict[str, History]:
    """Histories that a reading has, by signal."""
    return {
        signal.name: _history(reading, reading["history_least"][number], reading["history_greatest"][number])
        for number, signal in enumerate(signals)
    }


def input_of(reading: Reading) -> History:
    """History of the load that a reading has."""
    return _history(reading, reading["input_least"], reading["input_greatest"])


def _history(reading: Reading, least: Array, greatest: Array) -> History:
    begin, end = reading["history_edges"]
    return History(np.linspace(begin, end, len(least) + 1), least, greatest)
