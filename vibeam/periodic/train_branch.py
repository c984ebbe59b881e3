"""Branch of motions with m impacts in n drive periods, in phases Ωt_j, impulses, one parameter; test functions.

It was born by period doubling of a motion with half as many impacts: there the branch crosses that of the shorter
motion. Of a train (θ_j, p_j) whose second half is the first one, half a span later, let the asymmetry be

    d = (θ_{j+m/2} − θ_j − Ωspan/2,  p_{j+m/2} − p_j),        j = 1 … m/2

Shifted by half a span the train is the same motion with −d, so that along the branch the parameter is even in d: μ = μ₀
+ α|d|² + O(|d|⁴), a FOLD of the branch at d = 0. If the doubling is subcritical another one follows at |d|² ~ −α/2β, as
near as you like. At d = 0 the equations are singular, and a step may land on the shorter motion's branch or go past
both folds. So a birth is looked for ahead of every step where d goes down, on the shorter motion's branch, where it is
a simple root of ∏(1 + λ) over the multipliers; and points between are found with d, not arc length, held.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from vibeam.periodic.bifurcation_functions import REAL, Kind
from vibeam.periodic.clearance import least_minimum
from vibeam.periodic.gap import FlightGap
from vibeam.periodic.modal_sums import offsets
from vibeam.periodic.train_orbits import multipliers_of
from vibeam.periodic.trains import Train, equations, phasors, states_before
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

STEP = 1e-6  # parameter step of the finite differences, as a share of its scale
NEWTON, SMALL = 12, 1e-12
Setting = Callable[[float], tuple[ImpactSystem, Drive]]


@dataclass(frozen=True)
class TrainBranch:
    """Equations of the branch in z = (phases, impulses / size, parameter / scale).

    ``setting``: system and drive at a value of the parameter; ``size``: of an impulse; ``scale``: of the parameter.
    """

    impacts: int
    periods: int
    setting: Setting
    size: float
    scale: float

    def at(self, z: Array) -> tuple[ImpactSystem, Drive, float, Train]:
        """System, drive, span in s and impacts at z."""
        m = self.impacts
        system, drive = self.setting(float(z[-1] * self.scale))
        train = Train(z[:m] / drive.omega, z[m:-1] * self.size)
        return system, drive, 2 * np.pi * self.periods / drive.omega, train

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

    def beside(self, z: Array, along: Array, length: float) -> Array | None:
        """Point of the branch by the plane through z + length · along."""
        return self.corrected(z + length * along, along)

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


def clearance(system: ImpactSystem, drive: Drive, span: float, train: Train) -> float:
    """Least local minimum of the gap between impacts, certified, as a share of the motion's size, at most 1."""
    at, before = (each[0] for each in states_before(system, train.under(drive, span)))
    after = at, before + train.impulses[:, None] * system.contact
    h, order = phasors(system, drive), np.argsort(train.times)
    turned = h * np.exp(1j * drive.omega * train.times)[:, None]
    free = np.stack([after[0] - turned.imag - offsets(system), after[1] - drive.omega * turned.real], axis=1)
    times = train.times[order]
    lengths = np.diff(np.append(times, times[0] + span))
    many = np.full(len(times), drive.omega)
    parts = FlightGap(system, many, lengths, (turned @ system.contact)[order], free[order].T)
    size = float(np.abs(h @ system.contact)) + abs(system.gap)
    return min(float(least_minimum(parts, np.full(len(times), size)).value.min()) / size, 1.0)


NEAR = 0.5  # share to which a step takes the asymmetry down, by its tangent, for a birth to be looked for
REACH = 3.0  # steps within which it must lie
NONE = 1e-9  # asymmetry that is none: the train is the shorter motion, gone through twice
SECANT, ROOT = 30, 1e-14  # steps, and change of the parameter at which they end
SHARES = 0.5 ** np.arange(1, 10)  # of the asymmetry at the start of a step at which points before a birth are taken


