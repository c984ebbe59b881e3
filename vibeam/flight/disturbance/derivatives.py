"""Time derivatives along a motion: of gaps and contact forces at given states, of accelerations and jerks.

Gaps and forces come with the sizes of the parts that they are sums of. In every regime

    η'' = l u(t) + s − D η' − Λ η + r,    u = Ω²B sin φ,

with the reaction r of the stop: none in flight, −c F where a linear stop pushes with F = k d + b d', d = c·η − Δ, and
−c F with F = c·(l u + s − D η' − Λ η)/S where the contact is held. So every derivative of η follows from the two before
it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.readout import sides
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array

FREE, HELD, PUSHED = range(3)  # regimes
HIGHEST = 3  # derivative of a signal


class StopRow(NamedTuple):
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

    def scaled(self, factor: float | Array) -> Sum:
        """The product with a number, or with one (n,) for each mode."""
        return Sum(self.value * factor, self.size * np.abs(factor))

    def times(self, matrix: Array) -> Sum:
        """The product with a matrix (n, n) or a row (n,) from the right."""
        return Sum(self.value @ matrix, self.size @ np.abs(matrix))

    def along(self, row: Array) -> Sum:
        """The product (m, n) of a column (m,) and a row."""
        return Sum(self.value[:, None] * row, self.size[:, None] * np.abs(row))


def stop_of(system: ImpactSystem, side: int) -> StopRow:
    """The first stop (0) or the second (1)."""
    if side == 0:
        return StopRow(system.contact, system.gap)
    return StopRow(-system.contact, np.inf if system.second_gap is None else system.second_gap)


class RegimeDerivatives:
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
        return push.plus(slowed).plus(self.known[j].scaled(-(system.omega**2)))

    def _push(self, j: int, stop: StopRow) -> Sum:
        """Derivative j of k d + b d'."""
        spring = self.system.contact_law.spring
        assert spring is not None
        deep, rate = self.known[j].times(stop.row), self.known[j + 1].times(stop.row)
        if j == 0:
            deep = Sum(deep.value - stop.gap, deep.size + abs(stop.gap))
        return deep.scaled(spring.stiffness).plus(rate.scaled(spring.damping))


def exact(values: Array) -> Sum:
    """Values that are known to the bit."""
    return Sum(values, np.abs(values))


def derivative_along(
    system: ImpactSystem, drive: Drive, trace: Array, times: Array, poses: Array, wanted: TimeDerivative, more: int,
    loads: Array | None = None,
) -> Array:  # fmt: skip
    """The output ``wanted`` (m,), or its rate (``more`` 1), at ``times`` (m,) with their ``poses`` (m, 2, n).

    ``loads`` (2, m): of a record there, and their rates. At an event the value after it. ValueError for the rate of an
    acceleration in a contact that is integrated.
    """
    order = wanted.order + more
    if order == 1:
        return np.asarray(poses[:, 1] @ wanted.row)
    from vibeam.flight.contacts.readout import derivatives_in, loads_of

    rows = trace[np.maximum(np.searchsorted(trace[:, layout.START], times, side="right") - 1, 0)]
    if loads is not None:
        found = derivatives_in(system, loads, rows, poses, wanted.row, order)
        return np.asarray(found - wanted.base * loads[order - 2])
    clocks = rows[:, layout.AT_CLOCK] + times - rows[:, layout.START]
    if system.further is not None:
        found = derivatives_in(system, loads_of(drive, clocks), rows, poses, wanted.row, order)
    else:
        found = _modal(system, drive, rows, clocks, poses, order) @ wanted.row
    return np.asarray(found + _of_base(drive, clocks, order, wanted.base))


def _of_base(drive: Drive, clocks: Array, order: int, share: float) -> Array:
    """The derivative of B sin φ of ``order`` 2 or 3, times ``share``."""
    turn = (np.sin if order == 2 else np.cos)(drive.omega * clocks)
    return np.asarray(-share * drive.amplitude * drive.omega**order * turn)


def _modal(system: ImpactSystem, drive: Drive, rows: Array, clocks: Array, poses: Array, order: int) -> Array:
    """η'' or η''' (m, n) at states in the segments ``rows`` (m, columns) of a trace."""
    at, found = sides(rows), np.empty((len(rows), system.size))
    for kind, side in {(float(kind), int(side)) for kind, side in zip(rows[:, layout.WHAT], at, strict=True)}:
        here = (rows[:, layout.WHAT] == kind) & (at == side)
        found[here] = _in_regime(system, drive, kind, side, poses[here], clocks[here], order)
    return found


def _in_regime(
    system: ImpactSystem, drive: Drive, kind: float, side: int, poses: Array, clocks: Array, order: int
) -> Array:
    law = system.contact_law
    if kind == regime_layout.CONTACT and law.integrated:
        if order > 2:
            raise ValueError(f"the jerk in a contact that is integrated, {law.name!r}, is not read")
        row, gap = stop_of(system, side)
        deep, rate = np.maximum(poses[:, 0] @ row - gap, 0.0), poses[:, 1] @ row
        free = RegimeDerivatives(system, drive, FREE, side, poses, clocks).known[order].value
        return np.asarray(free - law.force(deep, rate)[:, None] * row)
    regime = HELD if kind == layout.RESTING else PUSHED if kind == regime_layout.CONTACT else FREE
    return RegimeDerivatives(system, drive, regime, side, poses, clocks).known[order].value
