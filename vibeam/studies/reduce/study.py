"""What a reduction of a case loses, known beforehand, and the number of coordinates that is enough."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.studies.reduce.bases import Basis, bases_of
from vibeam.studies.reduce.contact_time import contact_time as time_in_contact
from vibeam.studies.reduce.losses import ContactPulse, Losses, Question
from vibeam.studies.reduce.transfer import ModalForm, TransferErrors, TransferStudy
from vibeam_models.arguments import whole
from vibeam_models.laws.compliant import LinearStop

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam_models.structure import Structure

MOST = 12

YIELDS = (
    "the stop yields: the losses are of one impact, and no error of a response is estimated for such a stop; where few "
    "motions repeat, what is recommended may be off by more: fly it beside more coordinates"
)

FREQUENCIES = 400  # of the band

WIDER = 10  # times the highest drive frequency, where no band is asked for

REFERENCE = 60  # coordinates that stand for a structure whose modes are not all known


@dataclass(frozen=True)
class Recommendation:
    """Least number of coordinates ``modes`` from which on all losses are within the accuracy; None: above the last.

    ``losses``: what is lost with it. ``why``: why the case cannot have the basis at all.
    """

    basis: str
    modes: int | None
    losses: Losses | None
    why: str = ""


@dataclass(frozen=True, eq=False)
class ReductionStudy:
    """Losses of every basis at n = 1, 2 …, and the n that is enough ``within`` an accuracy.

    ``band`` Hz, and how many natural modes are ``in_band``; ``contact_time`` s, NaN where none is known. ``curves``:
    errors of the transfer functions over the band, by basis, n and place. ``notes``: limits of the numbers.
    """

    case: Case
    rows: tuple[Losses, ...]
    recommended: tuple[Recommendation, ...]
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


def reduce(
    case: Case,
    *,
    within: float = 0.05,
    band: tuple[float, float] | None = None,
    contact_time: float | None = None,
    bases: Sequence[str] | None = None,
    most: int = MOST,
) -> ReductionStudy:
    """What each reduction of a case's structure loses with n = 1 … ``most`` coordinates, without flying it.

    ``within``: accuracy by which a number is recommended; ``band`` in Hz: of transfer functions and frequencies, from 0
    to ten times the highest drive frequency where None; ``contact_time`` in s: of the stop, that of a linear one where
    None. ``bases``: names of these alone. ValueError for a case without a structure to reduce, an unknown basis, or
    arguments outside their range.
    """
    _check(case, within, band, contact_time, most)
    structure, notes = _reference(case.scene.structure())
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
    rows, curves = _answered(question, structure, chosen, min(most, structure.size))
    recommended = tuple(
        _recommended(basis, [row for row in rows if row.basis == basis.name], within) for basis in chosen
    )
    time = nan if pulse is None else pulse.duration
    said = (*notes, *_notes(case, pulse), *_absent(chosen, rows))
    return ReductionStudy(
        case, tuple(rows), recommended, within, (low, high), in_band, time, structure.size, said, curves
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
    from vibeam_reductions.static_correction import static_correction

    count = min(REFERENCE, structure.size // 3)
    note = f"{structure.size} coordinates, sparse: {count} modes with static correction stand for the full model"
    return static_correction(structure, count).structure, (note,)


def _pulse(case: Case, form: ModalForm, asked: float | None) -> ContactPulse | None:
    scene: Any = case.scene
    declared = scene.stop.law
    law = None if declared is None else declared.contact(form.structure.mobility(form.structure.contact))
    stiffness = law.stiffness if isinstance(law, LinearStop) else np.inf
    if asked is not None:
        return ContactPulse(asked, stiffness)
    return ContactPulse(time_in_contact(form, law), stiffness) if isinstance(law, LinearStop) else None


def _notes(case: Case, pulse: ContactPulse | None) -> list[str]:
    law = None if case.scene.stop is None else case.scene.stop.law
    if law is None or not law.compliant:
        return []
    timed = [f'the contact time of law "{law.name}" depends on the velocity: an impulse stands for it']
    return [*(timed if pulse is None else []), YIELDS]


def _answered(
    question: Question, structure: Structure, bases: Sequence[Basis], most: int
) -> tuple[list[Losses], dict[tuple[str, int, str], TransferErrors]]:
    rows: list[Losses] = []
    curves: dict[tuple[str, int, str], TransferErrors] = {}
    for basis in bases:
        for n in range(1, most + 1):
            try:
                row, found = question.losses(basis.name, n, basis.of(structure, n))
            except ValueError as refusal:
                row, found = Losses(basis.name, n, why=str(refusal)), {}
            rows.append(row)
            curves |= {(basis.name, n, place): each for place, each in found.items()}
    return rows, curves


def _recommended(basis: Basis, rows: Sequence[Losses], within: float) -> Recommendation:
    """The least n such that it and all larger ones that there are are within the accuracy."""
    if not any(isfinite(row.loss) for row in rows):
        return Recommendation(basis.name, None, None, rows[-1].why)
    enough = None
    for row in reversed([row for row in rows if isfinite(row.loss)]):
        if row.loss > within:
            break
        enough = row
    return Recommendation(basis.name, None if enough is None else enough.modes, enough)


def _absent(bases: Sequence[Basis], rows: Sequence[Losses]) -> list[str]:
    """Why a basis has no row at all."""
    found = []
    for basis in bases:
        own = [row for row in rows if row.basis == basis.name]
        if not any(isfinite(row.loss) for row in own):
            found.append(f"{basis.name}: {own[-1].why}")
    return found
