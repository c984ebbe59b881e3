"""Windows of pieces on which an energy bound excludes every root: passed by the flow alone.

Over T, |r·y(t)| is at most |r·e^{At}y| + T max|u| max|r·e^{At}l| + T max|r·e^{At}c| block by block, and each of those
free pairs is bounded for all times by its value and rate at the start.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts.course import Course
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.panel import row_of, sign_of
from vibeam.flight.kernels.contacts.load.phi import step_over
from vibeam.flight.kernels.contacts.load_value import load_at
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import norm
from vibeam_models.arrays import Array


@kernel
def is_quiet(engine: ContactEngine, regime: Regime, number: int, piece: int, left: float) -> bool:
    """True where no signal watched vanishes in the WINDOW pieces, all of one length, that begin here, at a node."""
    course = engine.course
    if piece % row.WINDOW != 0 or piece + row.WINDOW >= course.lengths.shape[0]:
        return False
    length = course.lengths[piece]
    for i in range(1, row.WINDOW):
        if course.lengths[piece + i] != length:
            return False
    span = row.WINDOW * length
    if span >= left:
        return False
    for place in range(number):
        if course.watch[row.ADDED, place] != 0.0:
            return False
        if not is_far(engine, regime, engine.watched[place], span, course.peaks[piece // row.WINDOW]):
            return False
    return True


@kernel
def is_far(engine: ContactEngine, regime: Regime, which: int, span: float, peak: float) -> bool:
    """True where one signal stays above zero over a span on which |u| is at most ``peak``."""
    weights, sign, n = regime.signals[row_of(engine, which)], sign_of(engine, which), engine.omega.shape[0]
    blocks, flow, most = regime.blocks, engine.course.flow, abs(weights[2 * n + 1]) * peak
    size = abs(weights[2 * n])
    for k in range(n):
        own = bound_of_free(regime, weights, k, flow[row.Y, k], flow[row.Y + 1, k], span)
        size += own
        pushed = bound_of_free(regime, weights, k, blocks[layout.LOAD1, k], blocks[layout.LOAD2, k], span)
        still = bound_of_free(regime, weights, k, blocks[layout.CONSTANT1, k], blocks[layout.CONSTANT2, k], span)
        most += own + span * (peak * pushed + still)
    return bool(sign * weights[2 * n] - most > 8.0 * EPSILON * size)


@kernel
def bound_of_free(regime: Regime, weights: Array, k: int, y1: float, y2: float, span: float) -> float:
    """Bound over ``span`` of r·e^{At}(y1, y2) in block k."""
    b, r0, r1 = regime.blocks, weights[2 * k], weights[2 * k + 1]
    x = r0 * y1 + r1 * y2
    y = r0 * (b[layout.A11, k] * y1 + b[layout.A12, k] * y2) + r1 * (b[layout.A21, k] * y1 + b[layout.A22, k] * y2)
    most = abs(x) + span * abs(y)
    if regime.pairs[layout.INVERSE, k] > 0.0:
        most = min(most, norm(x, y * regime.pairs[layout.INVERSE, k]))
    return float(most)


@kernel
def pass_window(regime: Regime, course: Course, slot: int, piece: int) -> float:
    """Carry flow[Y] through WINDOW pieces of one length; the time."""
    c, length, flow, b = course.pieces, course.lengths[piece], course.flow, regime.blocks
    step = course.steps[slot, step_over(regime, course, slot, length, length)]
    for i in range(piece, piece + row.WINDOW):
        u, u1, u2, u3 = c[i, 0], c[i, 1], 2.0 * c[i, 2], 6.0 * c[i, 3]
        for k in range(b.shape[1]):
            y1, y2 = flow[row.Y, k], flow[row.Y + 1, k]
            x = b[layout.A11, k] * y1 + b[layout.A12, k] * y2 + b[layout.LOAD1, k] * u + b[layout.CONSTANT1, k]
            y = b[layout.A21, k] * y1 + b[layout.A22, k] * y2 + b[layout.LOAD2, k] * u + b[layout.CONSTANT2, k]
            first = step[row.STEP11, k] * x + step[row.STEP12, k] * y
            second = step[row.STEP21, k] * x + step[row.STEP22, k] * y
            first += u1 * step[row.FIRST_LOAD, k] + u2 * step[row.SECOND_LOAD, k] + u3 * step[row.THIRD_LOAD, k]
            second += (
                u1 * step[row.FIRST_LOAD + 1, k] + u2 * step[row.SECOND_LOAD + 1, k] + u3 * step[row.THIRD_LOAD + 1, k]
            )
            flow[row.Y, k], flow[row.Y + 1, k] = y1 + first, y2 + second
    course.numbers[row.U_LAST], course.numbers[row.U1_LAST] = load_at(course, piece + row.WINDOW - 1, length)
    return float(row.WINDOW * length)
