"""The certificate of a motion under a record: the panels and quiet windows that it was flown by, each with its claim.

The verdicts of the flight are the proof, so they are kept as they are found: the signals are those of several contacts
(``proof.contacts``), also of a system with contact in one place.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.proof.contacts import ContactsCertificate, certificate_in_sets
from vibeam.flight.record.course import RecordCourse
from vibeam.flight.record.tails import tails_under
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.record import Record
from vibeam_models.arrays import Array


def certificate_of_record(
    system: ImpactSystem, record: Record, course: RecordCourse, segments: Segments, intervals: Array
) -> ContactsCertificate:
    """The certificate of a motion that was flown with these ``intervals`` (m, PIECE_COLUMNS)."""
    trace, contacts = segments.trace, len(Contacts.of(system).gaps)
    tails = tails_under(system, course, trace, segments.poses)
    return certificate_in_sets(system, record, segments, intervals, tails, _starting(trace, contacts))


def _starting(trace: Array, contacts: int) -> Array:
    """Segment, signal, order and size (m, 4) of the roots with which gaps and reactions start."""
    each = trace[:, row.EACH_AT :].reshape(len(trace), row.TRACED, contacts)
    condition, order, rise = each[:, row.CONDITION], each[:, row.ORDER], each[:, row.RISE]
    which, j = np.nonzero((order > 0) & np.isin(condition, (row.AWAY, row.KEPT)))
    signal = j + np.where(condition[which, j] == row.KEPT, contacts, 0)
    return np.stack([which, signal, order[which, j], rise[which, j]], axis=1).astype(float)
