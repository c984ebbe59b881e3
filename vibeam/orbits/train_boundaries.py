"""Bifurcations and ends of motions with m impacts in n drive periods, along frequency, amplitude or gap.

The branch is followed by its arc length (Keller's pseudo-arclength continuation) in phases Ωt_j, impulses and the
parameter, so that it goes round its folds; each change of sign of a test function is then bracketed down to round-off.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from vibeam.orbits.bifurcation_functions import NAMES, REAL, Kind
from vibeam.orbits.boundaries import JUMP
from vibeam.orbits.clearance import least_minimum
from vibeam.orbits.modal_sums import offsets
from vibeam.orbits.states import phasors
from vibeam.orbits.train_gap import TrainGap
from vibeam.orbits.train_orbits import TrainOrbit, multipliers_of, states_before
from vibeam.orbits.trains import Train, equations
from vibeam.system.impact_system import Drive, ImpactSystem

Array = NDArray[np.float64]

Complex = NDArray[np.complex128]

KINDS = (Kind.FOLD, Kind.DOUBLING, Kind.NEIMARK_SACKER, Kind.GRAZING, Kind.TOUCHING)

ENDS = (Kind.GRAZING, Kind.TOUCHING)

STEP = 1e-6  # parameter step of the finite differences, as a share of its scale

NEWTON, SMALL, HALVINGS = 12, 1e-12, 20

STRAY = 0.05  # tolerance of the corrector, as a share of a step: a larger one could land on another branch


@dataclass(frozen=True)
class TrainBoundary:
    """One boundary of a motion with m impacts: SI units; the impacts' phases Ωt and velocities, (m,)."""

    kind: Kind
    omega: float
    amplitude: float
    gap: float
    phases: Array
    velocities: Array
    multipliers: Complex


@dataclass(frozen=True)
class _Branch:
    """Equations of the branch in z = (phases, impulses / size, parameter / scale)."""

    start: TrainOrbit
    parameter: str
    size: float
    scale: float

    def at(self, z: Array) -> tuple[ImpactSystem, Drive, float, Train]:
        m, system, drive = len(self.start.times), self.start.system, self.start.drive
        value = float(z[-1] * self.scale)
        if self.parameter == "gap":
            system = replace(system, gap=value)
        else:
            drive = replace(drive, **{self.parameter: value})
        train = Train(z[:m] / drive.omega, z[m:-1] * self.size)
        return system, drive, 2 * np.pi * self.start.periods / drive.omega, train

    def residual(self, z: Array) -> tuple[Array, Array]:
        """Residual (2m,), displacements as velocities, and derivatives (2m, 2m) by phases and scaled impulses."""
        system, drive, span, train = self.at(z)
        values, slopes = equations(system, drive, span, train)
        m = len(train.times)
        rows = np.concatenate([np.full(m, drive.omega), np.ones(m)])
        columns = np.concatenate([np.full(m, 1 / drive.omega), np.full(m, self.size)])
        return rows * values, rows[:, None] * slopes * columns

    def slopes(self, z: Array) -> tuple[Array, Array]:
        """Residual and its derivatives (2m, 2m + 1) by all of z."""
        values, inner = self.residual(z)
        ahead = np.zeros_like(z)
        ahead[-1] = STEP
        outer = (self.residual(z + ahead)[0] - self.residual(z - ahead)[0]) / (2 * STEP)
        return values, np.column_stack([inner, outer])

    def direction(self, z: Array, along: Array) -> Array:
        """Unit tangent in the direction of ``along``."""
        tangent = np.linalg.svd(self.slopes(z)[1])[2][-1]
        return np.asarray(tangent * (1 if tangent @ along > 0 else -1))

    def corrected(self, guess: Array, tangent: Array) -> Array | None:
        """Point of the branch in the plane through ``guess`` normal to ``tangent``; None where none is near."""
        z, last = guess.copy(), np.inf
        for _ in range(NEWTON):
            values, slopes = self.slopes(z)
            both = np.vstack([slopes / self.size, tangent])
            if not np.all(np.isfinite(both)):
                return None
            step = np.linalg.lstsq(both, np.append(values / self.size, tangent @ (z - guess)), rcond=None)[0]
            z, size = z - step, float(np.abs(step).max())
            if size < SMALL or (size < 1e-9 and size > last / 2):
                return z
            last = size
        return None

    def test(self, kind: Kind, z: Array, along: Array) -> float:
        """Test function that changes sign at a boundary of that kind."""
        system, drive, span, train = self.at(z)
        if kind is Kind.FOLD:
            return float(self.direction(z, along)[-1])
        if kind is Kind.GRAZING:
            return float(-train.impulses.max() / self.size)
        if kind is Kind.TOUCHING:
            return clearance(system, drive, span, train)
        values = multipliers_of(system, drive, span, train)
        if kind is Kind.DOUBLING:
            return float(np.prod(1 + values).real)
        paired = np.abs(values.imag) > REAL * np.abs(values)
        return float(np.where(paired, np.abs(values), 0.0).max() - 1)


