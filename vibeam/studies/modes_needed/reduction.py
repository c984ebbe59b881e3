"""Losses of the reductions of a case, known beforehand, and the number of coordinates that is enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite, nan
from typing import Any, TypeVar

import numpy as np

from vibeam.case.case import Case
from vibeam.case.source import of_source
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.casefile.tables.table import plan_with
from vibeam.studies.modes_needed.bases import ReductionBasis, bases_of
from vibeam.studies.modes_needed.losses import Losses, Question
from vibeam.studies.modes_needed.response import Claim, FullResponse
from vibeam.studies.modes_needed.transfer import ContactPulse, ModalForm, TransferStudy
from vibeam.studies.modes_needed.transfer import contact_time as time_in_contact
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import ValueRecord
from vibeam_models.beam import structure_of
from vibeam_models.structure import Structure

FREQUENCIES = 400  # of the band
WIDER = 10  # times the highest drive frequency, where no band is asked for
REFERENCE = 60  # coordinates that stand for a structure whose modes are not all known


@dataclass(frozen=True)
class Recommendation:
    """Least number of coordinates ``modes`` from which on the response is within the accuracy; None: there is none.

    ``losses``: all that is lost with it; ``by_losses``: the number from which on these are within the accuracy, which
    claims nothing of the response. ``frequency`` in Hz, of a basis about one, which a fidelity must name too. ``why``:
    why the case cannot have the basis at all.
    """

    basis: str
    modes: int | None
    losses: Losses | None
    by_losses: int | None = None
    frequency: float | None = None
    why: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class ReductionStudy(ValueRecord, ViewedTable):
    """Losses of every basis at n = 1, 2 …, and the n that is enough ``within`` an accuracy, as the ``claim`` says.

    ``band`` Hz, and how many natural modes are ``in_band``; ``contact_time`` s, NaN where none is known. ``notes``:
    limits of the numbers.
    """

    case: Case
    rows: tuple[Losses, ...]
    recommended: tuple[Recommendation, ...]
    claim: Claim
    within: float
    band: tuple[float, float]
    in_band: int
    contact_time: float
    size: int
    notes: tuple[str, ...] = ()

    def of(self, basis: str) -> tuple[Losses, ...]:
        """Losses of one basis, ascending in n; KeyError names those that there are."""
        names = dict.fromkeys(row.basis for row in self.rows)
        if basis not in names:
            raise KeyError(f"no basis {basis!r}: there are {', '.join(names)}")
        return tuple(row for row in self.rows if row.basis == basis)


@of_source
def reduce(case: Case, /, plan: ModesNeededPlan | None = None, **settings: Any) -> ReductionStudy:
    """Losses of each reduction of a case's structure with n = 1, 2 … coordinates, and the n that is enough.

    Nothing is flown where all modes' motions are known in closed form at every frequency (``FullResponse``).
    ``settings``: of the ``plan``, its ``accuracy``, ``bases``, ``most``, ``band`` and ``contact_time``, in SI or with
    units. ValueError for a case without a structure to reduce, an unknown basis, or settings outside their range.

    >>> import vibeam
    >>> study = vibeam.reduce("cases/dtu_neutral.toml", most=2, bases=["modal"])
    >>> study.size, len(study.rows)  # all modes, and reductions
    (64, 2)
    """
    return ReductionProblem.of(case, plan_asked(case, plan, settings)).solved()


def plan_asked(case: Case, plan: ModesNeededPlan | None, settings: Mapping[str, Any]) -> ModesNeededPlan:
    """The plan, None: what the case asks, with settings in place of its own; ValueError names all that are wrong."""
    asked = plan_with(plan or case.asked.get("modes_needed") or ModesNeededPlan(), settings)
    faults = []
    if asked.band is not None and len(asked.band) != 2:
        faults.append(f"band: its two ends, not {len(asked.band)} frequencies")
    if asked.modes & (asked.modes - 1):
        faults.append(f"modes: {asked.modes} must be a power of two, since each model has twice those of the last")
    if faults:
        raise ValueError("; ".join(faults))
    return asked


@dataclass(frozen=True, eq=False)
class ReductionProblem:
    """Question to the reductions of a case as a ``plan`` says, before any of them is made.

    ``full``: the response of all modes of the ``structure``, with which theirs are compared.
    """

    case: Case
    plan: ModesNeededPlan
    structure: Structure
    notes: tuple[str, ...]
    full: FullResponse

    @classmethod
    def of(cls, case: Case, plan: ModesNeededPlan) -> ReductionProblem:
        """Problem of a case; ValueError for one without a structure, or an impossible plan."""
        _ = case.sweep  # of a record case vibeam verdict counts the modes
        if case.scene.given_mode is not None:
            raise ValueError(f"nothing to reduce: {case.scene.no_beam}")
        structure, notes = _reference(structure_of(case.scene))
        return cls(case, plan, structure, notes, FullResponse(case, structure))

    @property
    def most(self) -> int:
        """Largest number of coordinates."""
        return min(self.plan.most, self.structure.size)

    @cached_property
    def band(self) -> tuple[float, float]:
        """Band in Hz."""
        low, high = self.plan.band or (0.0, WIDER * float(self.case.sweep.frequency.max()))
        return low, high

    @cached_property
    def question(self) -> Question:
        """Question about the losses of one reduction."""
        form, (low, high) = ModalForm.of(self.structure), self.band
        mus = np.linspace(max(low, high / FREQUENCIES), high, FREQUENCIES)
        in_band = int(np.count_nonzero(form.omega <= 2 * np.pi * high))
        stop: Any = self.case.scene.stop
        given = nan if stop.law is not None else stop.usual_restitution
        of_first, pulse = stop.restitution_of == "first mode", self._pulse(form)
        return Question(TransferStudy(form, mus), in_band, pulse, given, of_first)

    def _pulse(self, form: ModalForm) -> ContactPulse | None:
        scene: Any = self.case.scene
        declared, asked = scene.stop.law, self.plan.contact_time
        law = None if declared is None else declared.contact(form.structure.mobility(form.structure.contact)).spring
        stiffness = np.inf if law is None else law.stiffness
        if asked is not None:
            return ContactPulse(asked, stiffness)
        return None if law is None else ContactPulse(time_in_contact(form, law), stiffness)

    def reduced_by(self, basis: ReductionBasis) -> ReducedStructures:
        """Structures of one basis with 1, 2 … coordinates, and their losses."""
        found = ReducedStructures(basis)
        for n in range(1, self.most + 1):
            try:
                made = basis.of(self.structure, n)
                row = self.question.losses(basis.name, n, made)
                found.structures.append(made.structure)
            except ValueError as refusal:
                row = Losses(basis.name, n, why=str(refusal))
                found.structures.append(None)
            found.rows.append(row)
        return found

    def solved(self) -> ReductionStudy:
        """Losses of every basis, their responses, and what is recommended by these."""
        within, question = self.plan.accuracy, self.question
        bases = [self.reduced_by(basis) for basis in bases_of(self.case, self.plan.bases)]
        try:
            claim, refused = self.full.claim, ""
        except ValueError as refusal:
            claim, refused = Claim(self.structure.size, refused=str(refusal)), str(refusal)
        if not refused:
            for each in bases:
                found = zip(each.rows, self.full.errors(each.structures, within), strict=True)
                each.rows[:] = [replace(row, response=response) for row, response in found]
            claim = self.full.claim
        recommended = tuple(each.recommended(claim, within) for each in bases)
        return ReductionStudy(
            self.case, tuple(row for each in bases for row in each.rows), recommended, claim, within, self.band,
            question.in_band, nan if question.pulse is None else question.pulse.duration, self.structure.size,
            (*self.notes, *self._of_law()),
        )  # fmt: skip

    def _of_law(self) -> list[str]:
        law = self.case.scene.stop.law if self.case.scene.stop is not None else None
        if law is None or not law.compliant or self.question.pulse is not None:
            return []
        return [f'the contact time of law "{law.name}" depends on the velocity: an impulse stands for it']


def _reference(structure: Structure) -> tuple[Structure, tuple[str, ...]]:
    """The structure itself, or what stands for one of so many coordinates that its modes are not all known."""
    from vibeam_models.sparse import SparseStructure

    if not isinstance(structure, SparseStructure):
        return structure, ()
    from vibeam_reductions.modes import static_correction

    count = min(REFERENCE, structure.size // 3)
    note = f"{structure.size} coordinates, sparse: {count} modes with static correction stand for the full model"
    return static_correction(structure, count).structure, (note,)


@dataclass(frozen=True, eq=False)
class ReducedStructures:
    """Structures of one basis with 1, 2 … coordinates, None where there is none, and their losses."""

    basis: ReductionBasis
    rows: list[Losses] = field(default_factory=list)
    structures: list[Structure | None] = field(default_factory=list)

    def recommended(self, claim: Claim, within: float) -> Recommendation:
        """The least n such that it and all larger ones that are known are within the accuracy."""
        sound = [row for row in self.rows if isfinite(row.loss)]
        if not sound:
            return Recommendation(self.basis.name, None, None, why=self.rows[-1].why)
        known = [row for row in self.rows if row.response.complete and not claim.refused]
        enough = least([(row, row.response.within(within)) for row in known])
        by_losses = least([(row, row.loss <= within) for row in sound])
        modes, n = (None if row is None else row.modes for row in (enough, by_losses))
        return Recommendation(self.basis.name, modes, enough, n, self.basis.parameters.get("frequency"))


Made = TypeVar("Made")


def least(rows: Sequence[tuple[Made, bool]]) -> Made | None:
    """The first row from which on all are sufficient."""
    enough = None
    for row, sufficient in reversed(rows):
        if not sufficient:
            break
        enough = row
    return enough
