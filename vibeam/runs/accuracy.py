"""Accuracy on demand (``accuracy = "1 %"``): the cheapest fidelity whose estimated error is within it.

Fidelities of the case's own rig are swept one after another, the one with the fewest modes first, and the error of each
against the full model of the scene is estimated (``estimate``) until one is within; those that cost more are not swept.
Within is a fidelity whose error is known at every point of the sweep and nowhere larger. Where that holds of none, the
finest is taken if what is known of its error is within, and what is not known is said: of motions that do not repeat
nothing can be claimed. Where the finest is off by more, no fidelity is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.faults import CaseError
from vibeam.runs.estimate.records import Basis, FidelityEstimate, counted_reasons
from vibeam.runs.keys import estimates_key
from vibeam.runs.store.records import ESTIMATED
from vibeam.system.number_text import percent

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.fidelity_sweep import Job
    from vibeam.runs.store.file import Store
    from vibeam.system.impact_system import ImpactSystem


@dataclass(frozen=True)
class SweptFidelity:
    """Fidelity that was swept, with the largest estimated ``error`` (a share) of the quantities asked for.

    Known at ``known`` of ``points`` points, NaN where at none; ``unknown``: number of the others by reason.
    """

    fidelity: str
    error: float
    known: int
    points: int
    unknown: Mapping[str, int]

    def __str__(self) -> str:
        if not self.known:
            return f"{self.fidelity}, error not known"
        at = f"known at {self.known} of {self.points} points" if self.error else "the full model itself"
        return f"{self.fidelity}, {percent(self.error)} off at most ({at})"

    def is_within(self, accuracy: float) -> bool:
        """Test whether the error is known at every point, and nowhere larger."""
        return not self.unknown and not self.error > accuracy


@dataclass(frozen=True)
class AccuracyChoice:
    """Fidelity ``chosen`` within an error of the ``quantities``, empty where there is none, of those ``swept``.

    The cheapest comes first, the chosen one last; ``spared``: those that cost more. ``modes``: of the full model.
    """

    within: float
    quantities: tuple[str, ...]
    chosen: str
    swept: tuple[SweptFidelity, ...]
    spared: tuple[str, ...]
    modes: int

    def sentences(self) -> Iterator[str]:
        """Sentences on the fidelity chosen and its estimate, and on the others with theirs."""
        *others, last = self.swept
        of = " and ".join(self.quantities).replace("_", " ")
        within = f"within {percent(self.within)} of the full model ({self.modes} modes) in {of}"
        reasons = "; ".join(f"{reason}: {count}" for reason, count in last.unknown.items())
        if not self.chosen:
            near = min((each for each in self.swept if each is last or not each.unknown), key=lambda each: each.error)
            cure = f"add a fidelity with more modes, or allow more than {percent(near.error)}"
            yield f"No fidelity is {within}; the nearest is {near}: {cure}."
        elif reasons:
            yield f"Taken is {last}: the finest fidelity, {within} where that is known; not known: {reasons}."
        else:
            yield f"Taken is {last}: the cheapest fidelity {within}."
        if others:
            yield f"Refused: {'; '.join(map(str, others))}."
        if self.spared:
            yield f"Not swept, since they cost more: {', '.join(self.spared)}."


def by_cost(case: Case, modes: Mapping[str, int]) -> list[str]:
    """Fidelities of the case's own rig, those with fewer ``modes`` first; CaseError where there is none."""
    own = [name for name, each in case.fidelities.items() if not (each.changes or each.without)]
    if not own:
        raise CaseError([case.fault("accuracy", message="every fidelity changes the rig: add one of the rig itself")])
    return sorted(own, key=lambda name: modes[name])


def accuracy_choice(case: Case, names: Sequence[str], found: Mapping[str, FidelityEstimate]) -> AccuracyChoice:
    """Choice by the estimates ``found``, at least of the first of ``names``, which are in the order of ``by_cost``."""
    assert case.accuracy is not None
    within, quantities = case.accuracy.within, case.accuracy.quantities
    points = len(case.sweep.frequency) * (1 + (case.sweep.direction == "both"))
    swept: list[SweptFidelity] = []
    for name in takewhile(found.__contains__, names):
        swept.append(_swept(name, found[name], quantities, points))
        if swept[-1].is_within(within):
            break
    spared, last = tuple(names[len(swept) :]), swept[-1]
    taken = last.is_within(within) or not (spared or last.error > within)
    modes = max(each.modes for each in found.values())
    return AccuracyChoice(within, quantities, last.fidelity if taken else "", tuple(swept), spared, modes)


def _swept(name: str, found: FidelityEstimate, quantities: Sequence[str], points: int) -> SweptFidelity:
    if found.whole:
        return SweptFidelity(name, 0.0, points, points, {})
    if found.why:
        return SweptFidelity(name, np.nan, 0, points, {found.why: points})
    parts = found.branches.values()
    errors = np.concatenate([getattr(each, f"{of}_bound")[each.known] for each in parts for of in quantities])
    errors = errors[np.isfinite(errors)]  # velocities are not, without impacts
    largest = float(errors.max()) if len(errors) else np.nan
    reasons = counted_reasons(each.basis[~each.known] for each in parts)
    points -= reasons.pop(Basis.LEFT_OUT, 0)
    unknown = {basis.value: count for basis, count in reasons.items()}
    return SweptFidelity(name, largest, points - sum(unknown.values()), points, unknown)


def known_estimates(case: Case, jobs: Sequence[Job], store: Store | None) -> dict[str, FidelityEstimate]:
    """Estimates in the file by which a fidelity is chosen already, from the cheapest to that one; empty without any."""
    if case.accuracy is None or store is None:
        return {}
    names = [job.name for job in jobs]
    for count in range(1, 1 + len(list(takewhile(lambda job: not job.missing, jobs)))):
        kept = store.kept(ESTIMATED, estimates_key(case, {job.name: job.gathered() for job in jobs[:count]}))
        if kept and not all(each.why for each in kept.values()):
            choice = accuracy_choice(case, names, kept)
            if choice.chosen or not choice.spared:
                return {each.fidelity: kept[each.fidelity] for each in choice.swept}
    return {}


def until_within(
    case: Case,
    jobs: Sequence[Job],
    systems: Mapping[str, ImpactSystem],
    store: Store | None,
    sweep: Callable[[Job], None],
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Call ``sweep`` of ``jobs``, from the cheapest on, until one is within; the estimates of those, which are kept.

    CaseError, before anything is swept, where no error can be estimated.
    """
    from vibeam.runs.estimate.of_case import estimates, full_model

    try:
        full_model(case.scene_of(jobs[0].name))
    except ValueError as refusal:
        message = f"the error cannot be estimated ({refusal}): take this key away"
        raise CaseError([case.fault("accuracy", message=message)]) from None
    names = [job.name for job in jobs]
    found: dict[str, FidelityEstimate] = {}
    for job in jobs:
        sweep(job)
        found |= estimates(case, systems, {job.name: job.gathered()}, {job.name: job.after})
        if accuracy_choice(case, names, found).chosen:
            break
    if store:
        swept = {job.name: job.gathered() for job in jobs[: len(found)]}
        store.keep(ESTIMATED, estimates_key(case, swept), found)
    return found


def required_choice(case: Case, names: Sequence[str], found: Mapping[str, FidelityEstimate]) -> AccuracyChoice:
    """Choice by the estimates ``found``; CaseError where no fidelity is within."""
    choice = accuracy_choice(case, names, found)
    if not choice.chosen:
        raise CaseError([case.fault("accuracy", message=" ".join(choice.sentences()))])
    return choice
