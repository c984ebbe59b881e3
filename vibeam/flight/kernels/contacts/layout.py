"""Layout of this engine's arrays, beside those of ``kernels.layout`` and ``regimes.layout``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam.flight.kernels.contacts.course import Course

# status: the regimes' rows, then the contacts held, and those that a yielding stop pushes, sums of 2^contact; the set
# that is wanted, its key + 1; the phase; of an instant with impulses: contacts touched, those pressed by a force, the
# fastest approach at its begin, impulses so far, which is next, the largest velocity before one, the contact met or
# left; the signal met, or NONE; the number of contacts held, where contact is integrated; the piece of a load, of which
# CLOCK is the time within it then; from EACH on ``CONDITIONS``
HELD, PUSHED, WANTED, PHASE, TOUCHED, PRESSED, FIRST, STRIKES, NEXT, HARDEST, AT, MET, KEPT_NUMBER = range(17, 30)
PIECE, EACH = 30, 31
# rows (k numbers each): what each contact is in, order and size of the root with which its signal starts, the largest
# impact velocity so far
CONDITION, ORDER, RISE, TOP = range(4)
CONDITIONS = 4
AWAY, KEPT, IMPLIED, PUSHING, INSIDE = 0.0, 1.0, 2.0, 3.0, 4.0  # CONDITION; IMPLIED: held where others are
FLYING, STRIKING, BEGINNING = 0.0, 1.0, 2.0  # PHASE

# trace: the regimes' columns, then the contacts held and those pushed, sums of 2^contact; the signal whose root ended
# the segment, or NONE; the piece of a load; from EACH_AT on, for each contact at its start, what it was in, order and
# size of its root
HELD_AT, PUSHED_AT, MET_AT, PIECE_AT, EACH_AT = range(regime_layout.TRACE_COLUMNS, regime_layout.TRACE_COLUMNS + 5)
TRACED = 3  # rows of ``CONDITIONS`` that are traced

# vectors (VECTORS, n): acceleration without constraint and the sizes of its parts, its rate as far as the drive goes,
# acceleration and jerk as constrained, the jerk before that, the sizes of its parts, a direction
PULL, PULL_SIZE, DRIVE_RATE, ACCELERATION, JERK, RATE, RATE_SIZE, DIRECTION = range(8)
VECTORS = 8

# small (SMALL, k): right-hand sides and multipliers, trial and gradient of non-negative least squares, order and rise
# found for each contact
MULTIPLIER, TRIAL, GRADIENT, FOUND_ORDER, FOUND_RISE, SCALE = range(6)
SMALL = 6

# picks (PICKS, k): lists of contacts, and flags of contacts
LIST, STILL, CHOSEN, IS_HELD, IS_GONE, IS_IMPLIED = range(6)
PICKS = 6

NONE = -1  # no contact, no signal
UNDECIDED = -9.0  # FOUND_ORDER of a contact that is to be held or let go


class ContactEngine(NamedTuple):
    """All arrays of the motions of one system: S sets of contacts as regimes, each of n blocks; k contacts."""

    sets: Array  # (S,) keys: contacts held + 2^k · contacts pushed; −1: no set yet
    pairs: Array  # (S, …): see ``kernels.layout.Regime``; with blocks that move nothing for coordinates not left free
    table: Array
    levels: Array
    blocks: Array
    into: Array
    outof: Array
    held: Array
    signals: Array  # (S, 2k + 1, 2n + 2): gap of each contact, force of each, the output
    coarsest: Array  # (S,) level of the longest panel to try
    signal: Array
    attached: Array
    terms: Array
    drive: Array
    rows: Array  # (k, n)
    gaps: Array  # (k,)
    laws: Array  # (k, LAW_ROWS)
    curves: Array  # (k, 3, m) tables R(v)
    gram: Array  # (k, k) rows M⁻¹ rowsᵀ
    soft: Array  # (k, k) the same with 1/ω² of every mode
    yields: Array  # (n,) 1/ω², finite for a mode without stiffness
    omega: Array
    spring: Array  # (n,) ω²
    damper: Array  # (n, n); used where the modes are coupled
    damping: Array  # (n,) 2ζω, used elsewhere
    load: Array
    static: Array
    numbers: Array  # (NUMBERS,)
    vectors: Array
    small: Array
    lower: Array  # (k, k) a Cholesky factor
    inverse: Array  # (k, k)
    picks: Index
    watched: Index  # (2k,) the signals watched
    nodes: Array  # (14, 12) Runge–Kutta, as in ``RegimeEngine``
    weights: Array  # (2, 13)
    stages: Array  # (13, 2, n)
    state: Array  # (3, 2, n): at the step's start, its end, a stage
    saved: Array  # (2, n) pose and status before an event, where it wanted a set
    memory: Array
    tried: Array  # (2, n) the same before an accumulation was tried to be completed
    trial: Array
    course: Course  # of a load in place of the sine; of none, without room


# numbers (NUMBERS,): 1 where damping couples the modes; the slowest rate that panels serve, rad/s
COUPLED, SLOWEST = range(2)
NUMBERS = 2


def status_rows(contacts: int) -> int:
    """Number of rows of the status."""
    return EACH + CONDITIONS * contacts


def trace_columns(contacts: int) -> int:
    """Number of columns of the trace."""
    return EACH_AT + TRACED * contacts


def room_for(contacts: int, modes: int) -> dict[str, Any]:
    """The working arrays."""
    k, n = contacts, modes
    return {
        "vectors": np.zeros((VECTORS, n)), "small": np.zeros((SMALL, k)), "lower": np.zeros((k, k)),
        "inverse": np.zeros((k, k)), "picks": np.zeros((PICKS, k), dtype=np.int64),
        "watched": np.zeros(2 * k, dtype=np.int64), "stages": np.zeros((13, 2, n)), "state": np.zeros((3, 2, n)),
        "saved": np.zeros((2, n)), "memory": np.zeros(status_rows(k)),
        "tried": np.zeros((2, n)), "trial": np.zeros(status_rows(k)),
    }  # fmt: skip
