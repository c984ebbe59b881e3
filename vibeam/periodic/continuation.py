"""Points of a branch of periodic motions: z = (state at a section, one parameter) with P(z) = state.

P is the flight over n drive periods from a fixed phase of the drive, the section. With the state x in units of
velocity over the motion's size, and the parameter over its scale, a branch is the curve F(z) = P(z) − x = 0. Its
derivatives by x are the exact tangent maps of the motion, M − 1; the one by the parameter is a central difference. A
step goes along the tangent t and comes back in the plane normal to it (pseudo-arclength: Keller 1977; Allgower & Georg
1990, ch. 6): F(z) = 0, t·(z − z₀ − s t) = 0, which is regular at folds too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.readout import rests, sides
from vibeam.flight.solver import ExactSolver, exact_solver
from vibeam.periodic.stroboscopic import Flown, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex

Setting = Callable[[float], tuple[ImpactSystem, Drive]]
STEP = 1e-6  # of the parameter in its central difference, as a share of its scale
NEWTON, RENEWED = 14, (3, 6, 9)  # steps; those at which the derivative by the parameter is renewed
SMALL, STALLED, LATE = 1e-13, (1e-10, 1e-6), 6  # size of a step at which they end, also where round-off stops them
ASTRAY = 2.0  # a step longer than this share of the motion leads elsewhere
REAL = 1e-9  # imaginary share below which a multiplier counts as real
SLOWER = 0.75  # share of a drive's frequency for which its solver is made
EDGE = 0.2  # share of the longest flight that the section keeps from the events around it


class Itinerary(NamedTuple):
    """Events of a motion in one span: impacts, or touches of a stop that yields, at each contact; rests; any flight.

    Where it rests its impacts are not counted: infinitely many come before.
    """

    touches: tuple[int, ...]  # up to the last contact that is touched
    rests: int
    flies: bool


@dataclass(frozen=True)
class BranchPoint:
    """Periodic motion at a section: z, its flight over a span from there, and M (2n, 2n) in units of velocity."""

    section: BranchSection
    z: Array
    state: State
    chart: StroboscopicMap
    flown: Flown
    monodromy: Array

    @property
    def value(self) -> float:
        """Parameter."""
        return self.section.value(self.z)

    @cached_property
    def multipliers(self) -> Complex:
        """Eigenvalues (2n,) of M, largest first."""
        found = np.linalg.eigvals(self.monodromy).astype(complex)
        return np.asarray(found[np.argsort(-np.abs(found), kind="stable")])

    @cached_property
    def itinerary(self) -> Itinerary:
        """Events in one span."""
        trace = self.flown.segments.trace
        still, free = rests(trace), trace[:, layout.WHAT] == layout.FREE
        number = int(still.sum() - (len(trace) > 1 and still[0] and still[-1]))  # one that the section cuts is one
        struck = (trace[:, layout.END] == layout.IMPACT) & (trace[:, layout.BEFORE] > 0)
        counts = np.bincount(sides(trace)[struck])
        return Itinerary(() if number else tuple(counts.tolist()), number, bool(free.any()))

    @property
    def at_plus_one(self) -> float:
        """∏(1 − μ) over the multipliers: changes sign at a fold."""
        return float(np.linalg.det(np.eye(len(self.monodromy)) - self.monodromy))

    @property
    def at_minus_one(self) -> float:
        """∏(1 + μ): changes sign at a period doubling."""
        return float(np.linalg.det(np.eye(len(self.monodromy)) + self.monodromy))

    @property
    def on_circle(self) -> float:
        """∏(1 − μ_j μ_k) over pairs: changes sign where a complex pair, or two real ones, have the product 1."""
        return float(np.prod([1 - a * b for a, b in combinations(self.multipliers, 2)]).real)


class Runners:
    """Exact solver of the last system that a branch came to, kept for drives that it was made for."""

    def __init__(self) -> None:
        self.last: tuple[ImpactSystem, float, ExactSolver] | None = None

    def of(self, system: ImpactSystem, drive: Drive) -> ExactSolver:
        """The solver of a system at a drive."""
        if self.last is not None:
            known, slowest, runner = self.last
            if slowest <= drive.omega <= SLOWER**-2 * slowest and (known is system or known.moves_as(system)):
                return runner
        slowest = SLOWER * drive.omega
        self.last = system, slowest, exact_solver(system, slowest)
        return self.last[2]


@dataclass(frozen=True)
class BranchSection:
    """Section at a ``phase`` of the drive, 0 … 2π, and the scales of z.

    ``units`` (2n,): factors that make a state one of velocities; ``size``: of the motion in them; ``scale``: of the
    parameter.
    """

    setting: Setting
    periods: int
    phase: float
    units: Array
    size: float
    scale: float
    resting: bool = False
    runners: Runners = field(default_factory=Runners, compare=False)

    @classmethod
    def of(cls, setting: Setting, periods: int, time: float, state: State, value: float, scale: float) -> BranchSection:
        """Section through a ``state`` at the drive's ``time``, s, of a motion at ``value`` of the parameter."""
        system, drive = setting(value)
        there = StroboscopicMap(system, drive, time)
        size = float(np.linalg.norm(there.vector(state))) or 1.0
        return cls(setting, periods, drive.omega * time % (2 * np.pi), there.units, size, scale, state.resting)

    def place(self, state: State, value: float) -> Array:
        """The z of a state and a value of the parameter."""
        both = np.concatenate([state.displacement, state.velocity]) * self.units / self.size
        return np.append(both, value / self.scale)

    def value(self, z: Array) -> float:
        """Parameter at z."""
        return float(z[-1] * self.scale)

    def state(self, z: Array) -> State:
        """State at z."""
        values = z[:-1] * self.size / self.units
        return State(values[: len(values) // 2], values[len(values) // 2 :], self.resting)

    def map_at(self, value: float) -> StroboscopicMap:
        """Stroboscopic map at a value of the parameter."""
        system, drive = self.setting(value)
        return StroboscopicMap(system, drive, self.phase / drive.omega, runner=self.runners.of(system, drive))

    def residual(self, z: Array) -> tuple[Array, StroboscopicMap, Flown]:
        """F(z) (2n,), the map there and the flight; ArithmeticError where that ends on the way."""
        if not np.isfinite(z).all():
            raise ArithmeticError
        chart = self.map_at(self.value(z))
        flown = chart.flown(self.state(z), self.periods)
        return self.place(flown.state, 0.0)[:-1] - z[:-1], chart, flown

    def point(self, z: Array) -> BranchPoint:
        """The motion from z as it is flown, periodic or not; ArithmeticError where it ends on the way."""
        _, chart, flown = self.residual(z)
        return BranchPoint(self, z, self.state(z), chart, flown, self.monodromy(z, chart, flown))

    def monodromy(self, z: Array, chart: StroboscopicMap, flown: Flown) -> Array:
        """M (2n, 2n) of a flight from z, in units of velocity."""
        ratio = self.units / chart.units
        return np.asarray(chart.jacobian(self.state(z), self.periods, flown) * (ratio[:, None] / ratio))

    def slope(self, z: Array) -> Array:
        """Derivative (2n,) of F by the scaled parameter."""
        ahead = np.zeros_like(z)
        ahead[-1] = STEP
        return np.asarray((self.residual(z + ahead)[0] - self.residual(z - ahead)[0]) / (2 * STEP))

    def tangent(self, point: BranchPoint, slope: Array) -> Array:
        """Unit tangent of the branch, one way or the other."""
        rows = np.column_stack([point.monodromy - np.eye(len(slope)), slope])
        return np.asarray(np.linalg.svd(rows)[2][-1])

    def corrected(self, guess: Array, normal: Array, slope: Array) -> BranchPoint | None:
        """Point of the branch in the plane through ``guess`` with this ``normal``; None where Newton finds none."""
        z, last = guess.copy(), np.inf
        try:
            for turn in range(NEWTON):
                values, chart, flown = self.residual(z)
                slope = self.slope(z) if turn in RENEWED else slope
                matrix = self.monodromy(z, chart, flown)
                rows = np.vstack([np.column_stack([matrix - np.eye(len(values)), slope]), normal])
                step = np.linalg.lstsq(rows, np.append(values, normal @ (z - guess)), rcond=None)[0]
                length = float(np.linalg.norm(step))
                if length <= SMALL * (1 + float(np.linalg.norm(z))) or (
                    length < STALLED[turn >= LATE] and length >= last / 2
                ):
                    return BranchPoint(self, z, self.state(z), chart, flown, matrix)
                if not length <= ASTRAY:
                    return None
                z, last = z - step, length
        except (ArithmeticError, ValueError):
            return None
        return None

    def moved(self, phase: float) -> BranchSection:
        """The same scales at another phase."""
        return replace(self, phase=phase % (2 * np.pi))

    def carried(self, z: Array, turn: float) -> Array:
        """The z of the motion when the drive's phase has gone on by ``turn``."""
        value = self.value(z)
        flown = self.map_at(value).flown(self.state(z), turn / (2 * np.pi))
        return self.place(flown.state, value)


def better_phase(point: BranchPoint) -> float | None:
    """Phase by which the section should go on to the middle of the longest flight; None where it is well in one."""
    omega, trace = point.flown.drive.omega, point.flown.segments.trace
    begin, end = trace[:, layout.START], trace[:, layout.START] + trace[:, layout.DURATION]
    free, first, last = trace[:, layout.WHAT] == layout.FREE, float(begin[0]), float(end[-1])
    inner = np.flatnonzero(free[1:-1]) + 1
    if len(trace) < 2 or not free.any():
        return None
    before, after = (last - float(begin[-1])) * free[-1], (float(end[0]) - first) * free[0]
    longest = max((float(end[i] - begin[i]) for i in inner), default=0.0)
    if min(before, after) >= EDGE * max(longest, before + after):
        return None
    if before + after >= longest:
        middle = (end[0] + begin[-1] - (last - first)) / 2
        return float(omega * ((middle - first) % (last - first)))
    best = max(inner, key=lambda i: end[i] - begin[i])
    return float(omega * ((begin[best] + end[best]) / 2 - first))
