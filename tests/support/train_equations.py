"""Equations of impact trains: m impacts in n drive periods; given their times, all is linear in their impulses.

With the periodic Green's function G(τ) = Σ c_i² g_i(τ) of ``modal_sums``, contact and restitution at impact j are

    Im(H e^{iΩt_j}) + Σ_k p_k G(t_j − t_k) = Δ
    Ω Re(H e^{iΩt_j}) + Σ_k p_k G'(t_j − t_k − 0) + p_j S/(1 + R) = 0

2m smooth equations in the times and impulses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.linear.propagator import pairs
from vibeam.periodic.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex


class Trains(NamedTuple):
    """Impact trains: drive phases Ωt (points, m), rad, and impulses (points, m), N s, over ``periods`` drive periods
    at drives ``omega`` (points,) rad/s under base motion ``amplitude`` (points,) m."""

    phases: Array
    impulses: Array
    omega: Array
    amplitude: Array
    periods: int

    @property
    def span(self) -> Array:
        """Time after which the motion repeats (points,), s."""
        return np.asarray(2 * np.pi * self.periods / self.omega)

    @property
    def impacts(self) -> int:
        """Number m of impacts."""
        return int(self.phases.shape[1])


def green_at_lags(natural: Array, zeta: Array, trains: Trains) -> tuple[Array, Array]:
    """Green's functions g_i, g_i' (n, points m m) of modes at all lags."""
    g0, g1 = green(natural[:, None], pairs(natural, zeta, trains.span))
    m, own = trains.impacts, np.arange(trains.impacts)
    if m == 1:
        return g0, g1 - 1
    lag = pairs(natural, zeta, lags(trains).ravel())
    p00, p01, p10, p11 = (each.reshape(*g0.shape, m, m) for each in lag[:4])
    g0, g1 = g0[:, :, None, None], g1[:, :, None, None]
    value, slope = p00 * g0 + p01 * g1, p10 * g0 + p11 * g1
    slope[:, :, own, own] -= 1
    return value.reshape(len(natural), -1), slope.reshape(len(natural), -1)


def lags(trains: Trains) -> Array:
    """Lags t_j − t_k (points, m, m) within the span, s, 0 of an impact to itself."""
    apart = (trains.phases[:, :, None] - trains.phases[:, None, :]) / trains.omega[:, None, None]
    return np.asarray(np.mod(apart, trains.span[:, None, None]))


def ahead(phases: Array, trains: Trains) -> Array:
    """Time from each impact to the next one (points, m), s, of ascending ``phases`` (points, m)."""
    whole = np.concatenate([phases, phases[:, :1] + 2 * np.pi * trains.periods], axis=1)
    return np.asarray(np.diff(whole, axis=1) / trains.omega[:, None])


def contact_phasor(system: ImpactSystem, omega: Array, amplitude: Array) -> Complex:
    """Steady response H (points,) of the contact to the drive alone, m."""
    return np.asarray(system.contact @ modal_phasors(system, omega, amplitude))


def modal_phasors(system: ImpactSystem, omega: Array, amplitude: Array) -> Complex:
    """Steady response h (n, points) of the modes to the drive alone: Im(h e^{iΩt}), static displacements aside."""
    natural, sigma = system.omega[:, None], (system.zeta * system.omega)[:, None]
    return np.asarray(amplitude * (system.load[:, None] * phasor(natural, sigma, omega)))


def states_before(system: ImpactSystem, trains: Trains) -> tuple[Array, Array]:
    """Modal displacements and velocities (points, m, n) just before every impact, modes without stiffness at g = 0."""
    struck, m = np.flatnonzero(system.contact), trains.impacts
    shape = len(struck), len(trains.omega), m, m
    c, h = system.contact[struck], modal_phasors(system, trains.omega, trains.amplitude)
    turned = h.T[:, None] * np.exp(1j * trains.phases)[:, :, None]
    displacement, velocity = turned.imag + offsets(system), trains.omega[:, None, None] * turned.real
    both = green_at_lags(system.omega[struck], system.zeta[struck], trains)
    for found, each in zip((displacement, velocity), both, strict=True):
        found[:, :, struck] += np.einsum("ipjk,pk->pji", each.reshape(shape), trains.impulses) * c
    return displacement, velocity


class GreenSums(NamedTuple):
    """Sums Σ c_i² g_i and their derivatives (points, m, m) at the lags t_j − t_k, just before an impact at lag 0."""

    value: Array
    slope: Array
    bend: Array


def green_sums(system: ImpactSystem, trains: Trains) -> GreenSums:
    """Sums over all modes that the contact sees."""
    seen = system.contact != 0
    natural, zeta, square = (row[seen] for row in (system.omega, system.zeta, system.contact**2))
    value, slope = green_at_lags(natural, zeta, trains)
    bend = -2 * (zeta * natural)[:, None] * slope - natural[:, None] ** 2 * value
    shape = (len(trains.omega), trains.impacts, trains.impacts)
    return GreenSums(*((square @ each).reshape(shape) for each in (value, slope, bend)))


def in_time(trains: Trains, before: Array) -> tuple[Array, Array]:
    """Flights (points, m), s, in the order of time, and what is known just ``before`` the impacts at their ends."""
    order = np.argsort(trains.phases, axis=1)
    lasting = ahead(np.take_along_axis(trains.phases, order, axis=1), trains)
    return lasting, np.roll(np.take_along_axis(before, order, axis=1), -1, axis=1)


def residual(system: ImpactSystem, trains: Trains, response: Complex, sums: GreenSums) -> tuple[Array, Array]:
    """Residuals (points, 2m) of contact, m, and restitution, m/s, and their derivatives (points, 2m, 2m).

    Derivatives by the phases, rad, and the impulses; ``response``: the contact's to the drive alone (points,).
    """
    p, m, own = trains.impulses, trains.impacts, np.arange(trains.impacts)
    omega, turned = trains.omega[:, None], response[:, None] * np.exp(1j * trains.phases)
    slopes, (g, v, a), (velocity, push) = np.empty((len(p), 2 * m, 2 * m)), sums, (omega * turned.real, turned.imag)
    for rows, first, drive in ((slice(m), v, velocity), (slice(m, None), a, -(omega**2) * push)):
        off = first.copy()
        off[:, own, own] = 0.0  # an impact's own lag does not change
        by_time = -off * p[:, None]
        by_time[:, own, own] += drive + _times(off, p)
        slopes[:, rows, :m] = by_time / omega[:, :, None]
    slopes[:, :m, m:], slopes[:, m:, m:] = g, v
    slopes[:, m + own, m + own] += system.mobility / (1 + system.restitution)
    height = push + float(system.contact @ offsets(system)) + _times(g, p) - system.gap
    return np.concatenate([height, velocity + _times(slopes[:, m:, m:], p)], axis=1), slopes


def accelerations(trains: Trains, response: Complex, sums: GreenSums) -> Array:
    """Accelerations of the contact (points, m) just before each impact, m/s²; ``response`` as in ``residual``."""
    turned = response[:, None] * np.exp(1j * trains.phases)
    return np.asarray(_times(sums.bend, trains.impulses) - trains.omega[:, None] ** 2 * turned.imag)


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[:, :, None])[:, :, 0])
