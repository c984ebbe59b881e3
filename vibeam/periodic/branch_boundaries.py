"""Boundaries met on a branch: bifurcations by smooth functions of M, touches by the equations of motions that graze.

A fold is a zero of ∏(1 − μ) at which the branch turns, a period doubling one of ∏(1 + μ), a Neimark–Sacker bifurcation
one of ∏(1 − μ_j μ_k) over pairs of multipliers at which a complex pair has modulus 1. Each is bracketed between two
points of the branch and found by Brent's method on motions that are converged to round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import JUMP
from vibeam.periodic.continuation import BranchPoint, BranchSection
from vibeam.periodic.grazing import Approach, GrazingMotion, apart, approaches, together, weakest_impacts
from vibeam_models.arrays import Array

CIRCLE = 1e-6  # distance of a pair of multipliers from the unit circle within which it is on it
PAIRED = 1e-9  # imaginary share below which a multiplier counts as real
FAR, AHEAD = 0.1, 4.0  # share of the motion's size, or steps, within which a grazing motion must lie
SMALL_WAY = 1e-7  # share of the motion's size of a difference
STRAIGHT = 0.7  # cosine of the angle between the branch and the way there
SECANT, ROOT = 30, 1e-13  # steps of the secant method, and the change at which they end


class Met(NamedTuple):
    """Boundary on a step: its kind, how far along, the motion there; of a grazing motion its place z alone.

    ``way``: of the branch there, about.
    """

    kind: Kind
    along: float
    point: BranchPoint | None
    z: Array
    way: Array


@dataclass(frozen=True)
class BranchStep:
    """Step of a branch from a point along the unit vector ``along``; ``slope``: of F by the parameter.

    ``before``: the point before it, ``gone`` from there.
    """

    start: BranchPoint
    along: Array
    slope: Array
    before: BranchPoint | None = None
    gone: float = 0.0

    @property
    def section(self) -> BranchSection:
        """Section of its points."""
        return self.start.section

    def point(self, length: float) -> BranchPoint | None:
        """Point in the plane at ``length`` along."""
        return self.section.corrected(self.start.z + length * self.along, self.along, self.slope)


TESTS: dict[Kind, Callable[[BranchPoint], float]] = {
    Kind.PLUS_ONE: lambda point: point.at_plus_one,
    Kind.DOUBLING: lambda point: point.at_minus_one,
    Kind.NEIMARK_SACKER: lambda point: point.on_circle,
}


def bifurcations(step: BranchStep, length: float, end: BranchPoint, turned: bool) -> list[Met]:
    """Bifurcations between a step's start and its ``end``, in order; ``turned``: the branch has gone through a fold."""
    found = list[Met]()
    for kind, test in TESTS.items():
        if not test(step.start) * test(end) < 0:
            continue
        at = root_on(step, test, 0.0, length)
        point = None if at is None else step.point(at)
        if at is None or point is None or (kind is Kind.NEIMARK_SACKER and not _on_circle(point)):
            continue
        found.append(
            Met(Kind.FOLD if turned and kind is Kind.PLUS_ONE else kind, at, point, point.z, end.z - step.start.z)
        )
    return sorted(found, key=lambda each: each.along)


def root_on(step: BranchStep, test: Callable[[BranchPoint], float], low: float, high: float) -> float | None:
    """Length along a step at which ``test`` is zero; None where its sign changes by a jump."""
    values = dict[float, float]()

    def at(length: float) -> float:
        point = step.point(length)
        if point is None:
            raise ArithmeticError
        values[length] = test(point)
        return values[length]

    try:
        if at(low) * at(high) < 0:
            brentq(at, low, high, xtol=1e-15, rtol=4 * np.finfo(float).eps, disp=False)
    except ArithmeticError:
        pass
    sizes = np.abs(np.array(list(values.values())))
    if len(values) < 3 or not sizes.min() <= JUMP * sizes.max():
        return None
    return list(values)[int(np.argmin(sizes))]


