"""The motions of a model that are known in closed form, at every frequency of a sweep.

Three kinds: the two with one impact a drive period, harder impact first, and the one that never reaches the stop.
"""

from __future__ import annotations

from dataclasses import dataclass
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
        scale = np.stack([np.hypot.outer(self.omega, self.system.omega), np.ones((len(self.omega), self.system.size))], 1)
        states = [self.states(np.arange(len(self.omega)), kind) * scale for kind in KINDS]
        found = np.zeros((len(self.omega) - 1, len(KINDS)))
        for kind in KINDS:
            moved = np.linalg.norm(np.diff(states[kind], axis=0), axis=(1, 2))
            for other in KINDS:
                both = self.there[:, kind] & self.there[:, other] & (kind != other)
                away = np.where(both, np.linalg.norm(states[kind] - states[other], axis=(1, 2)), np.inf)
                found[:, kind] = np.maximum(found[:, kind], moved / np.minimum(away[1:], away[:-1]))
        return found

    def velocity(self, which: Index, kind: int) -> Array:
        """Impact velocities at the points ``which``, m/s; NaN where nothing strikes."""
        return np.full(len(which), np.nan) if kind == FREE else self._points.roots.velocity[which, kind]

    def states(self, which: Index, kind: int) -> Array:
        """Modal displacements and velocities (m, 2, n) at the drive's phase 0, at the points ``which`` (m,)."""
        h, omega = self._phasors[:, which], self.omega[which]
        values = np.stack([h.imag + offsets(self.system)[:, None], omega * h.real])
        if kind != FREE:
            values += self._struck(which, kind)
        return np.ascontiguousarray(values.transpose(2, 0, 1))

    def _struck(self, which: Index, kind: int) -> Array:
        """What the impact train adds (2, n, m): the Green's functions of ``periodic.sums``, a while after the impact."""
        roots, span = self._points.roots, self._points.total.span[which]
        impulse, since = roots.impulse[which, kind], (2 * np.pi - roots.phase[which, kind]) / self.omega[which]
        added = np.zeros((2, self.system.size, len(which)))
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


def size(system: ImpactSystem, omega: float, both: Array) -> float:
    """The size of a modal state (2, n), or of the difference of two, as a velocity: as the flight solver's strobes."""
    return float(np.sqrt(np.sum(both[1] ** 2 + (system.omega**2 + omega**2) * both[0] ** 2)))
