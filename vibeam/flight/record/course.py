"""The course of a record's load over a motion, as the kernels take it."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Lock
from weakref import WeakValueDictionary

import numpy as np

from vibeam.flight.kernels.contacts.course import WINDOW
from vibeam.system.record import Record
from vibeam.system.record_pieces import blocks
from vibeam_models.arrays import Array, Index


@dataclass(frozen=True)
class RecordCourse:
    """The pieces of a record from the start of a motion to its end, with pieces of no load where it has none."""

    record: Record
    knots: Array  # (K + 1,) s
    pieces: Array  # (K, 4)
    lengths: Array  # (K,) s, all equal where those of the record are to round-off
    peaks: Array  # (K // WINDOW + 1,)

    @classmethod
    def of(cls, record: Record, start: float, end: float) -> RecordCourse:
        """The course of ``record`` for a motion from ``start`` to ``end``, s: one for all motions at a time."""
        key = id(record), min(start, record.start), max(end, record.end)
        with _ONE_AT_A_TIME:
            found = _COURSES.get(key)
            if found is None:
                found = _COURSES[key] = cls._made(record, start, end)
            return found

    @classmethod
    def _made(cls, record: Record, start: float, end: float) -> RecordCourse:
        knots, spacing = record.times, record.spacing
        pieces = record.sign * record.coefficients
        lengths = np.diff(knots) if spacing is None else np.full(len(pieces), spacing)
        none = np.zeros((1, 4))
        if start < knots[0]:
            knots, pieces = np.append(start, knots), np.concatenate([none, pieces])
            lengths = np.append(knots[1] - start, lengths)
        if end > knots[-1]:
            knots, pieces = np.append(knots, end), np.concatenate([pieces, none])
            lengths = np.append(lengths, end - knots[-2])
        return cls(record, knots, pieces, lengths, _peaks(pieces, lengths))

    def place(self, times: Array | float) -> tuple[Index, Array]:
        """Piece and time within it at ``times``, s."""
        piece = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.lengths) - 1)
        return piece, np.minimum(times - self.knots[piece], self.lengths[piece])

    def loads(self, times: Array) -> Array:
        """u and u' (2, m) at ``times`` (m,)."""
        piece, s = self.place(times)
        c = self.pieces[piece].T
        return np.array([c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2 * c[2] + 3 * s * c[3])])


_COURSES: WeakValueDictionary[tuple[int, float, float], RecordCourse] = WeakValueDictionary()  # each holds its record
_ONE_AT_A_TIME = Lock()


def _peaks(pieces: Array, lengths: Array) -> Array:
    """The largest |u| in every WINDOW pieces."""
    most = np.zeros(len(pieces) + -len(pieces) % WINDOW + WINDOW)
    for part in blocks(len(pieces)):
        most[part] = _largest(pieces[part], lengths[part])
    return np.asarray(most.reshape(-1, WINDOW).max(axis=1) * (1 + 1e-12))


def _largest(pieces: Array, lengths: Array) -> Array:
    """The largest |u| in each piece, by the hull of its Bernstein coefficients."""
    c = np.ascontiguousarray(pieces.T)
    slope, bend = c[1] * lengths / 3, c[2] * lengths**2 / 3
    second = c[0] + slope
    third = second + slope + bend
    last = third + slope + 2 * bend + c[3] * lengths**3
    return np.asarray(np.maximum(np.maximum(np.abs(c[0]), np.abs(second)), np.maximum(np.abs(third), np.abs(last))))
