"""The load at a time within one of its pieces."""

from __future__ import annotations

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.contacts.course import Course


@joined
def load_at(course: Course, piece: int, clock: float) -> tuple[float, float]:
    """u and u' at a time within a piece."""
    c = course.pieces
    value = c[piece, 0] + clock * (c[piece, 1] + clock * (c[piece, 2] + clock * c[piece, 3]))
    return value, c[piece, 1] + clock * (2.0 * c[piece, 2] + clock * (3.0 * c[piece, 3]))
