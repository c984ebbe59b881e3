"""Ends of branches: of what kind each is, and which ends of two responses are the same.

Ends are matched by their kind and their order along the sweep: of all ways to match them so, the one that leaves fewest
without a partner and, of these, moves them least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from vibeam.periodic.motion_kind import JUMP, SteadyKind, width

if TYPE_CHECKING:
    from vibeam.runs.comparison.places import SweptBranch

ALIKE = 0.6  # worth of a match whose contact begins or is lost alike, beside other motions
FARTHEST = 0.5  # relative distance of two ends that are matched, at most


@dataclass(frozen=True)
class SweptEnd:
    """End of a branch at a ``frequency`` in Hz, known to ± ``open``: the motion ``before`` it and the one ``after``.

    Before and after in the order swept, of a sweep in one ``direction``; ``step``: relative change of the amplitude.
    """

    frequency: float
    open: float
    before: SteadyKind
    after: SteadyKind
    direction: str
    step: float = 0.0

    @property
    def jumps(self) -> bool:
        """True where the amplitude jumps."""
        return abs(self.step) > JUMP

    @property
    def event(self) -> str:
        """Kind of the end, in words."""
        before, after = self.before, self.after
        if before.strikes != after.strikes:
            return "contact begins" if after.strikes else "contact is lost"
        if before == after:
            return "jump"
        if not before.repeats or not after.repeats:
            return "motion repeats" if after.repeats else "motion stops repeating"
        if after.periods == 2 * before.periods:
            return "period doubles"
        return "impacts a period change" if after.periods == before.periods else "period changes"


def ends_of(found: Sequence[SweptBranch], direction: str) -> list[SweptEnd]:
    """Ends of all branches of a response but those at the ends of the sweep, in the order swept."""
    return [
        SweptEnd(
            0.5 * (one.end + other.start), max(one.open_end, other.open_start), one.kind, other.kind, direction,
            _step(one.places[-1].amplitude, other.places[0].amplitude),
        )
        for one, other in pairwise(found)
    ]  # fmt: skip


def _step(before: float, after: float) -> float:
    larger = max(abs(before), abs(after))
    return (after - before) / larger if larger > 0 else 0.0


def matched(ours: Sequence[SweptEnd], theirs: Sequence[SweptEnd]) -> list[tuple[SweptEnd, SweptEnd]]:
    """Pairs of ends that are the same in two responses, in the order swept."""
    worth = np.zeros((len(ours) + 1, len(theirs) + 1))
    for i in reversed(range(len(ours))):
        for j in reversed(range(len(theirs))):
            both = _worth(ours[i], theirs[j]) + worth[i + 1, j + 1]
            worth[i, j] = max(both, worth[i + 1, j], worth[i, j + 1])
    pairs, i, j = [], 0, 0
    while i < len(ours) and j < len(theirs):
        own = _worth(ours[i], theirs[j])
        if own > 0 and worth[i, j] == own + worth[i + 1, j + 1]:
            pairs.append((ours[i], theirs[j]))
            i, j = i + 1, j + 1
        elif worth[i, j] == worth[i + 1, j]:
            i += 1
        else:
            j += 1
    return pairs


def _worth(one: SweptEnd, other: SweptEnd) -> float:
    """Worth of a match, 0 where two ends are not of a kind: nearly 1, less by their distance."""
    distance = width(one.frequency, other.frequency)
    if distance > FARTHEST:
        return 0.0
    if (one.before, one.after) == (other.before, other.after):
        return 1.0 - distance
    contact = one.event if one.before.strikes != one.after.strikes else ""
    return ALIKE * (1.0 - distance) if contact and contact == other.event else 0.0
