"""Bounds of the time that accumulations of impacts under a record still take, as ``proof.chatter_tail`` has them.

In a piece u is a cubic, so that η''' moves under the constant l u'''. One that may reach the end of its piece has no
bound, nor has one while other contacts are held or pushed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts.layout import HELD_AT, PIECE_AT, PUSHED_AT
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.proof.chatter_tail import SLACK, TailStart, bounds_of
from vibeam.flight.proof.errors import endless
from vibeam.flight.readout import sides
from vibeam.flight.record.course import RecordCourse
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw


def tails_under(system: ImpactSystem, course: RecordCourse, trace: Array, poses: Array) -> Array:
    """(k, 3): segment that ends with an accumulation, least and most time that it still takes; NaN: no bound."""
    which, contacts = np.flatnonzero(trace[:, layout.END] == layout.CHATTER), Contacts.of(system)
    found = np.stack([which, np.zeros(len(which)), np.full(len(which), np.nan)], axis=1)
    unending = endless(trace)[which]
    found[unending, 1:] = np.inf
    after, struck = trace[np.minimum(which + 1, len(trace) - 1)], sides(trace)[which]
    alone = ~unending & (which + 1 < len(trace)) & (after[:, PUSHED_AT] == 0)
    for j, stop in enumerate(zip(contacts.laws, contacts.rows, strict=True)):
        mine = alone & (struck == j) & (after[:, HELD_AT] == 1 << j)
        if np.any(mine):
            found[mine, 1:] = _bounds(system, stop, course, (trace, poses), which[mine])
    return found


def _bounds(
    system: ImpactSystem, stop: tuple[StopLaw, Array], course: RecordCourse, motion: tuple[Array, Array], which: Index
) -> Array:
    (trace, poses), (law, row) = motion, stop
    after = trace[which + 1]
    piece, clock = after[:, PIECE_AT].astype(np.int64), after[:, layout.AT_CLOCK]
    c, s = course.pieces[piece].T[:, :, None], clock[:, None]
    u = [c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2 * c[2] + 3 * s * c[3]), 2 * c[2] + 6 * s * c[3]]
    speed = law.rebound(trace[which, layout.BEFORE])
    place, rate, damper = poses[which + 1, 0], poses[which + 1, 1].copy(), damper_of(system)
    rate -= speed[:, None] * row / float(row @ row)
    second = system.load * u[0] + system.static - rate @ damper - system.omega**2 * place
    third = system.load * u[1] - second @ damper - system.omega**2 * rate
    fourth = system.load * u[2] - third @ damper - system.omega**2 * second
    pull, jerk = second @ row, np.abs(third @ row)
    norm = np.sqrt(np.sum((system.omega * third) ** 2 + fourth**2, axis=1))
    parts = (np.abs(rate) + system.omega * np.abs(place)) @ np.abs(row)
    pushed = np.abs(system.static) + np.abs(system.load * u[0]) + np.abs(rate) @ np.abs(damper).T
    pulls = (system.omega**2 * np.abs(place) + pushed) @ np.abs(row)
    with np.errstate(divide="ignore", invalid="ignore"):
        doubt = 2 * SLACK * (parts / speed + pulls / np.abs(pull))
    push = float(np.linalg.norm(system.load)) * np.abs(6 * c[3, :, 0])
    least, most = bounds_of(system, stop, TailStart(speed, pull, jerk, norm, doubt), push)
    inside = clock + most <= course.lengths[piece]
    return np.stack([np.where(inside, least, 0.0), np.where(inside, most, np.nan)], axis=1)
