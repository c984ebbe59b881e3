"""Walk along a branch of periodic motions: steps, their lengths, what is met on them, and where the branch ends."""

from __future__ import annotations

from enum import Enum

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.readout import rests
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.branch_boundaries import BranchStep, Met, bifurcations, birth, grazing_ahead
from vibeam.periodic.continuation import BranchPoint, better_phase
from vibeam_models.arrays import Array

LEAST = 1e-11  # step at which a branch is given up
STRAY = 0.2  # distance of the corrected point from a step's end, as a share of the step, beyond which it is too long
GROWTH, EASY = 1.6, 0.04  # of a step after one that strayed by less than so much
WARY = 2e-3  # step above which it is shortened where the branch may have been left for one that crosses it
CLOSE = 1e-3  # share of the step at which a motion that grazes was found ahead, down to which steps are halved
BEYOND = (1e-3, 1e-4, 1e-5, 1e-6)  # steps beyond a touch at which a motion is looked for
AFRESH = 1e-4  # step after a change of the events that was approached by halving
SHORT = 1e-3  # share of the span below which a rest is about to end


class BranchEnd(Enum):
    """Reason why a branch was followed no further.

    >>> import vibeam
    >>> vibeam.BranchEnd.REACHED.value
    'the parameter has reached its end'
    """

    REACHED = "the parameter has reached its end"
    RETURNED = "the branch has turned, and the parameter has gone back to the other end of its range"
    GRAZING = "the motion grazes the stop, and beyond ceases as it was"
    REST = "a rest on the stop has ended, and beyond the motion ceases as it was"
    BIRTH = "it has become a motion of half its span: it was born there by period doubling"
    LOST = "Newton's method finds no motion near the last one, however short the step"
    STEPS = "as many steps as asked for have been taken"


