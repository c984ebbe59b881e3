"""Response of one model near the orbits of another: what a reduced model's motions would be in the full model.

Each orbit is carried over by Newton's method on its impacts; extremes and clearance from the stop come from
``train_signal``, its stability from the multipliers of the modes that last from impact to impact. Nothing is flown. A
motion without impacts is the drive's response alone.

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

from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.modal_sums import offsets
from vibeam.periodic.multipliers import largest, monodromy
from vibeam.periodic.train_signal import clear, excited, extremes, sampled, signal
from vibeam.periodic.train_sums import Trains, ahead, contact_phasor, green_sums, repeats_sooner, residual
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
    turned = response[:, None] * np.exp(1j * now.phases)
    acceleration = (sums.bend @ now.impulses[:, :, None])[:, :, 0] - start.omega[:, None] ** 2 * turned.imag
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


TOGETHER = 1024  # motions computed at once, to bound the memory
LASTS = 1e-6  # share left of a mode at the next impact, below which it takes no part in the stability
SLOWEST = 20  # modes at most in the stability of several impacts


class OrbitKind(Enum):
    """Fate of an orbit in the other model; the value says it in words."""

    ORBIT = "the same motion, stable and clear of the stop between its impacts"
    NO_ORBIT = "no such motion near: too close to a fold, or beyond it"
    STRIKES = "it strikes the stop between its impacts"
    UNSTABLE = "it is unstable"
    TOUCHES = "it touches the stop where the first model does not"
    ANOTHER = "it repeats after fewer periods: another motion"

    @property
    def code(self) -> int:
        """Number in arrays."""
        return list(OrbitKind).index(self)


class PredictedResponse(NamedTuple):
    """Response of the other model (points,), SI units as in ``FrequencyResponse``; NaN where ``found`` is not ORBIT.

    ``uncertainty``: of ``maximum`` and ``minimum``; ``reach_uncertainty``: of the reach. ``first``: size of the first
    Newton correction of the impacts, rad and share of the impulse, 0 without impacts.
    """

    maximum: Array
    minimum: Array
    reach: Array
    impact_velocity: Array
    uncertainty: Array
    reach_uncertainty: Array
    found: NDArray[np.int64]
    first: Array

    @property
    def amplitude(self) -> Array:
        """½(max − min) of the output."""
        return (self.maximum - self.minimum) / 2


def predicted(system: ImpactSystem, trains: Trains, output: str) -> PredictedResponse:
    """Response of ``system`` near orbits with impacts of any other model."""
    count = len(trains.omega)
    pieces = [trains.at(np.arange(first, min(first + TOGETHER, count))) for first in range(0, count, TOGETHER)]
    parts = [_predicted(system, each, output) for each in pieces or [trains]]
    return PredictedResponse._make(np.concatenate(rows) for rows in zip(*parts, strict=True))


def _predicted(system: ImpactSystem, trains: Trains, output: str) -> PredictedResponse:
    near = nearby_orbits(system, trains)
    which = np.flatnonzero(near.found)
    found = np.where(near.found, OrbitKind.ORBIT.code, OrbitKind.NO_ORBIT.code)
    moved, values = near.trains.at(which), np.full((6, len(near.found)), np.nan)
    if len(which):
        m, modes = trains.phases.shape[1], excited(system, moved)
        contact = sampled(signal(system, modes, "contact"))
        own = extremes(contact, m)
        shown = own if output == "contact" else extremes(sampled(signal(system, modes, output)), m)
        speeds = system.impact_velocity(moved.impulses)
        found[which[~clear(contact, system.gap, m)]] = OrbitKind.STRIKES.code
        rows = (shown.maximum, shown.minimum, system.gap - own.minimum, speeds.mean(axis=1))
        values[:, which] = *rows, shown.uncertainty, own.uncertainty
        left = np.flatnonzero(found[which] == OrbitKind.ORBIT.code)
        unstable = left[~_stable(system, moved.at(left), near.acceleration[which[left]])]
        found[which[unstable]] = OrbitKind.UNSTABLE.code
        found[which[repeats_sooner(moved)]] = OrbitKind.ANOTHER.code
    values[:, found != OrbitKind.ORBIT.code] = np.nan
    return PredictedResponse._make((*values, found, near.first))


def predicted_free(system: ImpactSystem, omega: Array, amplitude: Array, output: str) -> PredictedResponse:
    """Response of ``system`` (points,) where it is to stay clear of the stop."""
    derivative = system.derivative(output)
    order, base = (0, 0.0) if derivative is None else (derivative.order, derivative.base)
    row, still = system.row(output), offsets(system)
    size = omega**order * np.abs(contact_phasor(system, omega, amplitude, row) + base * amplitude)
    swing, rest = np.abs(contact_phasor(system, omega, amplitude)), float(system.contact @ still)
    middle = float(row @ still) if order == 0 else 0.0
    free, nothing = swing + rest < system.gap, np.zeros(len(omega))
    rows = (middle + size, middle - size, system.gap - rest + swing, np.full(len(omega), np.nan))
    values = np.where(free, np.stack([*rows, nothing, nothing]), np.nan)
    return PredictedResponse._make((*values, np.where(free, OrbitKind.ORBIT.code, OrbitKind.TOUCHES.code), nothing))


def _stable(system: ImpactSystem, trains: Trains, acceleration: Array) -> Flags:
    """Test whether all multipliers of the modes that last are within the unit circle.

    ``acceleration`` (points, m): of the contact just before each impact.
    """
    if not len(trains.omega):
        return np.zeros(0, dtype=bool)
    velocity = system.impact_velocity(trains.impulses)
    relative = acceleration / velocity
    if trains.phases.shape[1] == 1:
        return np.asarray(largest(system, trains.span, relative[:, 0]) < 1)
    order = np.argsort(trains.phases, axis=1)
    turned = np.take_along_axis(trains.phases, order, axis=1)
    flights, ends = ahead(turned, trains), np.roll(np.take_along_axis(relative, order, axis=1), -1, axis=1)
    left = np.exp(-system.zeta * system.omega * float(flights.min()))
    modes = np.flatnonzero((left > LASTS) | (system.zeta > 1))
    modes = modes[np.argsort(system.omega[modes])][:SLOWEST]
    scale = np.concatenate([system.omega[modes], np.ones(len(modes))])
    whole = np.eye(2 * len(modes))
    for k in range(flights.shape[1]):
        whole = (monodromy(system, flights[:, k], ends[:, k], modes) * scale[:, None] / scale) @ whole
    return np.asarray(np.abs(np.linalg.eigvals(whole)).max(axis=1) < 1)
