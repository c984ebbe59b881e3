"""What round-off may cost in a motion: how much each impact's time and velocity answer to a change of the state before.

From first principles, in doubles: the flow of each mode, and at an impact the saltation matrix
    S = D + (f⁺ − D f⁻) ∂t,    D = 1 − (1+R) c cᵀ/S on velocities,    ∂t = c/v⁻ on displacements
(di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, §2.5). Rows ∂(time, velocity)/∂state are pulled back
from each impact to all states before; each state may be wrong by some of its size's last digits.

A motion that begins at rest on the stop is held first: x″ = P(f − 2ζωx′ − ω²x), P = 1 − c cᵀ/S, a flow in which the
modes are coupled. Its release adds nothing of its own: the force that holds is zero there, so f⁺ = f⁻ and the
saltation matrix is 1, however wrong the instant. But the state at the rest's begin is carried through all of the rest,
which may last longer than the flights after it, and is rounded at its end in modes that have turned that long.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

import vibeam

Array = np.ndarray
EPSILON = float(np.finfo(float).eps)
NEAR_RESONANCE = 1e-3  # share of Ω² by which a mode must be off for its steady response to be what is rounded


class Knot(NamedTuple):
    """An impact of the true motion: when, contact velocity before, modal state after."""

    time: float
    speed: float
    displacement: Array
    velocity: Array


class Rest(NamedTuple):
    """The begin of a rest on the stop with which the motion begins: when, and the modal state there."""

    time: float
    displacement: Array
    velocity: Array


class Blur(NamedTuple):
    """Per impact: error of time and of velocity (m,) if every state is wrong by its last digit."""

    time: Array
    speed: Array


def flow(omega: Array, zeta: Array, span: float) -> Array:
    """(n, 2, 2): homogeneous motion of each mode over ``span``: new (x, v) from old."""
    root = omega * np.sqrt(zeta**2 - 1 + 0j)
    decay = -zeta * omega
    fast, slow = np.exp((decay + root) * span), np.exp((decay - root) * span)
    near = np.abs(root * span) < 1e-5
    safe = np.where(near, 1.0, root)
    impulse = np.where(near, span * np.exp(decay * span), (fast - slow) / (2 * safe)).real
    even = ((fast + slow) / 2).real
    rows = [even - decay * impulse, impulse, -(omega**2) * impulse, even + decay * impulse]
    return np.stack(rows, axis=-1).reshape(-1, 2, 2)


def drift(system: vibeam.ImpactSystem, drive: vibeam.Drive, t: float, x: Array, v: Array) -> Array:
    """Modal accelerations in flight."""
    push = system.load * drive.omega**2 * drive.amplitude * np.sin(drive.omega * t)
    return push + system.static - 2 * system.zeta * system.omega * v - system.omega**2 * x


def sizes(system: vibeam.ImpactSystem, drive: vibeam.Drive, x: Array, v: Array, span: float) -> Array:
    """(n, 2): magnitudes of which displacement and velocity of each mode are rounded in a flight of that span."""
    w, force = system.omega, np.abs(system.load) * drive.omega**2 * abs(drive.amplitude)
    off = np.abs(w**2 - drive.omega**2 + 2j * system.zeta * w * drive.omega)
    steady = force / np.maximum(off, NEAR_RESONANCE * drive.omega**2 + 1e-300)
    stiff = np.maximum(w, 1e-150)
    lasting = np.abs(system.static) * np.minimum(span, 1 / stiff) ** 2
    reach = np.abs(x) + np.abs(v) * np.minimum(span, 1 / stiff) + steady + lasting
    turned = 1 + (w + drive.omega) * span
    return np.stack([reach * turned, (np.abs(v) + (w + drive.omega) * reach) * turned], axis=-1)


def saltation(system: vibeam.ImpactSystem, drive: vibeam.Drive, knot: Knot) -> Array:
    """(2n, 2n): a change of the state just before the impact to that just after, at the same time."""
    n, c, speed = system.size, system.contact, knot.speed
    jump = np.eye(n) - (1 + system.restitution) * np.outer(c, c) / (c @ c)
    before = knot.velocity + c * (1 + system.restitution) * speed / (c @ c)
    x, t = knot.displacement, knot.time
    late = drift(system, drive, t, x, knot.velocity) - jump @ drift(system, drive, t, x, before)
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, :n], matrix[n:, n:] = np.eye(n), jump
    matrix[:n, :n] += np.outer(knot.velocity - before, c) / speed
    matrix[n:, :n] += np.outer(late, c) / speed
    return matrix


def held_flow(system: vibeam.ImpactSystem, span: float) -> Array:
    """(2n, 2n): what ``span`` of rest makes of a change of the state, as far as the stop lets the change through.

    The exponential is taken of (s x, x′) with s = max(ω, 1/span): in those its matrix is no larger than it must be.
    """
    n, c, w = system.size, system.contact, system.omega
    along = np.eye(n) - np.outer(c, c) / (c @ c)
    scale = np.maximum(w, 1 / span)
    rates = np.block([
        [np.zeros((n, n)), np.diag(scale)], [-along * (w**2 / scale), -along * (2 * system.zeta * w)],
    ])  # fmt: skip
    both = np.concatenate([scale, np.ones(n)])
    let_through = np.kron(np.eye(2), along)
    return np.asarray((expm(rates * span) * both / both[:, None]) @ let_through)


def blur(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, t_start: float, x: Array, v: Array, knots: list[Knot],
    rest: Rest | None = None,
) -> Blur:  # fmt: skip
    """What one last digit in every state from the start on makes of the impacts' times and velocities.

    ``rest``: where the motion was held until ``t_start``, when it was released with ``x`` and ``v``.
    """
    n, c = system.size, system.contact
    rows = np.zeros((0, 2 * n))
    total = np.zeros((2, len(knots)))
    starts = [Knot(t_start, 0.0, x, v), *knots[:-1]]
    for k in range(len(knots) - 1, -1, -1):
        knot, start = knots[k], starts[k]
        if k < len(knots) - 1:
            rows = rows @ saltation(system, drive, knot)
        before = knot.velocity + c * (1 + system.restitution) * knot.speed / (c @ c)
        pull = c @ drift(system, drive, knot.time, knot.displacement, before)
        when = np.concatenate([-c / knot.speed, np.zeros(n)])
        how_fast = np.concatenate([np.zeros(n), c]) + pull * when
        rows = np.vstack([when, how_fast, rows])
        moved = np.einsum(
            "rai,iab->rbi", rows.reshape(-1, 2, n), flow(system.omega, system.zeta, knot.time - start.time)
        )
        size = sizes(system, drive, start.displacement, start.velocity, knot.time - start.time)
        size_end = sizes(system, drive, knot.displacement, before, 0.0)
        share = np.einsum("rbi,ib->r", np.abs(moved), size) + np.einsum(
            "rbi,ib->r", np.abs(rows.reshape(-1, 2, n)), size_end
        )
        total[:, k:] += EPSILON * share.reshape(-1, 2).T
        rows = moved.reshape(-1, 2 * n)
    if rest is not None and t_start > rest.time:
        span = t_start - rest.time
        for each, size in (
            (rows @ held_flow(system, span), sizes(system, drive, rest.displacement, rest.velocity, span)),
            (rows, sizes(system, drive, x, v, span)),
        ):
            share = np.einsum("rbi,ib->r", np.abs(each.reshape(-1, 2, n)), size)
            total += EPSILON * share.reshape(-1, 2).T
    times = np.array([knot.time for knot in knots])
    return Blur(total[0] + EPSILON * times, total[1])
