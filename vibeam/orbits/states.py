"""Modal state of a periodic motion at any time, in closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.propagator import pair, propagators
from vibeam.orbits.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

Array = NDArray[np.float64]

Complex = NDArray[np.complex128]


def phasors(system: ImpactSystem, drive: Drive) -> Complex:
    """Phasors h (n,): the steady response to the drive alone is Im(h e^{iΩt}) plus the static displacements."""
    unit = [
        load * phasor(natural, zeta * natural, np.array([drive.omega]))[0] if load else 0j
        for natural, zeta, load in zip(system.omega, system.zeta, system.load, strict=True)
    ]
    return np.asarray(drive.amplitude * np.array(unit, dtype=complex))


def state_after(system: ImpactSystem, drive: Drive, periods: int, phase: float, impulse: float) -> State:
    """State just after impact: the drive's response and the impulse train's; the contact lies at the gap."""
    span = np.array([2 * np.pi * periods / drive.omega])
    shapes = [
        green(natural, zeta * natural, pair(natural, zeta, span)) if contact else (np.zeros(1), np.zeros(1))
        for natural, zeta, contact in zip(system.omega, system.zeta, system.contact, strict=True)
    ]
    g = np.array(shapes)[:, :, 0]
    turned = phasors(system, drive) * np.exp(1j * phase)
    displacement = turned.imag + offsets(system) + impulse * system.contact * g[:, 0]
    velocity = drive.omega * turned.real + impulse * system.contact * g[:, 1]
    return State(displacement + _rigid_displacement(system, displacement), velocity)


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
