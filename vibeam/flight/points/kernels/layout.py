"""Layout of the arrays of points in lanes: each row one register wide, a number for every lane.

``common`` holds what belongs to a point, ``modal`` what belongs to a point and a mode; both are flat.
"""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels.layout import Engine
from vibeam_models.arrays import Array, Index

WIDTH = 8

# common: the drive and the stop
OMEGA, CONST, PHASOR_RE, PHASOR_IM, SIZE, RESTITUTION, LOSS, GAP, COARSEST, LONGEST = range(10)
PERIOD, PERIOD_HIGH, PERIOD_LOW, PERIOD_REST, INVERSE = range(10, 15)

# where the flight starts: time in the drive's period, whole periods left, phase, g', the largest velocity so far; Σ e
# and Σ x'' of the pairs; level tried first; impacts so far, and since the lane was entered
CLOCK, LEFT, COS, SIN, RISE, SPEED, SUM_E, SECOND, FIRST, IMPACTS, PANELS, MOST = range(15, 27)

# the walk: level, panels since it changed, panels before it is lengthened, whether it just was; panel length and turn
LEVEL, SINCE, PATIENCE, LENGTHENED, STEP, TURN_RE, TURN_IM = range(27, 34)

# a first panel: its length and phasors
STEP_1, TURN_RE_1, TURN_IM_1, SECOND_RE, SECOND_IM, FIRST_RE, FIRST_IM, LEVEL_1 = range(34, 42)

# a panel with one root: its start and length, value, slope, second derivative at both ends, bound of the fifth
ROOT_TIME, ROOT_STEP, P0, S0, C0, P1, S1, C1, FIFTH = range(42, 51)

# the landing: time, phase, value, slope
TIME, LAND_COS, LAND_SIN, VALUE, SLOPE = range(51, 56)

# the state after an impact to which later ones are compared, and the number of impacts at which it is renewed
SAME_CLOCK, SAME_LEFT, SAME_SPEED, SAME_FIRST, SAME_IMPACTS, SAME_PANELS, RENEWED = range(56, 63)
COMMON_ROWS = 63


# modal: constants; pairs at the start, the node, the trial end, the landing; the tables of the panel and the first
# panel; the state compared to
RATE, TURN, TURN_INVERSE, DAMP, SPRING, NORM, KICK, PUT, K1, K2, K4, K5 = range(12)
START_X, START_Y, X, Y, E, X2, Y2, E2, LAND_X, LAND_Y, D2, D3, D4 = range(12, 25)
P00, P01, P10, P11, LOW, MISSED = range(25, 31)
D0, D1, V0, V1, LOW_1, MISSED_1 = range(31, 37)
SAME_X, SAME_Y = 37, 38
MODAL_ROWS = 39


# phases of a lane: without a point, flying side by side with others, alone, past its settling
EMPTY, FLYING, ALONE, SETTLED = range(4)

# integers of a lane: its phase, its point, the packed system that its engine holds, whether its point may fly side by
# side with others, impacts that it goes alone when it does, impacts when it was entered, whether it is paused alone,
# whether its motion has come back to the bits of an earlier impact
PHASE, POINT, PACK, ELIGIBLE, STAY, ENTERED, PAUSED_ALONE, RECURS = range(8)
LANE_ROWS = 8

# numbers of a lane that is alone: span, impacts at which it ends, clock and periods left at its start, periods in it
SPAN, UPTO, BEGAN, TURNS = range(4)
ALONE_ROWS = 4


# mark (MARK + n,): the period it was set at, the largest velocity, free or resting, impacts in the hold, sum of their
# velocities, time at rest, impacts in all; the first row of the trace that is of the period watched, −1: that is no
# longer there; then the modes' energies
PLACE, TOP, STATE, HITS, SUM, RESTED, ALL, FROM, MARK = range(9)


# flights of one point side by side, to be read off: time in the drive's period at their start, duration, a sum, two
# rows of room; then for each mode the free motion at the start, at the node and the trial end, two sides
FLIGHT_CLOCK, FLIGHT_SPAN, FLIGHT_SUM, FLIGHT_ROOM, FLIGHT_COMMON = 0, 1, 2, 3, 5
FLIGHT_U, FLIGHT_V, FLIGHT_X, FLIGHT_Y = 0, 1, 2, 3  # + 2 for the other side
FLIGHT_ROWS = 6


class LaneRows(NamedTuple):
    """Arrays of flights side by side: a call passes every array's every length, so as few as can be."""

    common: Array
    modal: Array
    levels: Array  # (WIDTH, LEVEL_ROWS, LEVELS)
    rungs: Array  # (WIDTH, …)


class Lane(NamedTuple):
    """Points in lanes: their rows, and for each lane the engine of its point."""

    common: Array  # (COMMON_ROWS * WIDTH,)
    modal: Array  # (n * MODAL_ROWS * WIDTH,)
    engines: Engine  # each array with one axis more in front, one entry a lane
    poses: Array  # (WIDTH, 2, n)
    status: Array  # (WIDTH, STATUS_ROWS)
    counts: Index  # (WIDTH, COUNT_ROWS)
    whole: Index  # (WIDTH, LANE_ROWS)
    alone: Array  # (WIDTH, ALONE_ROWS)
    marks: Array  # (MARK + n,): see ``watch``; of one lane at a time, as there is one ``Watch``
    flights: Array  # ((FLIGHT_COMMON + n * FLIGHT_ROWS) * WIDTH,) of one lane at a time


class Task(NamedTuple):
    """Points to compute, and what each comes to."""

    packs: Engine  # each array with one axis more in front, one entry a packed system
    pack: Index  # (m,)
    drives: Array  # (m, 4): Ω, B, gap, restitution
    held: Array  # (m, n) least displacement with the contact on the stop
    constants: Array  # (m, 2, blocks) of the system held there
    offsets: Array  # (m, 2) constants of its contact force and output; or (m, 2 + n), with the output's row
    poses: Array  # (m, 2, n) starts, in place of which the ends are put
    kinds: Array  # (m,) FREE or RESTING, the same
    results: Array  # (m, RESULT_ROWS)
    energy: Array  # (m, n)
    strobes: Array  # (m, k)
    counts: Index  # (m, COUNT_ROWS)
    ended: Index  # (m, 2): outcome, period


class Disturbances(NamedTuple):
    """Disturbances of m points: how long each is carried along, columns of (δη, δη'), and how they grow."""

    periods: Index  # (m,) drive periods
    columns: Array  # (m, c, 2, n), in place of which what they have become is put
    growth: Array  # (m, p) factor in each period of the one column, then of size 1; or p = 0
    ended: Index  # (m, 2): outcome, DIRECTION_LOST where a direction is lost or rests are met


DIRECTION_LOST = 1
