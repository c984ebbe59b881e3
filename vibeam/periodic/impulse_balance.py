"""Impulse and phase of a periodic motion with one impact a span, from one quadratic equation.

    contact at the impact:      Im(H e^{iψ}) = Δ − p G₀,        Δ = gap less the static contact displacement
    restitution:              Ω Re(H e^{iψ}) = p κ,             κ = R S/(1 + R) − G₁
    hence              (Δ − p G₀)² + (p κ/Ω)² = |H|²

a quadratic in p for any number of modes. It never degenerates to a linear one: its leading coefficient G₀² + (κ/Ω)²
vanishes only together with the middle one, ΔG₀.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vibeam.periodic.modal_sums import Sums
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

DOUBLE = 16 * 2.220446049250313e-16  # relative round-off of a discriminant: the root counts as double


class Roots(NamedTuple):
    """Both roots, (points, 2), the lower impulse first; NaN where they are complex.

    A motion strikes the stop where ``impulse`` < 0. ``discriminant`` (points,) is that of the quadratic, < 0 where
    there is no root; ``relative_acceleration``: contact acceleration over velocity just before impact, 1/s.
    """

    impulse: Array
    phase: Array
    velocity: Array
    relative_acceleration: Array
    discriminant: Array


def balance(system: ImpactSystem, sums: Sums, amplitude: ArrayLike, gap: ArrayLike) -> Roots:
    """Solve for both roots at every frequency of ``sums``; ``amplitude`` and ``gap``, m, one number or one a point."""
    response = np.asarray(sums.unit * np.asarray(amplitude, dtype=float))
    restitution, mobility = system.restitution, float(system.contact @ system.contact)
    turn = (restitution * mobility / (1 + restitution) - sums.g1) / sums.omega
    clear = np.broadcast_to(np.asarray(gap, dtype=float) - sums.offset, sums.omega.shape)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if sums.fixed is None:
            impulse, discriminant = _quadratic(sums.g0, turn, clear, np.abs(response))
            height = clear[:, None] - impulse * sums.g0[:, None]
        else:
            impulse, height, discriminant = _without_stiffness(sums.fixed, turn, np.abs(response))
        phase = np.arctan2(height, impulse * turn[:, None]) - np.angle(response)[:, None]
        velocity = -impulse * mobility / (1 + restitution)
        toward = -(sums.omega**2)[:, None] * height + impulse * sums.g2[:, None]
        return Roots(impulse, np.mod(phase, 2 * np.pi), velocity, toward / velocity, discriminant)


def _quadratic(g0: Array, turn: Array, clear: Array, size: Array) -> tuple[Array, Array]:
    """Roots of (g0² + turn²) p² − 2 clear g0 p + clear² − size² = 0, both to round-off, and its discriminant."""
    lead, middle = g0**2 + turn**2, clear * g0
    last = (clear - size) * (clear + size)
    long, short = size * np.sqrt(lead), np.abs(clear * turn)
    discriminant = (long - short) * (long + short)
    discriminant = np.where(np.abs(discriminant) <= DOUBLE * long**2, 0.0, discriminant)
    root = np.sqrt(discriminant)
    large = middle + np.copysign(root, middle)
    near, far = np.where(large == 0, 0.0, last / np.where(large == 0, 1.0, large)), large / lead
    below = np.signbit(middle)  # sign by copysign: −0 counts as negative, at no gap
    first, second = np.where(below, far, near), np.where(below, near, far)
    return np.stack([first, second], axis=1), discriminant


def _without_stiffness(impulse: Array, turn: Array, size: Array) -> tuple[Array, Array, Array]:
    """Roots with modes without stiffness, where the impulse is given: drive part ±√(size² − (turn p)²)."""
    discriminant = (size - np.abs(turn * impulse)) * (size + np.abs(turn * impulse))
    root = np.sqrt(discriminant)
    both = np.where(np.isnan(root), np.nan, impulse)
    return np.stack([both, both], axis=1), np.stack([-root, root], axis=1), discriminant
