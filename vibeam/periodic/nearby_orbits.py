"""Orbits of one model near those of another, by Newton's method on their impacts; their stability.

An exact orbit of a reduced model has impacts at drive phases φ_j with impulses p_j. In the full model F(φ, p) = 0 says
that each impact happens at the gap and obeys the restitution (``trains``); the reduced orbit leaves there the residual

    r = F(φ, p) = what all modes that the reduced model lacks do at its own impacts, drive and impulse train alike,

in closed form, 2m numbers whatever the number of modes. Newton's correction δ = −J⁻¹ r, J = ∂F/∂(φ, p), is the change
of the impacts; J is singular where a multiplier of the full orbit is 1, det J ∝ det(1 − DP) of its return map P, so
that δ grows without bound at a fold. The quadratic remainder is judged by the contraction Θ = |δ₂|/|δ₁| of the first
two corrections (affine invariant Newton–Mysovskikh: Θ < ½ where the orbit exists and is unique nearby; Deuflhard,
Newton Methods for Nonlinear Problems, 2004, §2.1), and by the sign of det J, which changes at a fold: an orbit found
beyond one is another orbit. Phases are measured in rad, impulses in shares of the largest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.periodic.multipliers import largest, multipliers
from vibeam.periodic.trains import Trains, accelerations, ahead, contact_phasor, green_sums, in_time, residual
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Flags

STEPS = 8
CONTRACTS = 0.5  # largest Θ of a correction that is trusted
CLOSED = 1e-10  # last correction of an orbit that counts as found, rad and share of the impulse


class NearbyOrbits(NamedTuple):
    """Orbits of the other model: ``trains`` within [0, 2πn), in the order of the first model's impacts.

    ``found``: Newton's method contracts to an orbit on the same side of any fold, all of its impacts push away from
    the stop. ``first``: size of the first correction, rad and share of the impulse, (points,).
    ``acceleration`` (points, m): of the contact just before each impact, m/s².
    """

    trains: Trains
    found: Flags
    first: Array
    acceleration: Array


def nearby_orbits(system: ImpactSystem, start: Trains) -> NearbyOrbits:
    """Correct the orbits ``start`` of any other model to those of ``system``; cost linear in the number of modes."""
    scale = np.abs(start.impulses).max(axis=1, keepdims=True)
    m, now, sizes, signs = start.phases.shape[1], start, [], []
    response, sums = contact_phasor(system, start.omega, start.amplitude), green_sums(system, start)
    for _ in range(STEPS):
        value, slopes = residual(system, now, response, sums)
        slopes[:, :, m:] *= scale[:, :, None]
        step, sign = _solved(slopes, value)
        signs.append(sign)
        sizes.append(np.abs(step).max(axis=1))
        now = now.moved(now.phases - step[:, :m], now.impulses - step[:, m:] * scale)
        if not np.any(sizes[-1] > CLOSED) or not np.isfinite(sizes[-1]).any():
            break
        sums = sums if m == 1 else green_sums(system, now)  # an impact's lag to itself stays
    first, second = sizes[0], sizes[min(1, len(sizes) - 1)]
    contraction = second / np.maximum(first, 1e-300) if len(sizes) > 1 else np.zeros_like(first)
    found = (sizes[-1] <= CLOSED) & ((contraction < CONTRACTS) | (first <= CLOSED)) & (signs[0] == signs[-1])
    found &= np.all(now.impulses < 0, axis=1) & _in_order(start, now)
    acceleration = accelerations(now, response, sums)
    whole = now.moved(np.mod(now.phases, 2 * np.pi * now.periods), now.impulses)
    return NearbyOrbits(whole, found, first, acceleration)


def _solved(slopes: Array, value: Array) -> tuple[Array, Array]:
    """Newton's steps (points, 2m), NaN where singular, and the sign of the determinant."""
    good = np.isfinite(slopes).all(axis=(1, 2)) & np.isfinite(value).all(axis=1)
    sign = np.zeros(len(value))
    sign[good] = np.linalg.slogdet(slopes[good])[0]
    good &= sign != 0
    step = np.full(value.shape, np.nan)
    step[good] = np.linalg.solve(slopes[good], value[good][:, :, None])[:, :, 0]
    return step, sign


def _in_order(start: Trains, now: Trains) -> Flags:
    """Test whether the impacts follow one another as before, none overtaken."""
    order = np.argsort(start.phases, axis=1)
    return np.asarray(np.all(ahead(np.take_along_axis(now.phases, order, axis=1), now) > 0, axis=1))


LASTS = 1e-6  # share left of a mode at the next impact, below which it takes no part in the stability
SLOWEST = 20  # modes at most in the stability of several impacts


def stable_trains(system: ImpactSystem, trains: Trains, acceleration: Array) -> Flags:
    """Test whether all multipliers of the modes that last are within the unit circle.

    ``acceleration`` (points, m): of the contact just before each impact.
    """
    if not len(trains.omega):
        return np.zeros(0, dtype=bool)
    velocity = system.impact_velocity(trains.impulses)
    relative = acceleration / velocity
    if trains.phases.shape[1] == 1:
        return np.asarray(largest(system, trains.span, relative[:, 0]) < 1)
    flights, ends = in_time(trains, relative)
    left = np.exp(-system.zeta * system.omega * float(flights.min()))
    modes = np.flatnonzero((left > LASTS) | (system.zeta > 1))
    modes = modes[np.argsort(system.omega[modes])][:SLOWEST]
    return np.asarray(np.abs(multipliers(system, flights, ends, modes)[:, 0]) < 1)
