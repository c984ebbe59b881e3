"""Number of modes that a case needs: what is known of it before any flight, then every reduction, then the limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from vibeam.case.case import Case
from vibeam.case.held import Held, held_of, holding, other_choice
from vibeam.case.source import of_source
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.studies.modes_needed.bases import ReductionBasis
from vibeam.studies.modes_needed.limit import LimitRow, limit
from vibeam.studies.modes_needed.losses import ResponseError
from vibeam.studies.modes_needed.reduction import Recommendation, ReductionProblem, ReductionStudy, least, plan_asked
from vibeam.studies.modes_needed.response import Claim
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import ValueRecord
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS

NOWHERE = "no stable motion with at most one impact a drive period at any frequency of the sweep"
MODAL = ReductionBasis("modal", REDUCTIONS["modal"])


@dataclass(frozen=True)
class ClosedErrors:
    """Errors against all modes at the motions of a case that have a closed form, with a coefficient ``held``.

    ``rows``: of 1, 2 … modes; from ``enough`` modes on they are within the accuracy, None: not with so many.
    ``single``: of one degree of freedom along the static deflection at the contact, the paper's.
    """

    held: Held
    rows: tuple[ResponseError, ...]
    enough: int | None
    single: ResponseError


@dataclass(frozen=True)
class BeforeFlight:
    """Knowledge of the number of modes before anything is flown, against all modes as the ``claim`` says.

    ``choices``: errors with what the case holds, then with the other coefficient of restitution held where all modes
    can have it. Where no motion has a closed form there are none, for the reason ``why``; ``by_losses`` is then the
    number of modes by the losses of one impact, which claim nothing of the response.
    """

    claim: Claim
    choices: tuple[ClosedErrors, ...] = ()
    why: str = ""
    by_losses: int | None = None


@dataclass(frozen=True, eq=False, repr=False)
class ModesNeeded(ValueRecord, ViewedTable):
    """Number of modes, and of coordinates of other bases, that a case needs, by a ``plan``.

    ``before``: errors of n modes with either restitution held; ``reduction``: errors and losses of every basis, and the
    n that is recommended; ``limits``: what converges with more and more modes, how fast, ``no_limits``: why none are
    known.
    """

    case: Case
    plan: ModesNeededPlan
    before: BeforeFlight
    reduction: ReductionStudy
    limits: tuple[LimitRow, ...]
    no_limits: str = ""

    @property
    def recommended(self) -> Recommendation | None:
        """Recommendation of natural modes where they were asked for, else of the basis with fewest coordinates."""
        can = [each for each in self.reduction.recommended if not each.why]
        return min(can, key=lambda each: (each.basis != MODAL.name, each.modes or inf), default=None)


@of_source
def modes_needed(case: Case, /, plan: ModesNeededPlan | None = None, **settings: Any) -> ModesNeeded:
    """Number of modes that a case needs: ``vibeam.modes_needed(case, accuracy="1 %", bases=["modal"])``.

    ``settings``: of the ``plan``, in SI or with units. Flown is the sweep where motions have no closed form.
    ValueError for a case of one degree of freedom, an unknown basis, or settings outside their range.

    >>> import vibeam
    >>> found = vibeam.modes_needed("cases/dtu_neutral.toml", accuracy="5 %", most=3, bases=["modal"], modes=8)
    >>> found.recommended.modes  # coordinates
    2
    """
    asked = plan_asked(case, plan, settings)
    problem = ReductionProblem.of(case, asked)
    before, reduction = before_flight(problem), problem.solved()
    limits: tuple[LimitRow, ...] = ()
    why = ""
    try:
        limits = tuple(limit(case, asked))
    except ValueError as refusal:
        why = str(refusal)
    return ModesNeeded(case, asked, before, reduction, limits, why)


def before_flight(problem: ReductionProblem) -> BeforeFlight:
    """Errors of n modes that are known before anything is flown."""
    held = held_of(problem.case.scene)
    try:
        known, why = problem.full.known, problem.full.no_closed_forms or NOWHERE
    except ValueError as refusal:
        known, why = Claim(problem.structure.size, refused=str(refusal)), str(refusal)
    if not known.closed:
        by_losses = problem.reduced_by(MODAL).recommended(Claim(), problem.plan.accuracy).by_losses
        return BeforeFlight(known, why=why, by_losses=by_losses)
    made = [MODAL.of(problem.structure, n).structure for n in range(1, problem.most + 1)]
    given = [held, *filter(None, [other_choice(held)])]
    return BeforeFlight(known, tuple(filter(None, (_closed_errors(problem, each, made) for each in given))))


def _closed_errors(problem: ReductionProblem, held: Held, made: Sequence[Structure]) -> ClosedErrors | None:
    """Errors of natural modes with a coefficient held; None where all modes cannot have it, or have no closed form."""
    full, structure = problem.full, problem.structure
    if held.coefficient is not None and held != held_of(problem.case.scene):
        scene: Any = problem.case.scene
        full = replace(full, case=replace(problem.case, scene=holding(scene, held.restitution_of)))
    try:
        if not full.known.closed:
            return None
    except ValueError:
        return None
    single, *rows = full.in_closed_form([_single(structure), *made])
    enough = least([(n, row.within(problem.plan.accuracy)) for n, row in enumerate(rows, 1) if row.total])
    return ClosedErrors(held, tuple(rows), enough, single)


def _single(structure: Structure) -> Structure | None:
    """One degree of freedom along the static deflection at the contact; None of a free body, which has none."""
    try:
        return REDUCTIONS["static_mode"].make(structure, None).structure
    except ValueError:
        return None