class Walk:
    """Walk along a branch from a point on it; ``ahead``: which way, a vector in z."""

    def __init__(self, start: BranchPoint, ahead: Array, to: float, behind: float, step: float, longest: int) -> None:
        self.points, self.met = [start], list[tuple[Met, float]]()
        self.behind = behind
        self.low, self.high = min(to, behind), max(to, behind)
        self.to, self.step, self.longest = to, step, longest
        self.length = step
        self.end: BranchEnd | None = None
        self.target: Met | None = None  # motion that grazes, ahead
        self.approach, self.fall = step, 0.0
        self._face(start, ahead)

    def _face(self, point: BranchPoint, ahead: Array) -> None:
        """Tangent at a point, the same way as ``ahead``."""
        slope = point.section.slope(point.z)
        along = point.section.tangent(point, slope)
        before, gone = (self.points[-1], float(np.linalg.norm(ahead))) if self.points[-1] is not point else (None, 0.0)
        self.at = BranchStep(point, along * (1.0 if along @ ahead >= 0 else -1.0), slope, before, gone)

    def renewed(self, start: Array, first: BranchPoint) -> Walk:
        """Walk with the same limits along another branch, from its ``first`` point away from ``start``."""
        return Walk(first, first.z - start, self.to, self.behind, self.step, self.longest)

    def run(self) -> None:
        """Walk to an end."""
        for _ in range(self.longest):
            self._advance()
            if self.end is not None:
                return
        self.end = BranchEnd.STEPS

    def _advance(self) -> None:
        """One step: the longest up to ``length`` that stays on the branch."""
        self.length = min(self.length, self.step * max(1.0, float(np.linalg.norm(self.at.start.z[:-1]))))
        while self.length >= LEAST:
            ahead = self.at.point(self.length)
            away = np.inf if ahead is None else self._strayed(ahead)
            if ahead is not None and away <= STRAY and not self._suspect(ahead):
                if ahead.itinerary == self.at.start.itinerary:
                    self._take(ahead, self.length)
                    self.length *= GROWTH if away < EASY else 1.0
                    return
                if self._changes(ahead):
                    return
            elif self._grazes():
                return
            elif self.target is not None and self.length < CLOSE * self.approach:
                break
            self.length /= 2
        self._give_up()

    def _suspect(self, ahead: BranchPoint) -> bool:
        """Test whether ∏(1 − μ), on its way to zero, has turned instead: as on a branch that crosses there."""
        here, there = self.at.start.at_plus_one, ahead.at_plus_one
        expected = here + self.fall * self.length
        crossed = here * expected < 0 < here * there
        return self.length > WARY and (crossed or (self._back(ahead) and birth(self.at.start, ahead) is None))

    def _back(self, ahead: BranchPoint) -> bool:
        """Test whether a step has turned on its way, and left the range on the side that it came from."""
        inside = self.low <= ahead.value <= self.high
        return not inside and bool((ahead.value - self.at.start.value) * self.at.along[-1] < 0)

    def _strayed(self, ahead: BranchPoint) -> float:
        return float(np.linalg.norm(ahead.z - self.at.start.z - self.length * self.at.along)) / self.length

    def _take(self, ahead: BranchPoint, length: float, crossed: Met | None = None) -> None:
        """Go on to a point, noting the bifurcations on the way; the range ends the walk."""
        last, step = self.at.start, self.at
        if self._back(ahead) and self._born(last, ahead):
            return
        inside = self.low <= ahead.value <= self.high
        if not inside:
            ahead = self._at_limit(ahead) or ahead
            length = float((ahead.z - last.z) @ step.along)
        here, before = self._centred(ahead, last)
        self.fall = (ahead.at_plus_one - last.at_plus_one) / max(length, LEAST)
        self._face(here, here.z - before)
        turned = self.at.along[-1] * step.along[-1] < 0
        met = bifurcations(step, length, ahead, turned)
        met += [] if crossed is None else [crossed]
        for each in sorted(met, key=lambda each: each.along):
            self._note(each)
        if turned and self._born(step.start, ahead):
            return
        self.points.append(here)
        if not inside:
            self.end = BranchEnd.REACHED if (ahead.value > self.low) == (self.to > self.low) else BranchEnd.RETURNED

    def _note(self, met: Met) -> None:
        value = self.at.start.section.value(met.z)
        if self.low <= value <= self.high:
            self.met.append((met, value))

    def _at_limit(self, ahead: BranchPoint) -> BranchPoint | None:
        """The point of the branch at the limit that a step has passed."""
        last, limit = self.at.start, self.high if ahead.value > self.high else self.low
        share = (limit - last.value) / (ahead.value - last.value)
        guess = last.z + share * (ahead.z - last.z)
        guess[-1] = limit / last.section.scale
        return last.section.corrected(guess, np.append(np.zeros(len(guess) - 1), 1.0), self.at.slope)

    def _centred(self, ahead: BranchPoint, last: BranchPoint) -> tuple[BranchPoint, Array]:
        """A point with its section well within a flight, and the z of the point before it at that section."""
        turn = better_phase(ahead)
        if turn is None:
            return ahead, last.z
        section = ahead.section.moved(ahead.section.phase + turn)
        before, guess = ahead.section.carried(last.z, turn), ahead.section.carried(ahead.z, turn)
        way = guess - before
        moved = section.corrected(guess, way / np.linalg.norm(way), section.slope(guess))
        return (ahead, last.z) if moved is None else (moved, before)

    def _grazes(self) -> bool:
        """Look for a motion that grazes ahead, and go on beyond it where the stop yields; else steps come near it."""
        met = None if self.target else grazing_ahead(self.at, self.length)
        if met is None:
            return False
        yields = _yielding(self.at.start)
        if any(yields) and self._touches(met):
            return True
        if all(yields):
            return False
        self.target, self.approach = met, self.length
        return False

    def _touches(self, met: Met) -> bool:
        """Go on beyond a motion that only touches a stop that yields; False where no motion is found there."""
        for more in BEYOND:
            self.length = met.along + more
            ahead = self.at.point(self.length)
            if ahead is not None and self._strayed(ahead) < 1 and ahead.itinerary != self.at.start.itinerary:
                self._take(ahead, self.length, met)
                self.length = more
                return True
        return False

    def _changes(self, ahead: BranchPoint) -> bool:
        """Go over a change of the events on the way, where it can be located; False for a step that is too long."""
        start, yields = self.at.start, any(_yielding(ahead))
        if ahead.itinerary.flies != start.itinerary.flies:
            return self._changed(ahead, Kind.CONTACT)
        if ahead.itinerary.rests != start.itinerary.rests:
            return self._changed(ahead, Kind.REST)
        if not yields:
            return self._grazes()
        few = min(start, ahead, key=lambda each: sum(each.itinerary.touches))
        met = grazing_ahead(self.at, self.length, few)
        if met is not None and met.along <= self.length * 1.000001:
            self._take(ahead, self.length, met)
            return True
        return self._changed(ahead, Kind.CONTACT)

    def _changed(self, ahead: BranchPoint, kind: Kind) -> bool:
        """Go over a change that halving the step has brought near enough."""
        if self.length > 2 * LEAST:
            return False
        self._take(ahead, self.length, Met(kind, self.length, ahead, ahead.z, self.at.along))
        self.length = AFRESH
        return True

    def _give_up(self) -> None:
        """End where steps become too short: at a motion that grazes, where a rest ends, or for no reason known."""
        start, self.end = self.at.start, BranchEnd.LOST
        trace = start.flown.segments.trace
        resting, span = trace[rests(trace), layout.DURATION], float(trace[:, layout.DURATION].sum())
        if self.target is not None:
            self._note(self.target)
            self.end = BranchEnd.GRAZING
        elif len(resting) and float(resting.min()) < SHORT * span:
            self._note(Met(Kind.REST, 0.0, start, start.z, self.at.along))
            self.end = BranchEnd.REST

    def _born(self, last: BranchPoint, ahead: BranchPoint) -> bool:
        found = birth(last, ahead)
        if found is None:
            return False
        self._note(Met(Kind.DOUBLING, 0.0, found, found.z, self.at.along))
        self.end = BranchEnd.BIRTH
        return True


def _yielding(point: BranchPoint) -> list[bool]:
    """Flags of the stops that yield: past a touch of one the motion goes on."""
    return [law.yields for law in Contacts.of(point.flown.system).laws]
