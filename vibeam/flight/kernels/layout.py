"""Layout of the kernels' arrays, and thresholds that what packs or reads these arrays needs too.

The kernels work on a few float arrays with named rows: a compiled call passes an array almost for free, a tuple of
thirty arrays not at all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam_models.arrays import Array


class Regime(NamedTuple):
    """One linear system y' = Ay + constant + load Ω²B sin φ of m ≤ n blocks, and the signals read off it."""

    pairs: Array
    table: Array
    levels: Array
    signal: Array
    attached: Array
    blocks: Array
    into: Array  # (2m, 2n): y from (η − held, η')
    outof: Array  # (2n, 2m): (η − held, η') from y
    held: Array  # (n,)
    signals: Array  # (SIGNALS, 2m + 2)
    terms: Array  # (2, 2m + 2, 2 + n) room for the exponentials that every mode is a sum of: see ``block_energy``


class Engine(NamedTuple):
    """See ``layout`` for the rows. The free system in modes, the system held on the stop as a regime."""

    pairs: Array
    table: Array
    levels: Array
    signal: Array
    attached: Array
    modes: Array
    drive: Array
    rest: Regime
    cells: Array  # the free system in blocks of modes, see ``lanes.panels``; empty where that cannot be
    rungs: Array


class Watch(NamedTuple):
    """Arrays by which a point of a sweep is watched: an output's row, the segments traced, the readings off them."""

    row: Array  # (n,) the output
    nothing: Array  # (0, TRACE_COLUMNS): no trace is kept
    trace: Array  # (m, TRACE_COLUMNS)
    poses: Array  # (m, 2, n)
    strobes: Array  # (hold + 1, 2, n)
    scratch: Array  # (2, n)
    frame: Array  # (2, n)
    result: Array  # (RESULT_ROWS,)
    energy: Array  # (n,) ∫ E dt of each mode
    share: Array  # (n + 1,) what the last period watched added to it, and to the time at rest
    reading: int  # how much is read off: see ``layout``


class Phase(NamedTuple):
    """cos φ and sin φ of the drive's phase φ = Ωt."""

    cosine: float
    sine: float


class PointSchedule(NamedTuple):
    """Schedule of a point of a sweep."""

    settle: int  # periods
    hold: int  # periods watched
    limit: int  # impacts a period after which it is given up
    longest: int  # drive periods after which a motion is looked at for repeating
    piece: int  # work between two pauses, in panels
    watching: int  # panels that reading a segment off is as much work as, about


LEVELS = 64  # dyadic panel lengths: 9.2e18 between the longest and the shortest
SERIES = 26  # Taylor terms of an attached pair: 1.2²⁶/26! = 3e-25


# pairs (PAIR_ROWS, n): the linear system's constants, then the signal's pairs at start, node, trial end and root
OMEGA, SIGMA, DISC, KAPPA, INVERSE, DECAY = range(6)
X0, Y0, X, Y, E, X2, Y2, XT, YT = range(6, 15)

# of a pair far beyond critical damping, whose node and trial end hold its two decays s e^{−at}, f e^{−bt} in place of
# (x, x'): a, 1 and −b, so that x = X + JOIN·Y and x' = TILT·Y − SLOW·X, and |s|; of any other 0, 0, 1, 0
SLOW, JOIN, TILT, CREEP = range(15, 19)
PAIR_ROWS = 19


# table (TABLE_ROWS, LEVELS, n): P00 P01 P10 P11 of (x, x') over a panel, D0 D1 V0 V1, and what carries X, Y over it
WALK = 8
TABLE_ROWS = 12


# modes (MODE_ROWS, n): the free system's modes, one drive's steady response Im((RE + i IM) e^{iφ}) + OFFSET, and how
# each yields where the contact is brought back onto the stop
CONTACT, LOAD, STATIC, ZETA, RE, IM, OFFSET, YIELD = range(8)
MODE_ROWS = 8


# levels (LEVEL_ROWS, LEVELS): panel length, pairs it resolves, e^{iΩh}, (e^{iΩh} − 1 − iΩh)/h², (e^{iΩh} − 1)/h
STEP, COUNT, TURN_RE, TURN_IM, SECOND_RE, SECOND_IM, FIRST_RE, FIRST_IM = range(8)
LEVEL_ROWS = 8