def train_boundaries(
    orbit: TrainOrbit, parameter: str, to: float, steps: int = 50, longest: int = 500
) -> tuple[TrainBoundary, ...]:
    """Follow ``orbit``'s branch towards ``parameter`` = ``to`` and return its boundaries in order.

    ``parameter``: omega (rad/s), amplitude or gap (m). The branch ends at the first grazing or second touch (proved),
    beyond which it is no motion; at ``to``; where it comes back behind its start; or after ``longest`` steps of at
    most 1/``steps`` of the way. Where it grew out of a shorter motion by period doubling two branches cross: that
    turn may go unseen, the shorter motion's own DOUBLING (``boundaries``) says where it is. Two
    boundaries of one kind within a step are missed. ValueError for an unknown parameter, or an orbit that is not
    admissible.
    """
    if parameter not in NAMES:
        raise ValueError(f"parameter: {parameter!r} is none of {', '.join(NAMES)}")
    if not orbit.admissible:
        raise ValueError("orbit: it passes through the stop, so there is no branch of motions to follow")
    value = {"omega": orbit.drive.omega, "amplitude": orbit.drive.amplitude, "gap": orbit.system.gap}[parameter]
    if to == value:
        return ()
    branch = _Branch(orbit, parameter, float(np.abs(orbit.impulses).max()), abs(to - value))
    begin = np.concatenate([orbit.drive.omega * orbit.times, orbit.impulses / branch.size, [value / branch.scale]])
    return tuple(_follow(branch, begin, float(np.sign(to - value)), 1 / steps, longest))


def _follow(branch: _Branch, begin: Array, towards: float, step: float, longest: int) -> Iterator[TrainBoundary]:
    z, along = begin, np.append(np.zeros(len(begin) - 1), towards)
    along = branch.direction(z, along)
    tests = {kind: branch.test(kind, z, along) for kind in KINDS}
    length = step
    for _ in range(longest):
        length, ahead = min(step, 2 * length), None
        for _ in range(HALVINGS):
            ahead = branch.corrected(z + length * along, along)
            if ahead is not None and np.linalg.norm(ahead - z - length * along) < STRAY * length:
                break
            ahead, length = None, length / 2
        if ahead is None:
            return
        following = {kind: branch.test(kind, ahead, along) for kind in KINDS}
        crossed = [kind for kind in KINDS if tests[kind] * following[kind] < 0]
        found = [(at, kind) for kind in crossed if (at := _root(branch, kind, z, along, length)) is not None]
        for at, kind in sorted(found, key=lambda pair: pair[0]):
            located = branch.corrected(z + at * along, along)
            if located is not None and 0 <= towards * (located[-1] - begin[-1]) <= 1:
                yield _boundary(branch, kind, located)
            if kind in ENDS:
                return
        if not 0 <= towards * (ahead[-1] - begin[-1]) <= 1:
            return
        z, along = ahead, branch.direction(ahead, along)
        tests = following | {Kind.FOLD: float(along[-1])}


def _root(branch: _Branch, kind: Kind, z: Array, along: Array, length: float) -> float | None:
    """Position of the boundary along the step; None where the sign changes by a jump."""

    values: dict[float, float] = {}

    def test(step: float) -> float:
        point = branch.corrected(z + step * along, along)
        if point is None:  # near a crossing of two branches the equations are almost singular
            raise ArithmeticError
        values[step] = branch.test(kind, point, along)
        return values[step]

    try:
        if test(0.0) * test(length) < 0:
            brentq(test, 0.0, length, xtol=1e-15, rtol=4 * np.finfo(float).eps, disp=False)
    except ArithmeticError:
        pass
    sizes = np.abs(np.array(list(values.values())))
    nearest = list(values)[int(np.argmin(sizes))]
    return nearest if len(values) > 2 and sizes.min() <= JUMP * sizes.max() else None


def clearance(system: ImpactSystem, drive: Drive, span: float, train: Train) -> float:
    """Least local minimum of the gap between impacts, certified, as a share of the motion's size, at most 1."""
    after = states_before(system, drive, span, train)
    after = after[0], after[1] + train.impulses[:, None] * system.contact
    h, order = phasors(system, drive), np.argsort(train.times)
    turned = h * np.exp(1j * drive.omega * train.times)[:, None]
    free = np.stack([after[0] - turned.imag - offsets(system), after[1] - drive.omega * turned.real], axis=1)
    times = train.times[order]
    lengths = np.diff(np.append(times, times[0] + span))
    many = np.full(len(times), drive.omega)
    parts = TrainGap(system, many, lengths, (turned @ system.contact)[order], free[order])
    size = float(np.abs(h @ system.contact)) + abs(system.gap)
    return min(float(least_minimum(parts, np.full(len(times), size)).value.min()) / size, 1.0)


def _boundary(branch: _Branch, kind: Kind, z: Array) -> TrainBoundary:
    system, drive, span, train = branch.at(z)
    velocities = -train.impulses * float(system.contact @ system.contact) / (1 + system.restitution)
    values = np.zeros(0, dtype=complex) if kind is Kind.GRAZING else multipliers_of(system, drive, span, train)
    phases = np.mod(drive.omega * train.times, drive.omega * span)
    return TrainBoundary(kind, drive.omega, drive.amplitude, system.gap, phases, velocities, values)
