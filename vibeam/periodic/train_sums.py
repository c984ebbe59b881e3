"""Residual of impact trains in any model, for many motions at once, and its exact derivatives.

The equations are those of ``trains``, for motions (points,) with m impacts each: a model of n modes enters by the sums
G, G', G'' over its modes at the m² lags alone, whatever model the train itself comes from.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.propagator import pairs
from vibeam.periodic.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex

REPEATED = 1e-6  # difference of the impacts of a motion that repeats, rad and share of the impulse


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

    def at(self, which: NDArray[np.int64]) -> Trains:
        """Trains of the motions ``which``."""
        phases, impulses, omega, amplitude = (row[which] for row in self[:4])
        return Trains(phases, impulses, omega, amplitude, self.periods)

    def moved(self, phases: Array, impulses: Array) -> Trains:
        """Trains with other phases and impulses."""
        return self._replace(phases=phases, impulses=impulses)


class GreenSums(NamedTuple):
    """Sums Σ c_i² g_i and their derivatives (points, m, m) at the lags t_j − t_k, just before an impact at lag 0."""

    value: Array
    slope: Array
    bend: Array


def green_sums(system: ImpactSystem, trains: Trains) -> GreenSums:
    """Sums over all modes that the contact sees."""
    seen = system.contact != 0
    natural, zeta, square = (row[seen] for row in (system.omega, system.zeta, system.contact**2))
    span, m = trains.span, trains.phases.shape[1]
    g0, g1 = green(natural[:, None], pairs(natural, zeta, span))
    if m == 1:
        value, slope = g0, g1 - 1
    else:
        value, slope = _at_lags(natural, zeta, trains, g0, g1)
    bend = -2 * (zeta * natural)[:, None] * slope - natural[:, None] ** 2 * value
    shape = (len(span), m, m)
    return GreenSums(*((square @ each).reshape(shape) for each in (value, slope, bend)))


def _at_lags(natural: Array, zeta: Array, trains: Trains, g0: Array, g1: Array) -> tuple[Array, Array]:
    """Green's functions g_i, g_i' (n, points m m) at all lags."""
    between, natural_lag = lags(trains)
    m = between.shape[1]
    p = pairs(natural, zeta, between.ravel())
    g0, g1 = (np.repeat(each, m * m, axis=1) for each in (g0, g1))
    return p.p00 * g0 + p.p01 * g1, p.p10 * g0 + p.p11 * g1 - natural_lag.ravel()


def lags(trains: Trains) -> tuple[Array, Array]:
    """Lags t_j − t_k (points, m, m) within the span, s, 0 of an impact to itself; and 1 there, 0 elsewhere."""
    span, own = trains.span[:, None, None], np.eye(trains.phases.shape[1])
    apart = (trains.phases[:, :, None] - trains.phases[:, None, :]) / trains.omega[:, None, None]
    between = np.where(own > 0, 0.0, np.mod(apart, span))
    return between, np.broadcast_to(own, between.shape)


def repeats_sooner(trains: Trains) -> NDArray[np.bool_]:
    """Test (points,) whether a motion repeats after fewer drive periods than the trains' ``periods``."""
    order = np.argsort(trains.phases, axis=1)
    phases, impulses = (np.take_along_axis(row, order, axis=1) for row in (trains.phases, trains.impulses))
    n, m, found = trains.periods, phases.shape[1], np.zeros(len(phases), dtype=bool)
    for sooner in range(1, n):
        if n % sooner == 0 and m * sooner % n == 0:
            impacts = m * sooner // n
            later = np.concatenate([phases, phases + 2 * np.pi * n], axis=1)[:, impacts : impacts + m]
            off = np.abs(later - phases - 2 * np.pi * sooner)
            off = np.maximum(off, np.abs(np.roll(impulses, -impacts, axis=1) / impulses - 1))
            found |= np.all(off <= REPEATED, axis=1)
    return found


def flights(trains: Trains) -> Array:
    """Time from each impact to the next one (points, m), s."""
    order = np.argsort(trains.phases, axis=1)
    found = np.empty_like(trains.phases)
    np.put_along_axis(found, order, ahead(np.take_along_axis(trains.phases, order, axis=1), trains), axis=1)
    return found


def ahead(phases: Array, trains: Trains) -> Array:
    """As ``flights``, of ascending ``phases`` (points, m)."""
    whole = np.concatenate([phases, phases[:, :1] + 2 * np.pi * trains.periods], axis=1)
    return np.asarray(np.diff(whole, axis=1) / trains.omega[:, None])


def contact_phasor(system: ImpactSystem, omega: Array, amplitude: Array, row: Array | None = None) -> Complex:
    """Steady response H (points,) of the contact, or of another ``row``, to the drive alone, m."""
    weight = (system.contact if row is None else row) * system.load
    seen = weight != 0
    natural, sigma = system.omega[seen, None], (system.zeta * system.omega)[seen, None]
    return np.asarray(amplitude * (weight[seen] @ phasor(natural, sigma, omega)))


def modal_phasors(system: ImpactSystem, omega: Array, amplitude: Array) -> Complex:
    """Steady response h (n, points) of the modes to the drive alone: Im(h e^{iΩt})."""
    found, driven = np.zeros((system.size, len(omega)), dtype=complex), system.load != 0
    natural, sigma = system.omega[driven, None], (system.zeta * system.omega)[driven, None]
    found[driven] = amplitude * system.load[driven, None] * phasor(natural, sigma, omega)
    return found


def residual(system: ImpactSystem, trains: Trains, response: Complex, sums: GreenSums) -> tuple[Array, Array]:
    """Residuals (points, 2m) of contact, m, and restitution, m/s, and their derivatives (points, 2m, 2m).

    Derivatives by the phases, rad, and the impulses; ``response``: the contact's to the drive alone (points,).
    """
    p, omega, gap = trains.impulses, trains.omega[:, None], system.gap
    turned = response[:, None] * np.exp(1j * trains.phases)
    g, v, a = sums
    own = np.eye(p.shape[1])
    loss = own * system.mobility / (1 + system.restitution)
    height = turned.imag + float(system.contact @ offsets(system)) + _times(g, p) - gap
    speed = omega * turned.real + _times(v + loss, p)
    by_time = [_by_time(first, p, drive) for first, drive in ((v, omega * turned.real), (a, -(omega**2) * turned.imag))]
    rows = [
        np.concatenate([each / omega[:, :, None], by], axis=2) for each, by in zip(by_time, (g, v + loss), strict=True)
    ]
    return np.concatenate([height, speed], axis=1), np.concatenate(rows, axis=1)


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[:, :, None])[:, :, 0])


def _by_time(slope: Array, impulses: Array, drive: Array) -> Array:
    """Derivatives (points, m, m) by the times: an impact's own lag, 0, does not change."""
    off = np.where(np.eye(slope.shape[1]) > 0, 0.0, slope)
    diagonal = drive + _times(off, impulses)
    return np.asarray(diagonal[:, :, None] * np.eye(slope.shape[1]) - off * impulses[:, None, :])