# signal (SIGNAL_ROWS,): constant, phasor, Ω, drive phase, number of attached pairs, |phasor|; value and slope at both
# ends of the last panel; derivatives 0…5 at the start of the interpolated part and of the whole, 0…7 at a guess
CONST, ZR, ZI, DRIVE, COSINE, SINE, ATTACHED, HARMONIC = range(8)
P0, S0, P1, S1 = range(8, 12)
LOW, WHOLE, TAYLOR = 12, 18, 24
SIGNAL_ROWS = 32


# attached (ATTACHED_ROWS, n): pairs that carry their force F sin φ + G cos φ + s along, which mode each is, its
# weight in the signal, and room for the terms of its Taylor series
AX, AY, ASIGMA, AOMEGA, ASINE, ACOSINE, ASTATIC, AMODE, AWEIGHT, NODE_X, NODE_Y, TRIAL_X, TRIAL_Y, TERM = range(14)
ATTACHED_ROWS = TERM + SERIES


# drive (DRIVE_ROWS,): Ω, Ω²B, 2π/Ω in two parts, contact phasor, gap less the static offsets, coarsest level; the stop;
# the size of the motion where it is known, or infinite; the longest flight that ``plain_flights_in_lanes`` takes on;
# the coarsest level at rest
W, STRENGTH, PERIOD, PERIOD_REST, CONTACT_RE, CONTACT_IM, CLEARANCE, COARSEST = range(8)
GAP, RESTITUTION, MOBILITY, AMPLITUDE, MOTION, LONGEST, COARSEST_AT_REST = range(8, 15)
DRIVE_ROWS = 15


# blocks (BLOCK_ROWS, m): a regime's 2×2 blocks, inputs, steady response, what is left of them, their weights in the
# signal, whether they have no steady response and carry their force along, and which mode alone they are, or −1
A11, A12, A21, A22, CONSTANT1, CONSTANT2, LOAD1, LOAD2 = range(8)
RE1, RE2, IM1, IM2, OFFSET1, OFFSET2, Z1, Z2, WEIGHT1, WEIGHT2, CARRIED, MODE = range(8, 20)
BLOCK_ROWS = 20


# signals (SIGNALS, 2m + 2) of a regime, one row each: weights on y, the constant, the share of Ω²B sin φ; gap and
# contact force by stop, first and second, and the output
GAP_SIGNAL, FORCE_SIGNAL, OUTPUT_SIGNAL = 0, 2, 4
SIGNALS = 5


# pose (2, n): modal values, velocities; status (STATUS_ROWS,): time in the drive period, free or resting, order of the
# contact at the start and g^{(order)} there, the largest impact velocity so far, cos and sin of the drive's phase; of a
# span that was paused: the time done and its rounding error; of a period that is watched: the time left
CLOCK, KIND, ORDER, RISE, SPEED, PHASE_COS, PHASE_SIN, DONE, LOST, UNSEEN = range(10)
STATUS_ROWS = 10
FREE, RESTING = 0.0, 1.0


# trace (m, TRACE_COLUMNS): a segment each; what ended it, the contact velocity before, what a chatter still takes
START, DURATION, AT_CLOCK, WHAT, END, BEFORE, LEFT, REMAINDER = range(8)
TRACE_COLUMNS = 8
SPAN_END, IMPACT, RELEASE, CHATTER, STUCK = range(5)


# counts (COUNT_ROWS,): what was done; then how far a point of a sweep is: events so far, the impacts it may have at the
# end of the present span, periods settled, periods watched + 1 (0: still settling), whether the period repeats; the
# segment to read off next where that was paused, and the outcome that waits for it
IMPACTS, PANELS, CHATTERS, SEGMENTS, EVENTS, MOST, SETTLED, WATCHED, KNOWN, READ, ENDED = range(11)
COUNT_ROWS = 11


# result (RESULT_ROWS,) of the hold: extremes of the output, least contact displacement, impacts, their velocities' sum,
# time at rest; then the last impact velocities, oldest first after ``aligned``
HIGH, LEAST, CONTACT_LEAST, STRUCK, SPEED_SUM, REST_TIME, VELOCITY = range(7)
KEPT = 16
RESULT_ROWS = VELOCITY + KEPT


# how much of a hold is read off: the output's extremes alone, the gap's too, the modes' energies too
OUTPUT_ALONE, REACH_TOO, EVERYTHING = range(3)


