"""Motion of the modes of a plain system in closed form: response to the drive, just after an impact, free flight."""

from __future__ import annotations

import numpy as np

from vibeam.flight.linear.propagator import pairs, propagators
from vibeam.periodic.modal_sums import green, offsets, phasor
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex


def phasors(system: ImpactSystem, drive: Drive) -> Complex:
    """Steady response h (n,) of the modes to the drive alone: Im(h e^{iΩt}), static displacements aside."""
    found, driven = np.zeros(system.size, dtype=complex), system.load != 0
    natural, sigma = system.omega[driven], (system.zeta * system.omega)[driven]
    found[driven] = drive.amplitude * (system.load[driven] * phasor(natural, sigma, drive.omega))
    return found


def state_after(system: ImpactSystem, drive: Drive, periods: int, phase: float, impulse: float) -> State:
    """State just after the impact of a motion with one a span; the contact lies at the gap."""
    turned = phasors(system, drive) * np.exp(1j * phase)
    displacement, velocity = turned.imag + offsets(system), drive.omega * turned.real
    struck, span = np.flatnonzero(system.contact), np.array([2 * np.pi * periods / drive.omega])
    natural, contact = system.omega[struck], system.contact[struck]
    g0, g1 = green(natural[:, None], pairs(natural, system.zeta[struck], span))
    displacement[struck] += g0[:, 0] * impulse * contact
    velocity[struck] += (g1[:, 0] - 1) * impulse * contact  # just before the impact
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