def _on_circle(point: BranchPoint) -> bool:
    values = point.multipliers
    paired = np.abs(values.imag) > PAIRED * np.abs(values)
    return bool((paired & (np.abs(np.abs(values) - 1) < CIRCLE)).any())


def grazing_ahead(step: BranchStep, length: float, few: BranchPoint | None = None) -> Met | None:
    """The nearest motion ahead that grazes, within reach of a step: a touch that begins, or an impact that vanishes.

    ``few``: the point of the step with fewer touches, where that is known: its next touch is looked for alone.
    """
    point, yields = few or step.start, step.start.flown.system.contact_law.yields
    found = approaches(point) + ([] if few or yields else weakest_impacts(point))
    found.sort(key=lambda each: each.distance)
    for some in together(found):
        met = _grazing(step, length, some, point)
        if met is not None:
            return met
    return None


def _grazing(step: BranchStep, length: float, found: list[Approach], point: BranchPoint) -> Met | None:
    """The motion that grazes as ``found`` on a ``point`` of the step, where there is one ahead."""
    section = step.section
    motion = GrazingMotion(section, apart([each.window for each in found]))
    turn, reach = motion.turn_from(section.phase), FAR * float(np.linalg.norm(point.z))
    ahead = min(_way_ahead(step, found[0]), reach) if point is step.start else 0.0
    grazed = None
    for way in (ahead, 0.0) if ahead else (0.0,):
        grazed = grazed or motion.solved(section.carried(point.z, turn) + way * _turned(step, turn))
    if grazed is None or not motion.clear(grazed):
        return None
    z = motion.at_phase(grazed, section.phase)
    along, distance = float((z - step.start.z) @ step.along), float(np.linalg.norm(z - step.start.z))
    reach = max(AHEAD * length, reach)
    kind = Kind.GRAZING if any(each.struck for each in found) else Kind.TOUCHING
    return Met(kind, along, None, z, step.along) if STRAIGHT * distance <= along <= reach else None


def _way_ahead(step: BranchStep, nearest: Approach) -> float:
    """Length along a step at which a touch that comes nearer, or an impact that becomes weaker, is due."""
    if step.before is None:
        return 0.0
    was = weakest_impacts(step.before) if nearest.struck else approaches(step.before)
    fall = was[0].distance - nearest.distance if was else 0.0
    return step.gone * nearest.distance / fall if fall > 0 else 0.0


def _turned(step: BranchStep, turn: float) -> Array:
    """Tangent of the branch at a section where the drive has turned on by ``turn``."""
    z, small = step.start.z, SMALL_WAY * float(np.linalg.norm(step.start.z))
    ends = [step.section.carried(z + side * small * step.along, turn) for side in (1, -1)]
    return np.asarray((ends[0] - ends[1]) / (2 * small))


def birth(start: BranchPoint, end: BranchPoint) -> BranchPoint | None:
    """The doubling at which the motions of a step were born; None where they do not pass one of half their span.

    Gone past it they come again, shifted by half a span: what they are off their half's fixed point changes sign.
    """
    section = start.section
    if section.periods % 2:
        return None
    half = replace(section, periods=section.periods // 2)
    try:
        before, after = (half.residual(point.z)[0] for point in (start, end))
        slope = half.slope(end.z)
    except ArithmeticError:
        return None
    share = float(np.linalg.norm(before) / (np.linalg.norm(before) + np.linalg.norm(after)))
    guess = start.z + share * (end.z - start.z)
    here = half.corrected(guess, np.append(np.zeros(len(before)), 1.0), slope) if before @ after < 0 else None
    return None if here is None else _doubling(BranchStep(here, half.tangent(here, slope), slope))


def _doubling(step: BranchStep) -> BranchPoint | None:
    """The doubling near a step's start, by the secant method."""
    first, second, low, at = 0.0, 1e-5, step.start.at_minus_one, step.point(1e-5)
    for _ in range(SECANT):
        if at is None or at.at_minus_one == low or abs(second - first) <= ROOT:
            return at
        new = second - at.at_minus_one * (second - first) / (at.at_minus_one - low)
        first, second, low = second, new, at.at_minus_one
        at = step.point(second)
    return None
