"""Impact trains: m impacts in n drive periods; given their times, the motion is linear in the impulses.

With the periodic Green's function G(τ) = Σ c_i² g_i(τ) of ``modal_sums``, contact and restitution at impact j are

    Im(H e^{iΩt_j}) + Σ_k p_k G(t_j − t_k) = Δ
    Ω Re(H e^{iΩt_j}) + Σ_k p_k G'(t_j − t_k − 0) + p_j S/(1 + R) = 0

2m smooth equations in the times and impulses, solved by Newton's method with their exact derivatives. The modal state
between impacts follows in closed form.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from vibeam.flight.linear.propagator import pairs, propagators
from vibeam.periodic.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex

KEPT = 8  # responses to a drive: one motion asks for the same one several times


def phasors(system: ImpactSystem, drive: Drive) -> Complex:
    """Phasors h (n,): the steady response to the drive alone is Im(h e^{iΩt}) plus the static displacements."""
    return _phasors(system.omega.tobytes(), system.zeta.tobytes(), system.load.tobytes(), drive)


@lru_cache(maxsize=KEPT)
def _phasors(*given: Any) -> Complex:
    omega, zeta, load = (np.frombuffer(row) for row in given[:3])
    drive, driven, found = given[3], load != 0, np.zeros(len(load), dtype=complex)
    share = load[driven] * phasor(omega[driven], zeta[driven] * omega[driven], drive.omega)
    found[driven] = drive.amplitude * share
    found.setflags(write=False)
    return found


def state_after(system: ImpactSystem, drive: Drive, periods: int, phase: float, impulse: float) -> State:
    """State just after impact: the drive's response and the impulse train's; the contact lies at the gap."""
    g0, g1 = _green(system, np.array([2 * np.pi * periods / drive.omega]))
    turned = phasors(system, drive) * np.exp(1j * phase)
    displacement = turned.imag + offsets(system) + impulse * system.contact * g0
    velocity = drive.omega * turned.real + impulse * system.contact * g1
    return State(displacement + _rigid_displacement(system, displacement), velocity)


def _green(system: ImpactSystem, span: Array) -> tuple[Array, Array]:
    """Periodic Green's functions g(0), g'(0⁺) (n,) over a ``span`` (1,) s, 0 for modes not seen by the contact."""
    natural = system.omega[:, None]
    g0, g1 = green(natural, pairs(system.omega, system.zeta, span))
    struck = system.contact != 0
    return np.where(struck, g0[:, 0], 0.0), np.where(struck, g1[:, 0], 0.0)


def _rigid_displacement(system: ImpactSystem, displacement: Array) -> Array:
    """Displacement of the modes without stiffness that puts the contact at the gap."""
    loose = np.where(system.omega == 0, system.contact, 0.0)
    if not loose.any():
        return np.zeros(system.size)
    return np.asarray(loose * (system.gap - system.contact @ displacement) / (loose @ loose))


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


STEPS = 40
LONGEST = 0.2  # largest Newton step, as a share of the span and of the impulses
SMALL, STALLED = 1e-13, 1e-9  # the same at which the iteration ends, also where round-off stops its progress


class Train(NamedTuple):
    """Impact train: times, s, and impulses (m,) in the order of time."""

    times: Array
    impulses: Array


class Lags(NamedTuple):
    """Green's functions g_i, g_i' (m, m, n) at lags t_j − t_k within a span; a zero lag is just before the impact."""

    value: Array
    slope: Array


def lags(system: ImpactSystem, span: float, times: Array) -> Lags:
    """Green's functions between all impacts."""
    start = _green(system, np.array([span]))
    between = np.mod(times[:, None] - times[None, :], span)
    np.fill_diagonal(between, 0.0)
    p = propagators(system.omega, system.zeta, between.ravel())
    value, slope = p.p00 * start[0] + p.p01 * start[1], p.p10 * start[0] + p.p11 * start[1]
    m = len(times)
    value, slope = value.reshape(m, m, -1), slope.reshape(m, m, -1)
    slope[np.arange(m), np.arange(m)] -= 1.0
    return Lags(value, slope)


def newton(system: ImpactSystem, drive: Drive, periods: int, start: Train) -> Train | None:
    """Solve all equations to round-off from ``start`` by Newton's method; None where it does not converge."""
    span, m = 2 * np.pi * periods / drive.omega, len(start.times)
    unknown = np.concatenate([start.times, start.impulses])
    scale = np.concatenate([np.full(m, span), np.full(m, np.abs(start.impulses).max())])
    last = np.inf
    for _ in range(STEPS):
        residual, slopes = equations(system, drive, span, Train(unknown[:m], unknown[m:]))
        if not (np.all(np.isfinite(residual)) and np.all(np.isfinite(slopes))):
            return None
        step = np.linalg.lstsq(slopes * scale, residual, rcond=None)[0]
        size = float(np.abs(step).max())
        unknown = unknown - step * scale * min(1.0, LONGEST / max(size, LONGEST))
        if size < SMALL or (size < STALLED and size > last / 2):
            return _ordered(Train(unknown[:m], unknown[m:]), span)
        last = size
    return None


def equations(system: ImpactSystem, drive: Drive, span: float, train: Train) -> tuple[Array, Array]:
    """Residuals (2m,), m and m/s, and their derivatives (2m, 2m) by times and impulses."""
    times, p = train
    mobility, square = system.mobility, system.contact**2
    turned = (system.contact @ phasors(system, drive)) * np.exp(1j * drive.omega * times)
    lag = lags(system, span, times)
    g, v = lag.value @ square, lag.slope @ square
    a = (-2 * system.zeta * system.omega * lag.slope - system.omega**2 * lag.value) @ square
    natural = np.eye(len(p), dtype=bool)
    loss = np.diag(np.full(len(p), mobility / (1 + system.restitution)))
    height = turned.imag + float(system.contact @ offsets(system)) + g @ p - system.gap
    speed = drive.omega * turned.real + (v + loss) @ p
    v0, a0 = np.where(natural, 0.0, v), np.where(natural, 0.0, a)
    by_time = np.diag(drive.omega * turned.real + v0 @ p) - v0 * p
    by_time_too = np.diag(-(drive.omega**2) * turned.imag + a0 @ p) - a0 * p
    return np.concatenate([height, speed]), np.block([[by_time, g], [by_time_too, v + loss]])


def _ordered(train: Train, span: float) -> Train | None:
    """Train with its first impact within the first span; None where an impact would pull or two have merged."""
    times = train.times - span * np.floor(train.times.min() / span)
    order = np.argsort(times)
    times, impulses = times[order], train.impulses[order]
    around = np.diff(np.append(times, times[0] + span))
    return Train(times, impulses) if np.all(impulses < 0) and np.all(around > 1e-9 * span) else None
