"""Fidelity that suffices at each value of the factor that a record varies: the cheapest within the accuracy.

Cheapest is the one with the fewest modes, of several the one that took the least CPU time: that of one short motion is
too uncertain to tell one mode from two.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.runs.transient.run import run_record
from vibeam.studies.changes import NumberChange, change_of, worst
from vibeam.studies.variants import Told, usual_numbers
from vibeam_models.arrays import ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.transient.comparison import TransientComparison
    from vibeam.runs.transient.result import TransientResult


@dataclass(frozen=True)
class FidelityAtValue:
    """One fidelity at one value of the factor: its changes from the finest, as shares.

    ``horizon``: share of the record until which its impacts pair with the finest's, the mean over the seeds;
    ``own_horizon``: the same of the finest with itself under a load larger by 1e-6. CPU time of a motion, s.
    """

    fidelity: str
    changes: tuple[NumberChange, ...]
    seconds: float
    horizon: float
    own_horizon: float

    @property
    def worst(self) -> float:
        """Largest change of the peaks, its error counted twice; NaN where none is known."""
        return worst(self.changes)


@dataclass(frozen=True)
class ValueVerdict:
    """Verdict at one ``value`` of the factor: ``cheapest`` fidelity within the accuracy, and each with its differences.

    The finest itself, which was flown there, where no other is within.
    """

    value: float
    cheapest: str
    rows: tuple[FidelityAtValue, ...]


@dataclass(frozen=True, eq=False, repr=False)
class RecordFidelities(ValueRecord):
    """Verdicts over the values of a record's factor, against the ``finest`` fidelity on the same realisations."""

    case: Case
    accuracy: float
    finest: str
    values: tuple[ValueVerdict, ...]
    realisations: int
    left_out: tuple[str, ...] = ()


def record_fidelities(case: Case, accuracy: float, told: Told | None = None) -> RecordFidelities:
    """Run a case and say, at each value of its factor, which fidelity is the cheapest within the ``accuracy``.

    Fidelities that change the rig as the finest does not are left out. ValueError where fewer than two remain.
    """
    silent: Any = lambda *each: None  # noqa: E731
    return judged(run_record(case, None, told or silent, False, silent), accuracy)


def judged(result: TransientResult, accuracy: float) -> RecordFidelities:
    """Verdicts of a run; ValueError as ``record_fidelities``."""
    finest = next(iter(dict.fromkeys(result.finest.values())))
    names = [name for name, top in result.finest.items() if top == finest]
    if len(names) < 2:
        raise ValueError("fewer than two fidelities of one rig: there is none to compare with the finest")
    values = tuple(_verdict(result, at, names, finest, accuracy) for at in range(len(result.factors)))
    count = max(len(plan_of_record(result.case).seeds), 1)
    left_out = tuple(name for name in result if name not in names)
    return RecordFidelities(result.case, accuracy, finest, values, count, left_out)


def _verdict(result: TransientResult, at: int, names: list[str], finest: str, accuracy: float) -> ValueVerdict:
    rows = tuple(_row(result, at, name, result.comparison[name]) for name in names if name != finest)
    within = [row for row in rows if row.worst <= accuracy]
    cheapest = min(within, key=lambda row: (result[row.fidelity].modes, row.seconds)).fidelity if within else finest
    return ValueVerdict(result.factors[at], cheapest, rows)


def _row(result: TransientResult, at: int, name: str, found: TransientComparison) -> FidelityAtValue:
    own, top = result[name], result[found.finest]
    mine = tuple(
        change_of(each, *(one.of(each.quantity, each.signal or None)[at] for one in (top, own)))
        for each in usual_numbers(result.case)
    )
    horizon = float(np.nanmean(found.horizon[at])) / found.duration if np.isfinite(found.horizon[at]).any() else np.nan
    seconds = float(np.mean(own.cpu_seconds[at]))
    return FidelityAtValue(name, mine, seconds, horizon, float(found.own_horizon[at]) / found.duration)
