"""A line through the parameters and what changes sign on it at a branch's boundaries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.balance import Roots, balance
from vibeam.periodic.multipliers import multipliers, real_crossing
from vibeam.periodic.sums import Sums, sums
from vibeam.periodic.touching import clearance
from vibeam.system import Drive, ImpactSystem

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
NAMES = ("omega", "amplitude", "gap")
REAL = 1e-9  # imaginary share below which a multiplier counts as real


class Kind(Enum):
    """What happens to a branch of periodic motions at a boundary."""

    FOLD = "two motions meet and vanish: the discriminant is zero, a multiplier is 1"
    GRAZING = "the impact velocity is zero"
    TOUCHING = "the motion touches the stop a second time within its span"
    PLUS_ONE = "a multiplier is 1"
    DOUBLING = "a multiplier is −1: period doubling"
    NEIMARK_SACKER = "a pair of complex multipliers crosses the unit circle"


class Points(NamedTuple):
    """The motions at some points of a line."""

    total: Sums
    roots: Roots
    amplitude: Array
    gap: Array


@dataclass(frozen=True)
class Line:
    """All parameters but ``name`` are held; ``name`` is one of omega (rad/s), amplitude (m), gap (m)."""

    system: ImpactSystem
    periods: int
    name: str
    omega: float
    amplitude: float
    gap: float

    def at(self, values: Array) -> Points:
        """Both motions at ``values`` (points,) of the parameter."""
        rows = {name: np.full(len(values), getattr(self, name)) for name in NAMES} | {self.name: values}
        total = sums(self.system, rows["omega"], self.periods)
        return Points(
            total, balance(self.system, total, rows["amplitude"], rows["gap"]), rows["amplitude"], rows["gap"]
        )

    def moved(self, name: str, value: float) -> Line:
        """The line with one of its held parameters changed."""
        held = {each: float(getattr(self, each)) for each in NAMES} | {name: value}
        return Line(self.system, self.periods, self.name, **held)

    def test(self, kind: Kind, branch: int, points: Points) -> Array:
        """(points,): changes sign where the branch has a boundary of that kind; NaN where there is no motion."""
        found, total = points.roots, points.total
        if kind is Kind.FOLD:
            return found.discriminant / (np.abs(total.unit * points.amplitude) ** 2 * total.g0**2 + 1e-300)
        if kind is Kind.GRAZING:
            return found.impulse[:, branch]
        if kind in (Kind.PLUS_ONE, Kind.DOUBLING):
            side = total.plus if kind is Kind.PLUS_ONE else total.minus
            value = real_crossing(self.system, side, found.lean[:, branch])
        elif kind is Kind.NEIMARK_SACKER:
            value = self._complex_radius(total.span, found.lean[:, branch])
        else:
            value = self._clearances(points, branch)
        return np.where(found.impulse[:, branch] < 0, value, np.nan)

    def _complex_radius(self, span: Array, lean: Array) -> Array:
        """Largest modulus among the multipliers that are not real, less 1; −1 where all are real."""
        result = np.full(len(span), np.nan)
        known = np.isfinite(lean)
        values = multipliers(self.system, span[known], lean[known])
        paired = np.abs(values.imag) > REAL * np.abs(values)
        result[known] = np.where(paired, np.abs(values), 0.0).max(axis=1) - 1
        return result

    def _clearances(self, points: Points, branch: int) -> Array:
        found, result = points.roots, np.full(len(points.gap), np.nan)
        for i in np.flatnonzero(found.impulse[:, branch] < 0):
            system = replace(self.system, gap=float(points.gap[i]))
            drive = Drive(float(points.total.omega[i]), float(points.amplitude[i]))
            phase, impulse = float(found.phase[i, branch]), float(found.impulse[i, branch])
            size = float(np.abs(points.total.unit[i]) * abs(drive.amplitude)) + abs(system.gap)
            result[i] = min(clearance(system, drive, self.periods, phase, impulse) / size, 1.0)
        return result
