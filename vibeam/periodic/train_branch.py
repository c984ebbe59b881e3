"""The branch of motions with m impacts in n drive periods, in phases Ωt_j, impulses, one parameter; test functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vibeam.periodic.bifurcation_functions import REAL, Kind
from vibeam.periodic.clearance import least_minimum
from vibeam.periodic.modal_sums import offsets
from vibeam.periodic.states import phasors
from vibeam.periodic.train_gap import TrainGap
from vibeam.periodic.train_orbits import multipliers_of, states_before
from vibeam.periodic.trains import Train, equations
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

STEP = 1e-6  # parameter step of the finite differences, as a share of its scale
NEWTON, SMALL = 12, 1e-12
Setting = Callable[[float], tuple[ImpactSystem, Drive]]


@dataclass(frozen=True)
class Branch:
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
