"""Layout of this engine's arrays, beside ``vibeam.flight.kernels.layout``."""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels.layout import Regime
from vibeam_models.arrays import Array

# law (LAW_ROWS,): which family, its numbers; what damping there is while a linear stop pushes
FAMILY, STIFFNESS, DAMPING, EXPONENT, COEFFICIENT, VELOCITY, CURVE, COUPLED, SIDES, MOBILITY = range(10)
LAW_ROWS = 10
IMPULSIVE, LINEAR, CURVED = 0.0, 1.0, 2.0  # FAMILY
CONSTANT, TABLE, PLASTIC, VISCOUS = 0.0, 1.0, 2.0, 3.0  # CURVE
SPEED_AT, VALUE_AT, SLOPE_AT = range(3)  # rows of the table


# status: the flight kernels' rows, then the side of the stop met, phases without duration in a row, the last step, the
# largest force of a contact that is integrated, what a chatter still takes and the bound of its error, the steps beyond
# what the time gone by allows
SIDE, STALL, STEPPED, PEAKED, LEFT_OVER, LEFT_ERROR, BUSY = range(10, 17)
STATUS_ROWS = 17
CONTACT, INSIDE = 2.0, 3.0  # KIND, beside FREE and RESTING: pushed by the stop; where it is, but not pushed

# ORDER of a start of which nothing is known; of one on the stop and moving into it; of one that touches a stop that
# yields without being pushed or drawn away, beyond round-off
UNKNOWN, HIT, TOUCHING = -1.0, -2.0, -3.0


# trace: the flight kernels' columns, then the side of the stop and the largest contact force
AT_SIDE, PEAK = 8, 9
TRACE_COLUMNS = 10
PASS = 5  # END: from inside the stop's range to outside it, or pushed again


class RegimeEngine(NamedTuple):
    """All arrays that one run of one system works on."""

    free: Regime
    upper: Regime  # at the first stop: resting on it or pushed by it
    lower: Regime  # at the second stop; the first again where there is none
    drive: Array
    law: Array
    curve: Array  # (3, m) the table R(v)
    contact: Array  # (2, n) towards either stop
    yields: Array  # (2, n) displacements that move it by 1 with the least energy
    gaps: Array  # (2,)
    omega: Array  # (n,)
    spring: Array  # (n,) ω²
    damper: Array  # (n, n); used where law[COUPLED] > 0
    damping: Array  # (n,) 2ζω, used elsewhere
    load: Array
    static: Array
    nodes: Array  # (14, 12) Runge–Kutta: A, then B, then C
    weights: Array  # (2, 13) of the two error estimates
    stages: Array  # (13, 2n)
    state: Array  # (3, 2n): at the step's start, its end, a stage
