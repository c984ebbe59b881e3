"""Accuracy on demand (``accuracy = "1 %"``): the cheapest fidelity whose estimated error is within it.

Fidelities of the case's own rig are swept one after another, the one with the fewest modes first, and the error of each
against the full model of the scene is estimated (``estimate``) until one is within; those that cost more are not swept.
Within is a fidelity whose error is known at every point of the sweep and nowhere larger. Where that holds of none, the
finest is taken if what is known of its error is within, and what is not known is said: of motions that do not repeat
nothing can be claimed. Where the finest is off by more, no fidelity is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.faults import CaseError
from vibeam.runs.estimate.records import Basis, FidelityEstimate
from vibeam.system.number_text import percent

if TYPE_CHECKING:
    from vibeam.case.case import Case


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
            near = min(self.swept, key=lambda each: (each.points - each.known, each.error))
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
    while not (swept and is_within(swept[-1], within)) and len(swept) < len(names) and names[len(swept)] in found:
        name = names[len(swept)]
        swept.append(_swept(name, found[name], quantities, points))
    spared, last = tuple(names[len(swept) :]), swept[-1]
    taken = is_within(last, within) or not (spared or last.error > within)
    modes = max(each.modes for each in found.values())
    return AccuracyChoice(within, quantities, last.fidelity if taken else "", tuple(swept), spared, modes)


def is_within(swept: SweptFidelity, within: float) -> bool:
    """Test whether the error of a fidelity is known at every point, and nowhere larger."""
    return not swept.unknown and not swept.error > within


def _swept(name: str, found: FidelityEstimate, quantities: Sequence[str], points: int) -> SweptFidelity:
    if found.whole:
        return SweptFidelity(name, 0.0, points, points, {})
    if found.why:
        return SweptFidelity(name, np.nan, 0, points, {found.why: points})
    parts = found.branches.values()
    errors = np.concatenate([getattr(each, f"{of}_bound")[each.known] for each in parts for of in quantities])
    errors = errors[np.isfinite(errors)]  # velocities are not, without impacts
    codes, counts = np.unique(np.concatenate([each.basis[~each.known] for each in parts]), return_counts=True)
    unknown = {Basis.of_code(int(code)).value: int(count) for code, count in zip(codes, counts, strict=True)}
    return SweptFidelity(name, float(errors.max()) if len(errors) else np.nan, points - sum(counts), points, unknown)
