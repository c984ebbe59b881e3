"""Closed-form motions of a model at every frequency of a sweep.

Three kinds: the two with one impact a drive period, harder impact first, and the one that never reaches the stop.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from vibeam.flight.linear.propagator import pairs
from vibeam.periodic.bifurcation_functions import MotionsAt, motions
from vibeam.periodic.modal_sums import fault, green, offsets, phasor
from vibeam.periodic.multipliers import largest, real_crossing
from vibeam.periodic.orbit_curve import proven
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex, Flags, Index

HARDER, SOFTER, FREE = range(3)
MANY = 8  # spacing of the points of a coarse scan
KINDS = (HARDER, SOFTER, FREE)


@dataclass(frozen=True, eq=False)
class ClosedForms:
    """Closed-form motions over ``omega`` (points,) rad/s under base motion of ``amplitude`` (points,) m."""

    system: ImpactSystem
    omega: Array
    amplitude: Array
    kept: dict[int, Array] = field(default_factory=dict, repr=False)  # states by kind, computed on demand
    radii: dict[int, Array] = field(default_factory=dict, repr=False)
    relative_steps: dict[int, Array] = field(default_factory=dict, repr=False)

    def at(self, which: Index) -> ClosedForms:
        """Closed forms at the points ``which``; the object itself where it is computed already or they are many."""
        if "_points" in self.__dict__ or len(which) > len(self.omega) // MANY:
            return self
        return ClosedForms(self.system, self.omega[which], self.amplitude[which])

    @cached_property
    def _points(self) -> MotionsAt:
        return motions(self.system, 1, self.omega, self.amplitude, np.full(len(self.omega), self.system.gap))

    @cached_property
    def _phasors(self) -> Complex:
        """Phasors h (n, points): each mode's steady response is Im(h e^{iΩt}) plus its static displacement."""
        natural, sigma = self.system.omega[:, None], (self.system.zeta * self.system.omega)[:, None]
        return self.system.load[:, None] * self.amplitude * phasor(natural, sigma, self.omega)

    @cached_property
    def possible(self) -> bool:
        """Test whether the model has closed forms: every mode has stiffness, and none grows without bound."""
        return bool(np.all(self.system.omega > 0)) and not fault(self.system)

    @cached_property
    def exists(self) -> Flags:
        """Mask of the points with such a motion; those with impacts may be inadmissible."""
        found = np.zeros((len(self.omega), len(KINDS)), dtype=bool)
        if not self.possible:
            return found
        roots = self._points.roots
        found[:, :2] = (roots.impulse < 0) & np.isfinite(roots.phase) & np.isfinite(roots.relative_acceleration)
        contact, rest = self.system.contact, float(self.system.contact @ offsets(self.system))
        found[:, FREE] = np.abs(contact @ self._phasors) + rest < self.system.gap
        return found

    def radius(self, kind: int) -> Array:
        """Upper bound (points,) on the largest Floquet multiplier, the decay of disturbances a period.

        ∞ where it is not below 1, or there is no such motion.
        """
        if kind not in self.radii:
            self.radii[kind] = self._radius(kind)
        return self.radii[kind]

    def _radius(self, kind: int) -> Array:
        found, open_ = np.full(len(self.omega), np.inf), self.exists[:, kind].copy()
        if kind == FREE:
            bound = np.exp(-float(np.min(self.system.zeta * self.system.omega)) * 2 * np.pi / self.omega[open_])
        else:
            total, relative_acceleration = self._points.total, self._points.roots.relative_acceleration[:, kind]
            for side in (total.plus, total.minus) if open_.any() else ():
                open_ &= ~proven(real_crossing(self.system, side, relative_acceleration))
            bound = (
                largest(self.system, total.span[open_], relative_acceleration[open_]) if open_.any() else np.zeros(0)
            )
        found[open_] = np.where(bound < 1, bound, np.inf)
        return found

    def relative_step(self, kind: int) -> Array:
        """Change of a motion to the next frequency over its distance from another motion, (points − 1,).

        Where that is small a sweep that carries its state cannot jump to the other one; 0 where there is none.
        """
        if kind not in self.relative_steps:
            self.relative_steps[kind] = self._relative_step(kind)
        return self.relative_steps[kind]

    def _relative_step(self, kind: int) -> Array:
        every, found = np.arange(len(self.omega)), np.zeros(len(self.omega) - 1)
        for other in KINDS:
            both = self.exists[:, kind] & self.exists[:, other]
            if other != kind and both.any():
                ours, theirs = self.states(every, kind), self.states(every, other)
                moved = size(self.system, self.omega[1:], np.diff(ours, axis=0))
                away = np.where(both, size(self.system, self.omega, ours - theirs), np.inf)
                found = np.maximum(found, moved / np.minimum(away[1:], away[:-1]))
        return found

    def velocity(self, which: Index, kind: int) -> Array:
        """Impact velocities at the points ``which``, m/s; NaN without impacts."""
        return np.full(len(which), np.nan) if kind == FREE else self._points.roots.velocity[which, kind]

    def states(self, which: Index, kind: int) -> Array:
        """Modal displacements and velocities (m, 2, n) at the drive's phase 0, at the points ``which`` (m,)."""
        if kind not in self.kept:
            self.kept[kind] = self._states(kind)
        return self.kept[kind][which]

    def _states(self, kind: int) -> Array:
        """States at all points (points, 2, n); meaningless where the motion does not exist."""
        h = self._phasors
        values = np.stack([h.imag + offsets(self.system)[:, None], self.omega * h.real])
        if kind != FREE and self.exists[:, kind].any():
            values += self._impact_response(kind)
        return np.ascontiguousarray(values.transpose(2, 0, 1))

    def _impact_response(self, kind: int) -> Array:
        """Contribution of the impact train (2, n, points); the Green's functions of ``orbits.modal_sums``."""
        roots, span = self._points.roots, self._points.total.span
        impulse, since = roots.impulse[:, kind], (2 * np.pi - roots.phase[:, kind]) / self.omega
        hit = self.system.contact != 0
        natural, zeta, contact = (row[hit] for row in (self.system.omega, self.system.zeta, self.system.contact))
        g0, g1 = green(natural[:, None], (zeta * natural)[:, None], pairs(natural, zeta, span))
        p, strength = pairs(natural, zeta, since), impulse * contact[:, None]
        added = np.zeros((2, self.system.size, len(span)))
        added[:, hit] = strength * (p.p00 * g0 + p.p01 * g1), strength * (p.p10 * g0 + p.p11 * g1)
        return added

    def state(self, point: int, kind: int) -> State:
        """State (2, n) at one point."""
        both = self.states(np.array([point]), kind)[0]
        return State(both[0], both[1])


def size(system: ImpactSystem, omega: Array, states: Array) -> Array:
    """Norm (points,) of modal states (points, 2, n), or of differences, as a velocity: that of the flight's strobes."""
    rates = system.omega**2 + omega[:, None] ** 2
    return np.asarray(np.sqrt(np.sum(states[:, 1] ** 2 + rates * states[:, 0] ** 2, axis=1)))
