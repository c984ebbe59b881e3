"""The certificate of a motion with several contacts: the signals watched in each set, each with its pieces.

With k contacts signal j is the gap of contact j, k + j its force; 2k + j and 3k + j are their negatives, watched while
a stop with damping is penetrated and does not push. Accumulations completed by their limit are not proved here: what
they still take has no bound where other contacts move.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.event_driven import EventDrivenSolver, Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.proof.certificate import Certificate, UnprovedSpan, pieces_of
from vibeam.flight.proof.watched import WatchedMotion
from vibeam.flight.readout import sides
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array, Flags, Index


@dataclass(frozen=True, eq=False, repr=False)
class ContactsCertificate(Certificate):
    """As ``Certificate``, for k contacts; ``roots`` holds the first of ``starts`` in each segment."""

    held: Index  #: (segments,) contacts held, Σ 2^contact
    pushed: Index  #: (segments,) contacts that a yielding stop pushes, likewise
    starts_at_zero: Array  #: (m, 4): segment, signal, order and size of the root with which it starts

    def _integrated(self) -> list[UnprovedSpan]:
        contacts = Contacts.of(self.system)
        which = np.flatnonzero(integrated(contacts, self.pushed) & (self.durations > 0))
        names = " or ".join(sorted({f'"{law.name}"' for law in contacts.laws if law.integrated}))
        return self._spans_of(which, f"the law {names}")


def integrated(contacts: Contacts, pushed: Index) -> Flags:
    """True for the segments in which a contact that pushes is integrated."""
    found = np.zeros(len(pushed), dtype=bool)
    for j, law in enumerate(contacts.laws):
        if law.integrated:
            found |= pushed >> j & 1 > 0
    return found


def certificate_of_contacts(solver: EventDrivenSolver, drive: Drive, segments: Segments) -> ContactsCertificate:
    """The certificate of a motion that was flown."""
    trace, contacts = segments.trace, Contacts.of(solver.system)
    motion = WatchedMotion(solver.system, drive, trace, segments.poses, trace[:, layout.WHAT], sides(trace))
    pushed = trace[:, row.PUSHED_AT].astype(np.int64)
    tasks = _tasks(trace, len(contacts.gaps), (trace[:, layout.DURATION] > 0) & ~integrated(contacts, pushed))
    starting = tasks[tasks[:, layout.TASK_ORDER] > 0]
    starts = starting[:, [layout.TASK_SEGMENT, layout.TASK_SIGNAL, layout.TASK_ORDER, layout.TASK_RISE]]
    completed = np.flatnonzero(trace[:, layout.END] == layout.CHATTER)
    tails = np.stack([completed, np.zeros(len(completed)), np.full(len(completed), np.nan)], axis=1)
    return certificate_in_sets(
        solver.system, drive, segments, pieces_of(solver, motion, tasks, segments.size), tails, starts
    )


def certificate_in_sets(
    system: ImpactSystem, drive: Any, segments: Segments, pieces: Array, tails: Array, starts: Array
) -> ContactsCertificate:
    """The certificate of a motion in sets of contacts, ``starts`` as ``starts_at_zero``; under a record too."""
    trace = segments.trace
    held, pushed = (trace[:, column].astype(np.int64) for column in (row.HELD_AT, row.PUSHED_AT))
    orders, roots = np.zeros(len(trace)), np.full(len(trace), -1.0)
    first = starts[np.unique(starts[:, 0], return_index=True)[1]]
    which = first[:, 0].astype(np.int64)
    roots[which], orders[which] = first[:, 1], first[:, 2]
    return ContactsCertificate(
        system, drive, trace[:, layout.START], trace[:, layout.WHAT], sides(trace), trace[:, layout.END],
        segments.poses, trace[:, layout.AT_CLOCK], trace[:, layout.DURATION], orders, roots, pieces, tails, held,
        pushed, starts,
    )  # fmt: skip


def _tasks(trace: Array, contacts: int, lasting: Flags) -> Array:
    """The signals watched (m, TASK_COLUMNS), segment by segment."""
    found = [np.empty((0, layout.TASK_COLUMNS))]
    each = trace[:, row.EACH_AT :].reshape(len(trace), row.TRACED, contacts)
    for j in range(contacts):
        condition, order, rise = each[:, row.CONDITION, j], each[:, row.ORDER, j], each[:, row.RISE, j]
        yields = np.isin(condition, (row.PUSHING, row.INSIDE))
        signals = {0: condition == row.AWAY, 1: np.isin(condition, (row.KEPT, row.PUSHING))}
        signals |= {2: condition == row.INSIDE, 3: condition == row.INSIDE}
        for kind, watched in signals.items():
            which = np.flatnonzero(watched & lasting)
            begins = np.where(yields, regime_layout.UNKNOWN, np.maximum(order, 0.0))[which]
            signal = float(kind * contacts + j)
            closing = trace[which, row.MET_AT] == signal
            found.append(np.stack([which, np.full(len(which), signal), begins, rise[which], closing], axis=1))
    tasks = np.concatenate(found)
    return np.ascontiguousarray(tasks[np.argsort(tasks[:, layout.TASK_SEGMENT], kind="stable")])
