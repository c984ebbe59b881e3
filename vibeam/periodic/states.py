"""Modal state of a periodic motion at any time, in closed form."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

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
    g0, g1 = green(natural, system.zeta[:, None] * natural, pairs(system.omega, system.zeta, span))
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
    p = propagators(system, after)
    push = np.where(system.omega == 0, system.static, 0.0)
    displacement = now.imag + rest + p.p00 * x + p.p01 * y + push * after[:, None] ** 2 / 2
    velocity = drive.omega * now.real + p.p10 * x + p.p11 * y + push * after[:, None]
    return displacement, velocity
