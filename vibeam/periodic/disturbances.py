"""Disturbances of many motions carried side by side, event by event: O(n) a flight and motion, no matrix formed.

Over a flight a disturbance (δη, δη') follows the modes' propagators, at an impact it is corrected by a map of rank two
(the saltation matrix), over a rest on the stop it follows the held system in its eigenvectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.disturbance.tangent import held_matrix
from vibeam.flight.kernels import layout
from vibeam.flight.linear.propagator import propagators
from vibeam.periodic.stroboscopic import Flown
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

SEEN = 4  # events after which a disturbance is measured


class Piece(NamedTuple):
    """A piece of a motion, linearised, n modes and m segments: propagators, how each ends, drive periods gone by."""

    flown: Array  # (4, m, n)
    share: Array  # (m,) (1 + R)/c·c at an impact, else 0
    lean: Array  # (m,) contact acceleration toward the stop over the speed of impact, 1/s
    held: NDArray[np.bool_]  # (m,) at rest on the stop
    stopped: NDArray[np.bool_]  # (m,) an accumulation of impacts ends in rest
    durations: Array  # (m,)
    times: Array  # (m,) at the end, in drive periods


def linearised(flown: Flown) -> Piece:
    """A motion's tangent maps, event by event."""
    system, drive, trace = flown.system, flown.drive, flown.segments.trace
    durations, speed, c = np.ascontiguousarray(trace[:, layout.DURATION]), trace[:, layout.BEFORE], system.contact
    mobility, damping = float(c @ c), 2 * system.zeta * system.omega
    last = np.stack([flown.state.displacement, flown.state.velocity])
    ends = np.concatenate([flown.segments.poses[1:], last[None]])
    hit = (trace[:, layout.END] == layout.IMPACT) & (speed > 0)
    before = ends[:, 1] + np.outer((speed - ends[:, 1] @ c) / mobility, c)
    phase = drive.omega * (trace[:, layout.AT_CLOCK] + durations)
    push = np.outer(drive.omega**2 * drive.amplitude * np.sin(phase), system.load) + system.static
    toward = (push - damping * before - system.omega**2 * ends[:, 0]) @ c
    held = trace[:, layout.WHAT] == layout.RESTING
    return Piece(
        np.stack(propagators(system, np.where(held, 0.0, durations))[:4]),
        np.where(hit, (1 + system.restitution) / mobility, 0.0),
        np.where(hit, toward / np.where(hit, speed, 1.0), 0.0),
        held,
        np.isin(trace[:, layout.END], (layout.CHATTER, layout.STUCK)),
        durations,
        np.cumsum(durations) * drive.omega / (2 * np.pi),
    )


def carried(systems: Sequence[ImpactSystem], pieces: Sequence[Piece], start: Array) -> tuple[list[Array], Array]:
    """Carry disturbances ``start`` = (δη, δη') (2, motions, n) over a piece of each motion, all of them event by event.

    Returned are, of each motion, drive periods gone by and the logarithm of what its disturbance has grown by (2, k),
    −∞ once it is lost, and all disturbances at the end, of unit size again (η in units of velocity). At an impact, with
    c the contact and d the modes' damping, s = ``share`` and a/v = ``lean``,

        δη  loses s c (c·δη),    δη' loses s c (c·δη') and gains s (d + a/v) c (c·δη).
    """
    c = np.array([system.contact for system in systems])
    damped = c * np.array([2 * system.zeta * system.omega for system in systems])
    units = np.stack([[units_of(system) for system in systems], np.ones(c.shape)])
    every, rests = _side_by_side(pieces), _Rests(systems)
    last = len(every.share) - 1
    special = np.any(every.held | every.stopped, axis=1)
    z, log, seen, logs = start, np.zeros(len(pieces)), list[int](), list[Array]()
    for event, (to_x, to_y) in enumerate(every.flown):
        z = to_x * z[0] + to_y * z[1]
        for point in np.flatnonzero(every.held[event]).tolist() if special[event] else ():
            z[:, point] = rests.over(point, float(pieces[point].durations[event]), z[:, point])
        lost = every.share[event] * np.add.reduce(c * z, axis=2)
        lost[1] -= every.lean[event] * lost[0]
        z -= lost[:, :, None] * c
        z[1] += lost[0][:, None] * damped
        for point in np.flatnonzero(every.stopped[event]).tolist() if special[event] else ():
            z[:, point] = rests.stopped(point, z[:, point])
        if event % SEEN == SEEN - 1 or event == last:
            size = np.sqrt(np.add.reduce((units * z) ** 2, axis=(0, 2)))
            with np.errstate(divide="ignore"):
                log = log + np.log(size)
            z = z / np.where(size > 0, size, 1.0)[:, None]
            seen.append(event)
            logs.append(log)
    return [_read(piece, np.array(seen), values) for piece, values in zip(pieces, np.array(logs).T, strict=True)], z


def _read(piece: Piece, seen: NDArray[np.int64], logs: Array) -> Array:
    """Times and logarithms at the events ``seen``, up to the piece's last."""
    count = int(np.searchsorted(seen, len(piece.times) - 1)) + 1
    return np.stack([piece.times[np.minimum(seen[:count], len(piece.times) - 1)], logs[:count]])


def units_of(system: ImpactSystem) -> Array:
    """Frequencies (n,) by which displacements count as velocities, 1/s; 1 of a mode without stiffness."""
    return np.where(system.omega > 0, system.omega, 1.0)


class _Events(NamedTuple):
    """Motions side by side, padded with events that change nothing."""

    flown: Array  # (events, 2, 2, motions, n): what δη and what δη' makes of both
    share: Array  # (events, motions)
    lean: Array
    held: NDArray[np.bool_]
    stopped: NDArray[np.bool_]


def _side_by_side(made: Sequence[Piece]) -> _Events:
    events, n = max(len(motion.times) for motion in made), made[0].flown.shape[2]
    flown, flat = np.zeros((events, 2, 2, len(made), n)), np.zeros((4, events, len(made)))
    flown[:, (0, 1), (0, 1)] = 1.0
    for place, motion in enumerate(made):
        count = len(motion.times)
        flown[:count, :, :, place] = motion.flown[[0, 2, 1, 3]].reshape(2, 2, count, n).transpose(2, 0, 1, 3)
        flat[:, :count, place] = motion[1:5]
    return _Events(flown, flat[0], flat[1], flat[2] > 0, flat[3] > 0)


class _Rests:
    """The held systems in their eigenvectors, made when first asked for."""

    def __init__(self, systems: Sequence[ImpactSystem]) -> None:
        self.systems = systems
        self.known: dict[int, tuple[NDArray[np.complex128], ...]] = {}

    def stopped(self, point: int, rows: Array) -> Array:
        """Rows (2, n) on the modes without their part along the contact."""
        c = self.systems[point].contact
        return np.asarray(rows - np.outer(rows @ c, c) / float(c @ c))

    def over(self, point: int, duration: float, rows: Array) -> Array:
        """The disturbance after a rest."""
        if point not in self.known:
            system = self.systems[point]
            across = np.kron(np.eye(2), np.linalg.svd(system.contact[None, :])[2][1:].T)
            values, vectors = np.linalg.eig(across.T @ held_matrix(system) @ across)
            self.known[point] = values, across @ vectors, np.linalg.inv(vectors) @ across.T
        values, vectors, inverse = self.known[point]
        after = (vectors @ (np.exp(values * duration) * (inverse @ rows.ravel()))).real
        return np.asarray(after).reshape(2, -1)
