"""The motions of a model that are known in closed form, at every frequency of a sweep.

Three kinds: the two with one impact a drive period, harder impact first, and the one that never reaches the stop.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.curve import proven
from vibeam.periodic.line import Points, motions
from vibeam.periodic.multipliers import multipliers, real_crossing
from vibeam.periodic.pair import pair
from vibeam.periodic.sums import fault, green, offsets, phasor
from vibeam.state import State
from vibeam.system import ImpactSystem

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Flags = NDArray[np.bool_]
Index = NDArray[np.int64]
HARDER, SOFTER, FREE = range(3)
KINDS = (HARDER, SOFTER, FREE)


@dataclass(frozen=True, eq=False)
class Known:
    """``omega`` (points,) rad/s, ``amplitude`` (points,) of the base, m. What follows is (points, 3), a kind each."""

    system: ImpactSystem
    omega: Array
    amplitude: Array
    kept: dict[int, Array] = field(default_factory=dict, repr=False)  # states by kind, as they are asked for

    @cached_property
    def _points(self) -> Points:
        return motions(self.system, 1, self.omega, self.amplitude, np.full(len(self.omega), self.system.gap))

    @cached_property
    def _phasors(self) -> Complex:
        """h (n, points): each mode's steady response to the drive alone is Im(h e^{iΩt}) and its static one."""
        own = zip(self.system.omega, self.system.zeta, self.system.load, strict=True)
        return np.array([load * self.amplitude * phasor(rate, zeta * rate, self.omega) for rate, zeta, load in own])

    @cached_property
    def possible(self) -> bool:
        """Whether the model has closed forms at all: every mode has stiffness, and none grows without bound."""
        return bool(np.all(self.system.omega > 0)) and not fault(self.system)

    @cached_property
    def there(self) -> Flags:
        """Where there is such a motion; those with impacts may pass through the stop in between."""
        found = np.zeros((len(self.omega), len(KINDS)), dtype=bool)
        if not self.possible:
            return found
        roots = self._points.roots
        found[:, :2] = (roots.impulse < 0) & np.isfinite(roots.phase) & np.isfinite(roots.lean)
        contact, rest = self.system.contact, float(self.system.contact @ offsets(self.system))
        found[:, FREE] = np.abs(contact @ self._phasors) + rest < self.system.gap
        return found

    @cached_property
    def radius(self) -> Array:
        """The largest Floquet multiplier, by which disturbances shrink a period; ∞ where there is none below 1."""
        found = np.full(self.there.shape, np.inf)
        if not self.possible:
            return found
        total, roots = self._points.total, self._points.roots
        for kind in (HARDER, SOFTER):
            sides = [real_crossing(self.system, side, roots.lean[:, kind]) for side in (total.plus, total.minus)]
            open_ = self.there[:, kind] & ~proven(sides[0]) & ~proven(sides[1])
            largest = np.abs(multipliers(self.system, total.span[open_], roots.lean[open_, kind])[:, 0])
            found[open_, kind] = np.where(largest < 1, largest, np.inf)
        decay = np.exp(-float(np.min(self.system.zeta * self.system.omega)) * 2 * np.pi / self.omega)
        found[:, FREE] = np.where(self.there[:, FREE] & (decay < 1), decay, np.inf)
        return found

    @cached_property
    def leaps(self) -> Array:
        """(points − 1, 3): how far a motion moves to the next frequency, over how far another one is from it.

        Where that is small a sweep that carries its state cannot change over to the other one; 0 where there is none.
        """
        every = np.arange(len(self.omega))
        found = np.zeros((len(self.omega) - 1, len(KINDS)))
        kinds = [kind for kind in KINDS if self.there[:, kind].any()]
        for kind in kinds:
            ours = self.states(every, kind)
            moved = size(self.system, self.omega[1:], np.diff(ours, axis=0))
            for other in kinds:
                both = self.there[:, kind] & self.there[:, other] & (kind != other)
                if both.any():
                    away = np.where(both, size(self.system, self.omega, ours - self.states(every, other)), np.inf)
                    found[:, kind] = np.maximum(found[:, kind], moved / np.minimum(away[1:], away[:-1]))
        return found

    def velocity(self, which: Index, kind: int) -> Array:
        """Impact velocities at the points ``which``, m/s; NaN where nothing strikes."""
        return np.full(len(which), np.nan) if kind == FREE else self._points.roots.velocity[which, kind]

    def states(self, which: Index, kind: int) -> Array:
        """Modal displacements and velocities (m, 2, n) at the drive's phase 0, at the points ``which`` (m,)."""
        if kind not in self.kept:
            self.kept[kind] = self._states(kind)
        return self.kept[kind][which]

    def _states(self, kind: int) -> Array:
        """At all points (points, 2, n); of no meaning where the motion is not there."""
        h = self._phasors
        values = np.stack([h.imag + offsets(self.system)[:, None], self.omega * h.real])
        if kind != FREE and self.there[:, kind].any():
            values += self._struck(kind)
        return np.ascontiguousarray(values.transpose(2, 0, 1))

    def _struck(self, kind: int) -> Array:
        """What the impact train adds (2, n, points): the Green's functions of ``periodic.sums``, some time after."""
        roots, span = self._points.roots, self._points.total.span
        impulse, since = roots.impulse[:, kind], (2 * np.pi - roots.phase[:, kind]) / self.omega
        added = np.zeros((2, self.system.size, len(span)))
        for i in np.flatnonzero(self.system.contact):
            own, zeta = float(self.system.omega[i]), float(self.system.zeta[i])
            g0, g1 = green(own, zeta * own, pair(own, zeta, span))
            p, strength = pair(own, zeta, since), impulse * self.system.contact[i]
            added[0, i] = strength * (p.p00 * g0 + p.p01 * g1)
            added[1, i] = strength * (p.p10 * g0 + p.p11 * g1)
        return added

    def state(self, point: int, kind: int) -> State:
        """One of them."""
        both = self.states(np.array([point]), kind)[0]
        return State(both[0], both[1])


def size(system: ImpactSystem, omega: Array, states: Array) -> Array:
    """The size (points,) of modal states (points, 2, n), or of differences, as a velocity: as the flight's strobes."""
    rates = system.omega**2 + omega[:, None] ** 2
    return np.asarray(np.sqrt(np.sum(states[:, 1] ** 2 + rates * states[:, 0] ** 2, axis=1)))
