"""Other models that might describe points which a case's model does not: one thing changed, the same keys estimated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.faults import CaseError
from vibeam.studies.fit.estimate import Minimum, Scan, best, met, settled
from vibeam.studies.fit.problem import Problem
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from vibeam.case.case import Case

UNITS = (1e3, 1e-3, 1e6, 1e-6)  # factors that a wrong unit makes
CLEAR = 0.5  # share of the loss that a factor must leave at most
MODES = 8
STARTS = 3  # of another model


@dataclass(frozen=True)
class Alternative:
    """Other model, in words, and its misfit of so many degrees of freedom."""

    called: str
    misfit: float
    freedom: int

    @property
    def met(self) -> bool:
        """Whether it describes the points."""
        return met(self.misfit, self.freedom)


def unit_factor(problem: Problem, scan: Scan) -> float:
    """Factor on the measured values, a power of 1000, with which the model comes much nearer to them; 1: none."""
    here = float(scan.losses(problem).min())
    found = {factor: float(scan.losses(problem, factor).min()) for factor in UNITS}
    factor = min(found, key=lambda each: found[each])
    return factor if found[factor] < CLEAR * here else 1.0


def alternatives(case: Case, problem: Problem, minimum: Minimum) -> tuple[Alternative, ...]:
    """Models with one thing changed, those that describe the points first."""
    found = []
    for called, settings in _changes(case, problem):
        try:
            made = Problem.of(replace(case.with_keys(settings), fit=case.fit))
        except (CaseError, ValueError):
            continue
        scan = Scan.of(made)
        order = np.argsort(scan.losses(made), kind="stable")[:STARTS]
        reached = best([settled(made, x) for x in (minimum.x, *scan.x[order])])
        found.append(Alternative(called, reached.misfit, reached.freedom))
    return tuple(sorted(found, key=lambda each: (not each.met, each.misfit)))


def _changes(case: Case, problem: Problem) -> Iterator[tuple[str, dict[str, Any]]]:
    """What is changed, in words, and the settings: conventions of numbers that are held, and the number of modes."""
    model = next(iter(problem.forward.values())).model
    estimated = [each.key for each in problem.keys]
    for number, words in (("gap", ("contact", "sensor")), ("restitution", ("contact", "first mode"))):
        key = "gap_at" if number == "gap" else "restitution_of"
        now = model.value(f"stop.{key}")
        if now in words and f"stop.{number}" not in estimated and model.value(f"stop.{number}"):
            other = words[1 - words.index(now)]
            yield f'stop.{key} = "{other}"', {f"stop.{key}": other}
    for name in problem.forward:
        fidelity = case.fidelities[name]
        counts = REDUCTIONS[fidelity.reduction].counts or fidelity.reduction == "static_mode"
        if counts and (fidelity.modes or 1) < MODES:
            settings = {f"fidelity.{name}.reduction": "modal", f"fidelity.{name}.modes": MODES}
            yield f"{MODES} modes in fidelity.{name}", settings