def asymmetry(branch: TrainBranch, z: Array) -> Array:
    """d (m,); empty where m or the number of periods is odd."""
    m, periods = branch.impacts, branch.periods
    if m % 2 or periods % 2:
        return np.zeros(0)
    phases, impulses = z[:m].reshape(2, -1), z[m:-1].reshape(2, -1)
    return np.concatenate([phases[1] - phases[0] - np.pi * periods, impulses[1] - impulses[0]])


def birth_ahead(branch: TrainBranch, z: Array, along: Array, step: float) -> Array | None:
    """The point of birth by doubling that lies within reach of a step from z, or None."""
    now, then = asymmetry(branch, z), asymmetry(branch, z + step * along)
    size = float(np.linalg.norm(now)) if len(now) else 0.0
    if size < NONE or float(now @ then) > NEAR * size**2:
        return None
    found = _doubling(branch, z, step)
    if found is None or np.linalg.norm(found - z) > REACH * step or point_before(branch, z, found, SHARES[0]) is None:
        return None
    return found


def shares_before(branch: TrainBranch, z: Array, birth: Array) -> tuple[list[float], float]:
    """Shares of the asymmetry at z, down to where the parameter goes on one way to the birth; and which way, ±1."""
    points = {share: point for share in SHARES if (point := point_before(branch, z, birth, share)) is not None}
    way, along = float(np.sign(birth[-1] - list(points.values())[-1][-1])), inward(branch, z)
    same = [share for share, point in points.items() if np.sign(branch.direction(point, along)[-1]) == way]
    last = same[0] if same else list(points)[-1]
    return [share for share in points if share >= last], way


def inward(branch: TrainBranch, z: Array) -> Array:
    """The unit vector along which the asymmetry at z goes down."""
    m, apart = branch.impacts, asymmetry(branch, z)
    row = np.concatenate([apart[: m // 2], -apart[: m // 2], apart[m // 2 :], -apart[m // 2 :], [0.0]])
    return np.asarray(row / np.linalg.norm(row))


def point_before(branch: TrainBranch, z: Array, birth: Array, share: float) -> Array | None:
    """The point of the branch with that share of the asymmetry at z."""
    return branch.corrected(birth + share * (z - birth), inward(branch, z))


def _doubling(branch: TrainBranch, z: Array, step: float) -> Array | None:
    """The shorter motion's doubling nearest to z, as a point of the longer one's branch; by the secant method."""
    m, half = branch.impacts, branch.impacts // 2
    short = replace(branch, impacts=half, periods=branch.periods // 2)
    fixed = np.append(np.zeros(m), 1.0)
    phases, impulses = z[:m].reshape(2, -1), z[m:-1].reshape(2, -1)
    point = np.concatenate([(phases[0] + phases[1] - np.pi * branch.periods) / 2, impulses.mean(axis=0), z[-1:]])

    @cache
    def at(value: float) -> tuple[Array | None, float]:
        found = short.corrected(np.append(point[:-1], value), fixed)
        return found, np.nan if found is None else short.test(Kind.DOUBLING, found, fixed)

    for before, value in _secant(lambda value: at(value)[1], float(z[-1]), float(z[-1]) + step / 10):
        if abs(value - before) <= ROOT * max(abs(value), 1.0):
            found = at(value)[0]
            return None if found is None else twice(found, half, branch.periods)
    return None


def _secant(function, first: float, second: float) -> Iterator[tuple[float, float]]:  # type: ignore[no-untyped-def]
    """Pairs of successive points; it ends where the function has no value or no slope."""
    low, high = function(first), function(second)
    for _ in range(SECANT):
        if not np.isfinite(low + high) or low == high:
            if high == 0.0:
                yield second, second
            return
        first, second, low = second, second - high * (second - first) / (high - low), high
        high = function(second)
        yield first, second


def twice(found: Array, half: int, periods: int) -> Array:
    """A motion of ``half`` impacts as one of twice as many in ``periods`` drive periods."""
    phases, impulses = found[:half], found[half:-1]
    return np.concatenate([phases, phases + np.pi * periods, impulses, impulses, found[-1:]])
