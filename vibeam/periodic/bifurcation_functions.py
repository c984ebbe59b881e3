"""Test functions that change sign at a bifurcation or end of a branch, along a line in the parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from vibeam.periodic.clearance import least_minimum
from vibeam.periodic.gap import FlightGap
from vibeam.periodic.modal_sums import Roots, Sums, balance, sums
from vibeam.periodic.multipliers import multipliers, real_crossing
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

DrivePerLevel = Callable[[Array], float | Array]  # amplitude of the drive (points,) at level 1 over omega, rad/s
NAMES = ("omega", "amplitude", "gap")
REAL = 1e-9  # imaginary share below which a multiplier counts as real


class Kind(Enum):
    """Type of a branch's boundary: bifurcation or loss of admissibility.

    >>> import vibeam
    >>> vibeam.Kind.DOUBLING.value
    'a multiplier is −1: period doubling'
    """

    FOLD = "two motions meet and vanish: the discriminant is zero, a multiplier is 1"
    GRAZING = "the impact velocity is zero"
    TOUCHING = "the motion touches the stop a second time within its span"
    PLUS_ONE = "a multiplier is 1"
    DOUBLING = "a multiplier is −1: period doubling"
    NEIMARK_SACKER = "a pair of complex multipliers crosses the unit circle"
    REST = "a rest on the stop begins or ends"
    CONTACT = "a contact that lasted begins to open, or an open one to last"


class MotionsAt(NamedTuple):
    """Periodic motions at points of a line or of any set of parameters."""

    total: Sums
    roots: Roots
    amplitude: Array
    gap: Array


def motions(system: ImpactSystem, periods: int, omega: Array, amplitude: Array, gap: Array) -> MotionsAt:
    """Both motions at points of frequency (rad/s), amplitude and gap (m), all (points,); the system's gap is unused."""
    total = sums(system, omega, periods)
    return MotionsAt(total, balance(system, total, amplitude, gap), amplitude, gap)


def driven(per_level: DrivePerLevel | None, omega: Array) -> Array:
    """Amplitude (points,) of a drive at level 1; without a function of the frequency its level is the amplitude."""
    return np.broadcast_to(np.asarray(1.0 if per_level is None else per_level(omega), dtype=float), omega.shape)


def test_function(system: ImpactSystem, kind: Kind, branch: int, points: MotionsAt) -> Array:
    """Test function (points,): changes sign at a boundary of that kind; NaN where there is no motion."""
    found, total = points.roots, points.total
    if kind is Kind.FOLD:
        return found.discriminant / (np.abs(total.unit * points.amplitude) ** 2 * total.g0**2 + 1e-300)
    if kind is Kind.GRAZING:
        return found.impulse[:, branch]
    if kind in (Kind.PLUS_ONE, Kind.DOUBLING):
        side = total.plus if kind is Kind.PLUS_ONE else total.minus
        value = real_crossing(system, side, found.relative_acceleration[:, branch])
    elif kind is Kind.NEIMARK_SACKER:
        value = _complex_radius(system, total.span, found.relative_acceleration[:, branch])
    else:
        value = clearances(system, points, branch)
    return np.where(found.impulse[:, branch] < 0, value, np.nan)


def _complex_radius(system: ImpactSystem, span: Array, relative_acceleration: Array) -> Array:
    """Largest modulus among the complex multipliers, less 1; −1 where all are real."""
    result = np.full(len(span), np.nan)
    known = np.isfinite(relative_acceleration)
    values = multipliers(system, span[known], relative_acceleration[known])
    paired = np.abs(values.imag) > REAL * np.abs(values)
    result[known] = np.where(paired, np.abs(values), 0.0).max(axis=1) - 1
    return result


def clearances(system: ImpactSystem, points: MotionsAt, branch: int, ceiling: float = 1.0) -> Array:
    """Least local minimum of the gap between impacts, as a share of the motion's size, certified; NaN without one.

    The value is capped at ``ceiling``, also where there is no minimum.
    """
    striking = np.flatnonzero((points.roots.impulse[:, branch] < 0) & np.isfinite(points.roots.phase[:, branch]))
    size = np.abs(points.total.unit * points.amplitude) + np.abs(points.gap)
    flights = FlightGap.of(system, points.total, points.roots, points.amplitude, branch).chosen(striking)
    result = np.full(len(size), np.nan)
    result[striking] = np.minimum(least_minimum(flights, ceiling * size[striking]).value / size[striking], ceiling)
    return result


@dataclass(frozen=True)
class Line:
    """Line in the parameters: all but ``name`` are held; ``name`` is one of omega (rad/s), amplitude (m), gap (m).

    With ``per_level`` the amplitude is that of the drive at level 1, times ``amplitude``, its level.
    """

    system: ImpactSystem
    periods: int
    name: str
    omega: float
    amplitude: float
    gap: float
    per_level: DrivePerLevel | None = None

    def at(self, values: Array) -> MotionsAt:
        """Both motions at ``values`` (points,) of the parameter."""
        rows = {name: np.full(len(values), getattr(self, name)) for name in NAMES} | {self.name: values}
        omega, amplitude, gap = (rows[name] for name in NAMES)
        return motions(self.system, self.periods, omega, amplitude * driven(self.per_level, omega), gap)
