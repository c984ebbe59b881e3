"""The certificate of a motion under a record: the panels and quiet windows that it was flown by, each with its claim.

The verdicts of the flight are the proof, so they are kept as they are found: the signals are those of several contacts
(``proof.contacts``), also of a system with contact in one place. The time that accumulations of impacts still take is
bounded as in ``proof.chatter_tail``. In a piece u is a cubic, so that η''' moves under the constant l u'''. One that
may reach the end of its piece has no bound, nor has one while other contacts are held or pushed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.linear.regimes import damper_of
from vibeam.flight.proof.chatter_tail import SLACK, TailStart, bounds_of
from vibeam.flight.proof.contacts import ContactsCertificate
from vibeam.flight.proof.errors import endless
from vibeam.flight.readout import sides
from vibeam.flight.record.course import RecordCourse
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.record import Record
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam_models.laws.mechanics import StopLaw


def certificate_of_record(
    system: ImpactSystem, record: Record, course: RecordCourse, segments: Segments, intervals: Array
) -> ContactsCertificate:
    """The certificate of a motion that was flown with these ``intervals`` (m, PIECE_COLUMNS)."""
    trace, k = segments.trace, len(Contacts.of(system).gaps)
    held, pushed = (trace[:, column].astype(np.int64) for column in (row.HELD_AT, row.PUSHED_AT))
    starting = _starting(trace, k)
    orders, roots = np.zeros(len(trace)), np.full(len(trace), -1.0)
    first = starting[np.unique(starting[:, 0], return_index=True)[1]]
    orders[first[:, 0].astype(np.int64)], roots[first[:, 0].astype(np.int64)] = first[:, 2], first[:, 1]
    tails = _tails(system, course, trace, segments.poses)
    return ContactsCertificate(
        system, record, trace[:, layout.START], trace[:, layout.WHAT], sides(trace), trace[:, layout.END],  # type: ignore[arg-type]
        segments.poses, trace[:, layout.AT_CLOCK], trace[:, layout.DURATION], orders, roots, intervals, tails, held,
        pushed, starting,
    )  # fmt: skip


def _starting(trace: Array, contacts: int) -> Array:
    """Segment, signal, order and size (m, 4) of the roots with which gaps and reactions start."""
    each = trace[:, row.EACH_AT :].reshape(len(trace), row.TRACED, contacts)
    condition, order, rise = each[:, row.CONDITION], each[:, row.ORDER], each[:, row.RISE]
    which, j = np.nonzero((order > 0) & np.isin(condition, (row.AWAY, row.KEPT)))
    signal = j + np.where(condition[which, j] == row.KEPT, contacts, 0)
    return np.stack([which, signal, order[which, j], rise[which, j]], axis=1).astype(float)


def _tails(system: ImpactSystem, course: RecordCourse, trace: Array, poses: Array) -> Array:
    """(k, 3): segment that ends with an accumulation, least and most time that it still takes; NaN: no bound."""
    which, contacts = np.flatnonzero(trace[:, layout.END] == layout.CHATTER), Contacts.of(system)
    found = np.stack([which, np.zeros(len(which)), np.full(len(which), np.nan)], axis=1)
    unending = endless(trace)[which]
    found[unending, 1:] = np.inf
    after, struck = trace[np.minimum(which + 1, len(trace) - 1)], sides(trace)[which]
    alone = ~unending & (which + 1 < len(trace)) & (after[:, row.PUSHED_AT] == 0)
    for j, stop in enumerate(zip(contacts.laws, contacts.rows, strict=True)):
        mine = alone & (struck == j) & (after[:, row.HELD_AT] == 1 << j)
        if np.any(mine):
            found[mine, 1:] = _bounds(system, stop, course, (trace, poses), which[mine])
    return found


def _bounds(
    system: ImpactSystem, stop: tuple[StopLaw, Array], course: RecordCourse, motion: tuple[Array, Array], which: Index
) -> Array:
    (trace, poses), (law, struck) = motion, stop
    after = trace[which + 1]
    piece, clock = after[:, row.PIECE_AT].astype(np.int64), after[:, layout.AT_CLOCK]
    c, s = course.pieces[piece].T[:, :, None], clock[:, None]
    u = [c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2 * c[2] + 3 * s * c[3]), 2 * c[2] + 6 * s * c[3]]
    speed = law.rebound(trace[which, layout.BEFORE])
    place, rate, damper = poses[which + 1, 0], poses[which + 1, 1].copy(), damper_of(system)
    rate -= speed[:, None] * struck / float(struck @ struck)
    second = system.load * u[0] + system.static - rate @ damper - system.omega**2 * place
    third = system.load * u[1] - second @ damper - system.omega**2 * rate
    fourth = system.load * u[2] - third @ damper - system.omega**2 * second
    pull, jerk = second @ struck, np.abs(third @ struck)
    norm = np.sqrt(np.sum((system.omega * third) ** 2 + fourth**2, axis=1))
    parts = (np.abs(rate) + system.omega * np.abs(place)) @ np.abs(struck)
    pushed = np.abs(system.static) + np.abs(system.load * u[0]) + np.abs(rate) @ np.abs(damper).T
    pulls = (system.omega**2 * np.abs(place) + pushed) @ np.abs(struck)
    with np.errstate(divide="ignore", invalid="ignore"):
        doubt = 2 * SLACK * (parts / speed + pulls / np.abs(pull))
    push = float(np.linalg.norm(system.load)) * np.abs(6 * c[3, :, 0])
    least, most = bounds_of(system, stop, TailStart(speed, pull, jerk, norm, doubt), push)
    inside = clock + most <= course.lengths[piece]
    return np.stack([np.where(inside, least, 0.0), np.where(inside, most, np.nan)], axis=1)
