"""Row of one run: errors against the reference and its own fidelity, their parts, and the work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.run.models import Model
from vibeam.studies.cost.error_split import Part, part, shares
from vibeam.studies.cost.errors import Errors, errors
from vibeam.studies.cost.measure import Measured, Plan
from vibeam.studies.cost.settings import Setting
from vibeam.studies.cost.work import Work
from vibeam.system.response import Ended, complete

PARTS = ("solver", "settling", "modelling", "total")


@dataclass(frozen=True)
class RunRow:
    """One run: ``total`` error against the reference, ``numerical`` against the exact motion of its own fidelity.

    ``parts`` of its amplitude's error, which add up: solver, settling, modelling. ``why``: reason of a
    failure; the errors are then NaN.
    """

    fidelity: str
    modes: int
    solver: str
    method: str
    setting: str
    total: Errors
    numerical: Errors
    parts: tuple[Part, ...]
    work: Work | None
    found: int = 0  #: frequencies at which it found a motion
    why: str = ""

    @property
    def label(self) -> str:
        """Solver and its setting."""
        return " ".join(filter(None, (self.solver, self.method, self.setting)))


@dataclass(frozen=True)
class References:
    """References of a run: its fidelity's exact motion, settled as long as the run (``short``) and as long as
    needed (``own``), and the reference.
    """

    short: Measured
    own: Measured
    reference: Measured


def stopped(model: Model, setting: Setting, why: str) -> RunRow:
    """Row of a run that did not end."""
    return _row(model, setting, Errors(), Errors(), (), None, 0, why)


def compared(model: Model, setting: Setting, plan: Plan, found: Measured, work: Work, references: References) -> RunRow:
    """Row of a run that ended, with or without failed points."""
    motions = int(np.count_nonzero(complete(found.response)))
    if found.failure:
        return _row(model, setting, Errors(), Errors(), (), work, motions, found.failure)
    total, numerical = (errors(found, truth, plan) for truth in (references.reference, references.own))
    why = "" if total.amplitude.points or np.isfinite(total.statistics) else _nothing(found)
    chain = (found, references.short, references.own, references.reference)
    parts = tuple(part(name, each) for name, each in zip(PARTS, shares([c.response for c in chain]), strict=True))
    return _row(model, setting, total, numerical, parts, work, motions, why)


def _row(
    model: Model, setting: Setting, total: Errors, numerical: Errors, parts: tuple[Part, ...], work: Work | None,
    motions: int, why: str,
) -> RunRow:  # fmt: skip
    return RunRow(
        model.name, model.system.size, setting.solver, setting.method, setting.setting,
        total, numerical, parts, work, motions, why,
    )  # fmt: skip


def _nothing(found: Measured) -> str:
    none = np.all(found.response.ended == Ended.NO_ORBIT.code)
    return Ended.NO_ORBIT.value if none else "no frequency at which both its motion and the reference's repeat"
