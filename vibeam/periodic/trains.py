"""Impact trains: m impacts in n drive periods, of many motions at once; given their times, all is linear in impulses.

What the modes do is the drive's response and Σ_k p_k c_i g_i(t − t_k), with the periodic Green's functions g_i.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.linear.propagator import pairs, propagators
from vibeam.periodic.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex, Index

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

    @property
    def impacts(self) -> int:
        """Number m of impacts."""
        return int(self.phases.shape[1])

    def at(self, which: Index) -> Trains:
        """Trains of the motions ``which``."""
        phases, impulses, omega, amplitude = (row[which] for row in self[:4])
        return Trains(phases, impulses, omega, amplitude, self.periods)


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


def modal_phasors(system: ImpactSystem, omega: Array, amplitude: Array | float) -> Complex:
    """Steady response h (n, points) of the modes to the drive alone: Im(h e^{iΩt}), static displacements aside."""
    found, driven = np.zeros((system.size, len(omega)), dtype=complex), system.load != 0
    natural, sigma = system.omega[driven, None], (system.zeta * system.omega)[driven, None]
    found[driven] = amplitude * (system.load[driven, None] * phasor(natural, sigma, omega))
    return found


def phasors(system: ImpactSystem, drive: Drive) -> Complex:
    """As ``modal_phasors`` (n,), of one drive."""
    return modal_phasors(system, np.array([drive.omega]), drive.amplitude)[:, 0]


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


def state_after(system: ImpactSystem, drive: Drive, periods: int, phase: float, impulse: float) -> State:
    """State just after the impact of a motion with one a span; the contact lies at the gap."""
    omega, amplitude = np.array([drive.omega]), np.array([drive.amplitude])
    train = Trains(np.array([[phase]]), np.array([[impulse]]), omega, amplitude, periods)
    displacement, velocity = (each[0, 0] for each in states_before(system, train))
    loose = np.where(system.omega == 0, system.contact, 0.0)  # modes without stiffness put the contact there
    if loose.any():
        displacement = displacement + loose * (system.gap - system.contact @ displacement) / (loose @ loose)
    return State(displacement, velocity + impulse * system.contact)


def carried(system: ImpactSystem, drive: Drive, start: State, begin: float, times: Array) -> tuple[Array, Array]:
    """Modal displacements and velocities (times, n) of a free flight that starts at time ``begin``, s."""
    h, rest = phasors(system, drive), offsets(system)
    then, now = h * np.exp(1j * drive.omega * begin), h * np.exp(1j * drive.omega * times)[:, None]
    x = start.displacement - then.imag - rest
    y = start.velocity - drive.omega * then.real
    after = times - begin
    p = propagators(system.omega, system.zeta, after)
    push = np.where(system.omega == 0, system.static, 0.0)
    displacement = now.imag + rest + p.p00 * x + p.p01 * y + push * after[:, None] ** 2 / 2
    velocity = drive.omega * now.real + p.p10 * x + p.p11 * y + push * after[:, None]
    return displacement, velocity
