"""Time derivatives of gaps and contact forces at given states, with the sizes of the parts that they are sums of.

In every regime η'' = l u(t) + s − D η' − Λ η + r, with u = Ω²B sin φ and the reaction r of the stop: none in flight,
−c F where a linear stop pushes with F = k d + b d', d = c·η − Δ, and −c F with F = c·(l u + s − D η' − Λ η)/S where the
contact is held. So every derivative of η follows from the two before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.linear.regimes import damper_of
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import LinearStop

FREE, HELD, PUSHED = range(3)  # regimes
HIGHEST = 3  # derivative of a signal


class Stop(NamedTuple):
    """One stop: the row c (n,) towards it, and its gap."""

    row: Array
    gap: float


class Sum(NamedTuple):
    """A quantity and the sizes of its parts, added up."""

    value: Array
    size: Array

    def plus(self, other: Sum) -> Sum:
        """The sum of both."""
        return Sum(self.value + other.value, self.size + other.size)

    def scaled(self, factor: float) -> Sum:
        """The product with a number."""
        return Sum(self.value * factor, self.size * abs(factor))

    def times(self, matrix: Array) -> Sum:
        """The product with a matrix (n, n) or a row (n,) from the right."""
        return Sum(self.value @ matrix, self.size @ np.abs(matrix))

    def along(self, row: Array) -> Sum:
        """The product (m, n) of a column (m,) and a row."""
        return Sum(self.value[:, None] * row, self.size[:, None] * np.abs(row))


def stop_of(system: ImpactSystem, side: int) -> Stop:
    """The first stop (0) or the second (1)."""
    if side == 0:
        return Stop(system.contact, system.gap)
    return Stop(-system.contact, np.inf if system.second_gap is None else system.second_gap)


class Derivatives:
    """Derivatives of the motion in one regime from m states (m, 2, n) at times (m,) in the drive period."""

    def __init__(self, system: ImpactSystem, drive: Drive, regime: int, side: int, poses: Array, clocks: Array) -> None:
        """``side``: of the stop that holds or pushes."""
        self.system, self.drive, self.regime, self.stop = system, drive, regime, stop_of(system, side)
        self.clocks, self.damper = clocks, damper_of(system)
        self.known = [exact(poses[:, 0]), exact(poses[:, 1])]
        self.forces: list[Sum] = []
        for j in range(HIGHEST + 1):
            self._extend(j)

    def gap(self, side: int) -> list[Sum]:
        """The gap to a stop and its derivatives."""
        row, gap = stop_of(self.system, side)
        found = [x.times(-row) for x in self.known[: HIGHEST + 1]]
        return [Sum(found[0].value + gap, found[0].size + abs(gap)), *found[1:]]

    def force(self, side: int) -> list[Sum]:
        """The force of the stop and its derivatives: where it pushes or holds, or would push."""
        if self.regime == HELD:
            return self.forces
        return [self._push(j, stop_of(self.system, side)) for j in range(HIGHEST + 1)]

    def _extend(self, j: int) -> None:
        """Add derivative j + 2 of η, and j of the force that holds."""
        free, (row, _) = self._without_stop(j), self.stop
        if self.regime == HELD:
            force = free.times(row / float(row @ row))
            self.forces.append(force)
            free = free.plus(force.along(-row))
        elif self.regime == PUSHED:
            free = free.plus(self._push(j, self.stop).along(-row))
        self.known.append(free)

    def _without_stop(self, j: int) -> Sum:
        """Derivative j of l u + s − D η' − Λ η."""
        system, w = self.system, self.drive.omega
        turn = (np.sin, np.cos)[j % 2](w * self.clocks) * (1, 1, -1, -1)[j % 4]
        strength = w**2 * self.drive.amplitude * w**j
        push = Sum(turn[:, None] * (strength * system.load), np.tile(np.abs(strength * system.load), (len(turn), 1)))
        if j == 0:
            push = Sum(push.value + system.static, push.size + np.abs(system.static))
        slowed = self.known[j + 1].times(-self.damper)
        spring = self.known[j]
        return push.plus(slowed).plus(Sum(-spring.value * system.omega**2, spring.size * system.omega**2))

    def _push(self, j: int, stop: Stop) -> Sum:
        """Derivative j of k d + b d'."""
        law = self.system.law
        assert isinstance(law, LinearStop)
        deep, rate = self.known[j].times(stop.row), self.known[j + 1].times(stop.row)
        if j == 0:
            deep = Sum(deep.value - stop.gap, deep.size + abs(stop.gap))
        return deep.scaled(law.stiffness).plus(rate.scaled(law.damping))


def exact(values: Array) -> Sum:
    """Values that are known to the bit."""
    return Sum(values, np.abs(values))
