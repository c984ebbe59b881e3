"""Losses of the reductions of a case, known beforehand, and the number of coordinates that is enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf, isfinite, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.source import of_source
from vibeam.studies.reduce.bases import ReductionBasis, bases_of
from vibeam.studies.reduce.losses import Losses, Question
from vibeam.studies.reduce.response import Claim, FullResponse
from vibeam.studies.reduce.transfer import ContactPulse, ModalForm, TransferErrors, TransferStudy
from vibeam.studies.reduce.transfer import contact_time as time_in_contact
from vibeam.system.labelled import ViewedTable
from vibeam_models.arguments import whole
from vibeam_models.arrays import ValueRecord
from vibeam_models.beam import structure_of

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam_models.structure import Structure

MOST = 12

HELD = (
    "R is held at the contact: what mode 1 keeps of its speed falls with every mode that is added, to R₁ = {0:.4g} "
    "with all, and what is left goes like 1/n; with that held in its place (stop.restitution = {0:.4g}, "
    'stop.restitution_of = "first mode") enough are {1}; or let the stop yield'
)

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

    ``band`` Hz, and how many natural modes are ``in_band``; ``contact_time`` s, NaN where none is known. ``curves``:
    errors of the transfer functions over the band, by basis, n and place. ``notes``: limits of the numbers.
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
    curves: Mapping[tuple[str, int, str], TransferErrors] = field(default_factory=dict, repr=False)

    def of(self, basis: str) -> tuple[Losses, ...]:
        """Losses of one basis, ascending in n; KeyError names those that there are."""
        names = dict.fromkeys(row.basis for row in self.rows)
        if basis not in names:
            raise KeyError(f"no basis {basis!r}: there are {', '.join(names)}")
        return tuple(row for row in self.rows if row.basis == basis)


@of_source
def reduce(
    case: Case,
    *,
    within: float = 0.05,
    band: tuple[float, float] | None = None,
    contact_time: float | None = None,
    bases: Sequence[str] | None = None,
    most: int = MOST,
) -> ReductionStudy:
    """Losses of each reduction of a case's structure with n = 1 … ``most`` coordinates, and the n that is enough.

    Nothing is flown where all modes' motions are known in closed form at every frequency (``FullResponse``).
    ``within``: accuracy by which a number is recommended; ``band`` in Hz: of transfer functions and frequencies, from 0
    to ten times the highest drive frequency where None; ``contact_time`` in s: of the stop, that of a linear one where
    None. ``bases``: names of these alone. ValueError for a case without a structure to reduce, an unknown basis, or
    arguments outside their range.
    """
    _check(case, within, band, contact_time, most)
    structure, notes = _reference(structure_of(case.scene))
    form = ModalForm.of(structure)
    low, high = band or (0.0, WIDER * float(case.sweep.frequency.max()))
    pulse = _pulse(case, form, contact_time)
    in_band = int(np.count_nonzero(form.omega <= 2 * np.pi * high))
    mus = np.linspace(max(low, high / FREQUENCIES), high, FREQUENCIES)
    held: Any = case.scene
    given = nan if held.stop.law is not None else held.stop.usual_restitution
    of_first = held.stop.restitution_of == "first mode"
    question = Question(TransferStudy(form, mus), in_band, pulse, given, of_first, within)
    chosen = bases_of(case, None if bases is None else tuple(bases))
    answers = _answered(question, structure, chosen, min(most, structure.size))
    full, claim = _all_modes(case, structure)
    found = [_with_responses(answer, full, within) for answer in answers]
    claim = claim if full is None else full.claim
    recommended = tuple(map(partial(_recommended, claim=claim, within=within), chosen, found))
    time = nan if pulse is None else pulse.duration
    rows = tuple(row for part in found for row in part)
    said = (*notes, *_notes(case, pulse), *_cure(full, claim, recommended, answers, within), *_absent(chosen, rows))
    curves = {key: curve for answer in answers for key, curve in answer.curves.items()}
    return ReductionStudy(
        case, rows, recommended, claim, within, (low, high), in_band, time, structure.size, said, curves
    )


def _check(case: Case, within: float, band: Any, contact_time: Any, most: Any) -> None:
    if case.scene.given_mode is not None:
        raise ValueError(f"nothing to reduce: {case.scene.no_beam}")
    faults = []
    if not 0 < within < 1:
        faults.append(f"within: {within!r} must be between 0 and 1")
    if band is not None and not 0 <= band[0] < band[1]:
        faults.append(f"band: {band[0]:g} … {band[1]:g} Hz must ascend from 0 or above")
    if contact_time is not None and not 0 < contact_time < np.inf:
        faults.append(f"contact_time: {contact_time!r} must be above 0 s")
    if (whole(most) or 0) < 1:
        faults.append(f"most: {most!r} must be a whole number from 1 on")
    if faults:
        raise ValueError("; ".join(faults))


def _reference(structure: Structure) -> tuple[Structure, tuple[str, ...]]:
    """The structure itself, or what stands for one of so many coordinates that its modes are not all known."""
    from vibeam_models.sparse import SparseStructure

    if not isinstance(structure, SparseStructure):
        return structure, ()
    from vibeam_reductions.modes import static_correction

    count = min(REFERENCE, structure.size // 3)
    note = f"{structure.size} coordinates, sparse: {count} modes with static correction stand for the full model"
    return static_correction(structure, count).structure, (note,)


def _pulse(case: Case, form: ModalForm, asked: float | None) -> ContactPulse | None:
    scene: Any = case.scene
    declared = scene.stop.law
    law = None if declared is None else declared.contact(form.structure.mobility(form.structure.contact)).spring
    stiffness = np.inf if law is None else law.stiffness
    if asked is not None:
        return ContactPulse(asked, stiffness)
    return None if law is None else ContactPulse(time_in_contact(form, law), stiffness)


def _notes(case: Case, pulse: ContactPulse | None) -> list[str]:
    law = case.scene.stop.law if case.scene.stop is not None else None
    if law is None or not law.compliant or pulse is not None:
        return []
    return [f'the contact time of law "{law.name}" depends on the velocity: an impulse stands for it']


@dataclass(frozen=True, eq=False)
class _Answer:
    """Losses of one basis with 1, 2 … coordinates, the reduced structures, None where there is none, and the curves."""

    rows: list[Losses] = field(default_factory=list)
    structures: list[Structure | None] = field(default_factory=list)
    curves: dict[tuple[str, int, str], TransferErrors] = field(default_factory=dict)


def _answered(question: Question, structure: Structure, bases: Sequence[ReductionBasis], most: int) -> list[_Answer]:
    answers = [_Answer() for _ in bases]
    for basis, answer in zip(bases, answers, strict=True):
        for n in range(1, most + 1):
            try:
                made = basis.of(structure, n)
                row, found = question.losses(basis.name, n, made)
                answer.structures.append(made.structure)
            except ValueError as refusal:
                row, found = Losses(basis.name, n, why=str(refusal)), {}
                answer.structures.append(None)
            answer.rows.append(row)
            answer.curves.update({(basis.name, n, place): each for place, each in found.items()})
    return answers


def _all_modes(case: Case, structure: Structure) -> tuple[FullResponse | None, Claim]:
    full = FullResponse(case, structure)
    try:
        return full, full.claim
    except ValueError as refusal:
        return None, Claim(structure.size, refused=str(refusal))


def _with_responses(answer: _Answer, full: FullResponse | None, within: float) -> list[Losses]:
    if full is None:
        return answer.rows
    found = full.errors(answer.structures, within)
    return [replace(row, response=response) for row, response in zip(answer.rows, found, strict=True)]


def _recommended(basis: ReductionBasis, rows: Sequence[Losses], claim: Claim, within: float) -> Recommendation:
    """The least n such that it and all larger ones that are known are within the accuracy."""
    if not any(isfinite(row.loss) for row in rows):
        return Recommendation(basis.name, None, None, why=rows[-1].why)
    known = [row for row in rows if row.response.complete and not claim.refused]
    enough = _least([(row, row.response.within(within)) for row in known])
    by_losses = _least([(row, row.loss <= within) for row in rows if isfinite(row.loss)])
    modes, least = (None if row is None else row.modes for row in (enough, by_losses))
    return Recommendation(basis.name, modes, enough, least, basis.parameters.get("frequency"))


def _cure(
    full: FullResponse | None, claim: Claim, recommended: Sequence[Recommendation], answers: Sequence[_Answer],
    within: float,
) -> list[str]:  # fmt: skip
    """Sentence on the coordinates that holding R₁ of all modes would save, where R is held at the contact."""
    if full is None or claim.refused or not claim.closed or full.case.scene.held[0] != "contact":
        return []
    fewer = []
    for each, answer in zip(recommended, answers, strict=True):
        errors = full.with_first_mode_held(answer.structures)
        known = [(row, error.within(within)) for row, error in zip(answer.rows, errors, strict=True) if error.known]
        enough = _least(known)
        if enough is not None and enough.modes < (each.modes or inf):
            fewer.append(f"{each.basis} {enough.modes}")
    return [HELD.format(full.first_mode, ", ".join(fewer))] if fewer else []


def _least(rows: Sequence[tuple[Losses, bool]]) -> Losses | None:
    """The first row from which on all are sufficient."""
    enough = None
    for row, sufficient in reversed(rows):
        if not sufficient:
            break
        enough = row
    return enough


def _absent(bases: Sequence[ReductionBasis], rows: Sequence[Losses]) -> list[str]:
    """Reasons why a basis has no row at all."""
    found = []
    for basis in bases:
        own = [row for row in rows if row.basis == basis.name]
        if not any(isfinite(row.loss) for row in own):
            found.append(f"{basis.name}: {own[-1].why}")
    return found
