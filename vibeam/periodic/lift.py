"""Lift of a periodic motion to another model: its contact forces as the load on the other model's modes.

Under loads that repeat after nT, impulses p_j at times t_j and forces F(τ) of contacts that last, the modes answer by
superposition of periodic Green's functions: with A the state matrix of (η, η'), b = (0, c) and 0 ≤ s < nT,

    x(t) = Im(X e^{iΩt}) + x₀ + Σ_j p_j G(t − t_j) b + ∫ F(τ) G(t − τ) b dτ,    G(s) = e^{As} (1 − e^{AnT})⁻¹,

mode by mode where damping does not couple them. Impulses enter exactly, forces at the points of Gauss' quadrature. The
state is where Newton's method starts in the other model; between models of the same modes it is the motion itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.flight.disturbance.derivatives import derivative_along
from vibeam.flight.disturbance.tangent import state_matrix
from vibeam.flight.equilibrium import Contacts, without_stop
from vibeam.flight.kernels import layout
from vibeam.flight.linear.propagator import pairs, propagators
from vibeam.flight.trajectory import Trajectory
from vibeam.periodic.between_impacts import phasors
from vibeam.periodic.modal_sums import green
from vibeam.periodic.orbit import Orbit
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.rows import TimeDerivative
from vibeam.system.state import State
from vibeam_models.arrays import Array, Index

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
TURN = 4.0  # radians of the fastest mode to a panel of Gauss' quadrature
MOST_PANELS = 256  # a segment
INTEGRATED = 4, 8  # panels, least and most, of a contact whose every pose is integrated from its start
GONE = 300.0  # nepers a span, from which on nothing is left of a mode in the middle of a flight


class Load(NamedTuple):
    """Impulses (m,) on contacts at times, s, negative: away from the stop; forces as many small ones."""

    times: Array
    impulses: Array
    contacts: Index


NOTHING = Load(np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64))


def lifted(orbit: Orbit, other: ImpactSystem) -> tuple[float, State]:
    """Time, s, in the middle of the orbit's longest flight, and the state of ``other`` there under its contact forces.

    ``other`` at the orbit's drive. ValueError where it lacks a contact that the orbit strikes, and where an undamped
    mode of it is at resonance.
    """
    if (there := len(Contacts.of(other).rows)) <= orbit.contacts.max(initial=-1):
        raise ValueError(f"lift: the orbit strikes contact {orbit.contacts.max() + 1}, and the other model has {there}")
    left = (other.zeta * other.omega * orbit.span < GONE) | bool(np.any(other.omega == 0))
    load = contact_load(orbit, float(np.max(other.omega[left], initial=0.0)))
    closed = bool(len(orbit.times)) and orbit.times[0] <= orbit.time
    time = orbit.time + (orbit.span / 2 if closed else 0.0)
    found = _response(other, orbit.drive, orbit.span, load, time)
    if not np.isfinite(found).all():
        raise ValueError("lift: an undamped mode of the other model is at a resonance of the drive")
    loose = np.where(other.omega == 0, other.contact, 0.0)
    if loose.any() and len(orbit.times):  # without stiffness the first contact says where it is
        at = _response(other, orbit.drive, orbit.span, load, float(orbit.times[0]))[0]
        found[0] += loose * (other.gap - other.contact @ at) / (loose @ loose)
    return time, State(found[0], found[1])


def response_alone(system: ImpactSystem, drive: Drive, time: float) -> State:
    """The steady response to the drive alone at ``time``, s, whether it meets a stop or not; NaN without one."""
    return State.reached(*_response(system, drive, 2 * np.pi / drive.omega, NOTHING, time))


def _response(system: ImpactSystem, drive: Drive, span: float, load: Load, time: float) -> Array:
    """Displacements and velocities (2, n) of the modes at a ``time``, s, just before an impulse there."""
    after, pushed = np.mod(time - load.times, span), load.impulses[:, None] * Contacts.of(system).rows[load.contacts]
    after[after == 0] = span
    respond = _by_modes if system.coupling is None else _by_eigenvectors
    with np.errstate(divide="ignore", invalid="ignore"):  # at a resonance of an undamped mode: not finite
        return respond(system, drive, span, after, pushed, time)


def _by_modes(system: ImpactSystem, drive: Drive, span: float, after: Array, pushed: Array, time: float) -> Array:
    once = pairs(system.omega, system.zeta, np.array([span]))
    g0, g1 = (np.where(pushed.any(axis=0), part[:, 0], 0.0) for part in green(system.omega[:, None], once))
    p = propagators(system.omega, system.zeta, after)
    value, slope = p.p00 * g0 + p.p01 * g1, p.p10 * g0 + p.p11 * g1
    loose = system.omega == 0  # whose static force balances the impulses' mean
    value -= loose * after[:, None] ** 2 / (2 * span)
    slope -= loose * after[:, None] / span
    turned = phasors(system, drive) * np.exp(1j * drive.omega * time)
    displacement = turned.imag + without_stop(system) + np.sum(value * pushed, axis=0)
    return np.array([displacement, drive.omega * turned.real + np.sum(slope * pushed, axis=0)])


def _by_eigenvectors(
    system: ImpactSystem, drive: Drive, span: float, after: Array, pushed: Array, time: float
) -> Array:
    n, matrix = system.size, state_matrix(system)
    values, vectors = np.linalg.eig(matrix)
    struck = np.linalg.solve(vectors, np.concatenate([np.zeros_like(pushed), pushed], axis=1).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.exp(values[:, None] * after) / -np.expm1(values[:, None] * span)
    swung = (vectors @ np.sum(share * struck, axis=1)).real
    load = np.concatenate([np.zeros(n), system.load * drive.omega**2 * drive.amplitude])
    driven = np.linalg.solve(1j * drive.omega * np.eye(2 * n) - matrix, load) * np.exp(1j * drive.omega * time)
    found = (swung + driven.imag).reshape(2, n)
    found[0] += without_stop(system)
    return np.asarray(found)


def contact_load(orbit: Orbit, fastest: float = 0.0) -> Load:
    """Contact forces over one span of the orbit; lasting ones sampled for modes up to ``fastest`` rad/s."""
    system = orbit.system
    contacts = Contacts.of(system)
    parts = [NOTHING]
    for j, law in enumerate(contacts.laws):
        struck = orbit.contacts == j
        if not law.yields and struck.any():
            impulses = -(orbit.velocities[struck] + law.rebound(orbit.velocities[struck])) / float(
                contacts.rows[j] @ contacts.rows[j]
            )
            parts.append(Load(orbit.times[struck], impulses, orbit.contacts[struck]))
    if orbit.rests or any(law.yields for law in contacts.laws):
        parts += _lasting(orbit.path(), contacts, max(fastest, float(np.max(system.omega))))
    return Load(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def _lasting(path: Trajectory, contacts: Contacts, fastest: float) -> list[Load]:
    """Forces of the contacts that last, segment by segment."""
    trace, found = path.segments.trace, []
    integrated, own = any(law.integrated for law in contacts.laws), float(np.max(contacts.system.omega))
    for row in trace[(trace[:, layout.WHAT] != layout.FREE) & (trace[:, layout.DURATION] > 0)]:
        duration = float(row[layout.DURATION])
        panels = int(np.clip(np.ceil(fastest * duration / TURN), 2, MOST_PANELS))
        width = duration / panels
        times = row[layout.START] + _nodes(panels) * width
        if integrated:
            few = int(np.clip(np.ceil(own * duration / TURN), *INTEGRATED))
            forces = _forces(path, contacts, row[layout.START] + _nodes(few) * duration / few)
            forces = _interpolated(forces, few, panels)
        else:
            forces = _forces(path, contacts, times)
        weights = np.tile(WEIGHTS * width / 2, panels)
        found += [
            Load(times, -force * weights, np.full(len(times), k)) for k, force in enumerate(forces) if force.any()
        ]
    return found


def _nodes(panels: int) -> Array:
    """Gauss' points of panels of width 1, one after the other: (16 · panels,)."""
    return np.asarray((np.arange(panels)[:, None] + (NODES + 1) / 2).ravel())


