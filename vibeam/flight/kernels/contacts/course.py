"""Layout of the arrays of a load over time, u(t) in place of Ω²B sin φ: its pieces, and the flow under it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam_models.arrays import Array

# flow (FLOW_ROWS, n): of every block its coordinates y at a node and their derivatives 1 to 5 there, two rows each; y
# at the end of a panel, its rate there, what it has grown by; at the node the sizes of which round-off is a share
Y, RATE, SECOND, THIRD, FOURTH, FIFTH, TRIAL, TRIAL_RATE, GROWTH, NOISE = range(0, 20, 2)
FLOW_ROWS = 20

# steps (S, BANKS · GRADES + 1, STEP_ROWS, n): of some lengths h of pieces, over h, half of it, … (τ = h/2^grade):
# τφ₁(Aτ) as a matrix, and what u', u'', u''' add: τ²φ₂l, τ³φ₃l, τ⁴φ₄l; the last one is of any length
STEP11, STEP12, STEP21, STEP22, FIRST_LOAD, SECOND_LOAD, THIRD_LOAD = 0, 1, 2, 3, 4, 6, 8
STEP_ROWS = 10
GRADES, BANKS = 12, 4
BANK = GRADES + 1  # numbers of a length: itself, and whether each grade was made
ANY, NEXT = BANKS * BANK, BANKS * BANK + 1  # then the length of the last step, and the bank that is given up next

# phi (PHI_ROWS, n): p and q of φ_j(Aτ) = p + qA, j = 0 … 4, two rows each
PHI_ROWS = 10

# watch (WATCH_ROWS, 2k), of every signal watched: value and slope at the node, at the panel's end, verdict, order and
# size of the root with which it starts, what is added to it where it stays at zero, the size of its parts
AT, SLOPE, LAST, LAST_SLOPE, FOUND, START_ORDER, START_RISE, ADDED, PARTS = range(9)
WATCH_ROWS = 9

# numbers (NUMBERS,) of a load: 0 where there is none; u, u', u'', u''' at the node; u and u' at the panel's end; the
# piece and the time in it where a walk ended, and why; intervals written; whether they are asked for
LOADED, U, U1, U2, U3, U_LAST, U1_LAST, PIECE_NOW, CLOCK_NOW, WHY, WRITTEN, CERTIFIED = range(12)
NUMBERS = 12
REACHED, KEPT_POINT, JUMPED, RENEWED = range(4)  # WHY: span or signal; a point kept; u jumped; a stop touched is judged

WINDOW = 32  # pieces whose largest |u| is known
LONG = 4096  # panels of a segment at most
STRIDE = 256  # pieces after which a segment ends, so that its first pose is kept


class Course(NamedTuple):
    """Course of a load: K pieces u = Σ c_j s^j; and room for the flow of n blocks and k contacts under it."""

    pieces: Array  # (K, 4)
    lengths: Array  # (K,) s
    peaks: Array  # (K // WINDOW + 1,) largest |u| in every WINDOW pieces
    numbers: Array
    flow: Array
    phi: Array
    steps: Array  # (S, BANKS · GRADES + 1, STEP_ROWS, n)
    grades: Array  # (S, NEXT + 1)
    watch: Array
    intervals: Array  # (m, PIECE_COLUMNS) of a certificate


def course_of(pieces: Array, lengths: Array, peaks: Array, sets: int, modes: int, contacts: int) -> Course:
    """The course of a load (no pieces: of none), with room for the flow."""
    loaded = len(lengths) > 0
    s, n, k = (sets, modes, contacts) if loaded else (0, 0, 0)
    numbers = np.zeros(NUMBERS)
    numbers[LOADED] = float(loaded)
    return Course(
        pieces, lengths, peaks, numbers, np.zeros((FLOW_ROWS, n)), np.zeros((PHI_ROWS, n)),
        np.zeros((s, BANKS * GRADES + 1, STEP_ROWS, n)), np.zeros((s, NEXT + 1)), np.zeros((WATCH_ROWS, 2 * k)),
        np.zeros((0, layout.PIECE_COLUMNS)),
    )  # fmt: skip


def no_course() -> Course:
    """The course of no load."""
    return course_of(np.zeros((0, 4)), np.zeros(0), np.zeros(0), 0, 0, 0)


def with_sets(course: Course, sets: int) -> Course:
    """The same with room for so many sets."""
    if not len(course.lengths):
        return course
    more: dict[str, Any] = {}
    for name in ("steps", "grades"):
        old = getattr(course, name)
        more[name] = np.concatenate([old, np.zeros((sets - len(old), *old.shape[1:]))])
    return course._replace(**more)


class OutputWatch(NamedTuple):
    """Outputs watched: weights on y, constant, share of the load, set by set; bins of time, what is found in each."""

    signals: Array  # (S, o, 2n + 2)
    edges: Array  # (b + 1,) s
    rows: Array  # (o, n + 2): the same on the modes, order of the derivative, share of the base's acceleration
    found: Array  # (o, b, 4): least, when, greatest, when
    ends: Array  # (6, o): value and slope at a panel's begin and end, what it says, round-off of the value
    walk: Array  # (WALK,)


# walk (WALK,): the bin, time, time left of the segment, the panel to try next; panels of the segment, whether it is
# entered, panels since the call
PLACE, TIME, LEFT, WANT, PANELS, ENTERED, WORK = range(7)
WALK = 7