NO_CLOCK = -1.0  # tells ``first_root`` that the signal is no gap of uncoupled modes, which it could judge more sharply


# outcomes; FULL: the trace is, PAUSED: Python may look for signals; both go on when called again
COMPLETE, FULL, EVENT_LIMIT, PENETRATED, NOT_FINITE, UNRESOLVED, PAUSED = range(7)

# of a certificate: columns of a piece, of which segment and signal, and its claim; columns of a task, a signal over a
# segment and its root at the start; what is added to a signal's number (GAP_SIGNAL, FORCE_SIGNAL, each plus the side)
# for its negative
PIECE_SEGMENT, BEGIN, LENGTH, CLAIM, PIECE_SIGNAL = range(5)
PIECE_COLUMNS = 5
OPEN, CLOSES, UNPROVED = 0.0, 1.0, 2.0
TASK_SEGMENT, TASK_SIGNAL, TASK_ORDER, TASK_RISE, CLOSING = range(5)
TASK_COLUMNS = 5
NEGATIVE = 4

# of Moreau–Jean time stepping: rows (MOREAU_ROWS, n): ω², 2ζω, contact, load Ω²B, static, 1/(1 + 2ζω θh + ω²θ²h²),
# workspace for the free velocities; scheme (4,): h, θ, gap, R; strikes (≥ count, 2): step, contact velocity before;
# totals (2,): impacts, steps held on the stop
MOREAU_STIFFNESS, MOREAU_DAMPING, MOREAU_CONTACT, MOREAU_LOAD, MOREAU_STATIC, MOREAU_INVERSE, MOREAU_FREE = range(7)
MOREAU_ROWS = 7
MOREAU_STEP, MOREAU_THETA, MOREAU_GAP, MOREAU_RESTITUTION = range(4)
MOREAU_IMPACTS, MOREAU_HELD = range(2)

# thresholds that what packs or reads the arrays needs too
PANEL = 2.1  # the longest panel is at most this over the drive's rate: a sixth to a third of its period
RESOLVED = 1.2  # κh up to which a pair takes part in the interpolant; above it enters by bounds
APART = 0.75  # μ²/σ² = 1 − 1/ζ² beyond which a pair is taken as its two decays: ζ > 2, one 13.9 times the other
LINGERING = 8.0  # longest panels, over e-folding time of the slow decay, below which it outlasts the lanes' panels
ELASTIC = 1e-5  # 1 − R below which an accumulation of impacts is left by its energy, not completed by its limit
SILENT = 1e-100  # a contact value so small that dividing by it would lose digits; such modes are carried by themselves
FORGOTTEN = 75.0  # decay exponents beyond this leave less than 1e-32
REDUCED = 1e5  # rad up to which the parts keep all digits
FAR = 10.0  # distance of the equilibrium over the size of the motion beyond which taking it out loses digits
BRISK = 1e3  # 2σ over the rate of the motion, or both over the drive's, beyond which carrying a mode costs too much
FAR_DRIVEN = 1e5  # the same of a steady response, which the motion soon becomes as large as, and carrying costs more

# an accumulation of impacts that is completed by its limit
NEAR = 1e-11  # share of the length scale that what is left of it may span before its completion is considered
NEAR_MODES = 4e-15  # the same where other modes feel the impulses left out
FAITHFUL = 1e-11  # share of the whole accumulation by which its end may be misjudged
LATE = 1e-12  # share of the slowest time scale by which the end of the accumulation may be misjudged
FLOOR = 1e-26  # share of the length scale below which a flight is no longer one

# shares of a motion's size by which states one period apart may differ
SAME = 1e-14  # where a period is taken for a copy of the one before
REPEATS = 1e-5


def watch_of(row: Array, hold: int, trace: Array, poses: Array, reading: int = EVERYTHING) -> Watch:
    """Watch over ``hold`` periods of the output with that row (n,), room for segments in ``trace`` and ``poses``."""
    n = len(row)
    return Watch(
        row, np.zeros((0, trace.shape[1])), trace, poses, np.zeros((hold + 1, 2, n)), np.zeros((2, n)),
        np.zeros((2, n)), np.zeros(RESULT_ROWS), np.zeros(n), np.zeros(n + 1), reading,
    )  # fmt: skip