def _interpolated(forces: Array, few: int, panels: int) -> Array:
    """Forces (k, 16 · few) at Gauss' points of a few panels, at those of others by each panel's polynomial."""
    at = _nodes(panels) / panels * few
    which = np.minimum(at.astype(int), few - 1)
    powers, known = ((np.polynomial.legendre.legvander(x, len(NODES) - 1)) for x in (2 * (at - which) - 1, NODES))
    parts = np.linalg.solve(known, forces.reshape(len(forces), few, -1)[..., None])[..., 0]
    return np.asarray(np.einsum("kpj,pj->kp", parts[:, which], powers))


def _forces(path: Trajectory, contacts: Contacts, times: Array) -> Array:
    """Forces (k, times) of all contacts: what the accelerations of the contacts lack of those without any."""
    system, drive, poses = contacts.system, path.drive, path.modes_at(times)
    push = drive.omega**2 * drive.amplitude * np.sin(drive.omega * times)
    free = push[:, None] * system.load + system.static - poses[:, 1] @ contacts.damper - contacts.spring * poses[:, 0]
    lacking = [
        free @ row - derivative_along(system, drive, path.segments.trace, times, poses, TimeDerivative(row, 2), 0)
        for row in contacts.rows
    ]
    return np.asarray(np.linalg.lstsq(contacts.rows @ contacts.rows.T, np.array(lacking), rcond=1e-12)[0])
