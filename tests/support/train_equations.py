"""Equations of impact trains: m impacts in n drive periods; given their times, all is linear in their impulses.

With the periodic Green's function G(τ) = Σ c_i² g_i(τ) of ``modal_sums``, contact and restitution at impact j are

    Im(H e^{iΩt_j}) + Σ_k p_k G(t_j − t_k) = Δ
    Ω Re(H e^{iΩt_j}) + Σ_k p_k G'(t_j − t_k − 0) + p_j S/(1 + R) = 0

2m smooth equations in the times and impulses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.periodic.modal_sums import offsets
from vibeam.periodic.trains import Trains, ahead, green_at_lags
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex


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
