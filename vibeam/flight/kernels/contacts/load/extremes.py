"""Extremes of outputs over a motion under a load, bin by bin, to round-off.

A panel on which an output's hull stays within what its bin has seen is passed by; one on which its slope has one sign,
or its curvature, is settled by its ends and its one turn; any other is halved. In a contact that is integrated the
steps' ends count, and the tops of the cubics between them, where the step is made anew.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import Course, OutputWatch
from vibeam.flight.kernels.contacts.integrated import enter_segment
from vibeam.flight.kernels.contacts.integration import BEGIN, END, first_step, step
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.flow import accept, differentiate, fitted, grow, set_load
from vibeam.flight.kernels.contacts.load.panel import bound_of, growth_of, parts, read, set_functions
from vibeam.flight.kernels.contacts.load.poses import enter_loaded
from vibeam.flight.kernels.contacts.load_value import load_at
from vibeam.flight.kernels.contacts.sets import regime_of
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.regimes.contact_integration import MOST_STEPS, next_step
from vibeam.flight.kernels.roots.bounds import SLOPE, THIRD, VALUE
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.segments import copy_pose
from vibeam_models.arrays import Array

LEAST, LEAST_TIME, GREATEST, GREATEST_TIME = range(4)  # of ``found``
FIRST, FIRST_SLOPE, LAST, LAST_SLOPE, SAYS = range(5)  # of ``ends``
WITHIN, SETTLED, OPEN = range(3)  # what a panel says of an output
SHORTEST = 2.0**-40  # share of a piece below which a panel is not halved
ROUNDS = 60
TURNED = 1e-8  # share of a panel's steepest slope that is none: its square is lost in the value


@kernel
def note_value(watch: OutputWatch, at: int, place: int, value: float, time: float) -> None:
    """An output has this value there."""
    found = watch.found[at, place]
    if value < found[LEAST]:
        found[LEAST], found[LEAST_TIME] = value, time
    if value > found[GREATEST]:
        found[GREATEST], found[GREATEST_TIME] = value, time


@kernel
def bin_of(watch: OutputWatch, time: float, place: int) -> int:
    """The bin, ``place`` or a later one, in which a time lies."""
    while place < watch.edges.shape[0] - 2 and watch.edges[place + 1] <= time:
        place += 1
    return place


@kernel
def read_flow(engine: ContactEngine, watch: OutputWatch, segment: Array, pose: Array, place: int) -> int:
    """Extremes over a segment that is closed form, from its first pose; the last bin."""
    slot = enter_loaded(engine, pose, segment)
    course, regime = engine.course, regime_of(engine, slot)
    numbers, lengths = course.numbers, course.lengths
    piece, clock, time = int(numbers[row.PIECE_NOW]), numbers[row.CLOCK_NOW], segment[layout.START]
    left, want = segment[layout.DURATION], lengths[piece]
    last = lengths.shape[0] - 1
    while True:
        if clock >= lengths[piece] and piece < last:
            piece, clock = piece + 1, 0.0
            want = fitted(want, lengths[piece])
        place = bin_of(watch, time, place)
        set_load(course, piece, clock)
        differentiate(regime, course, 5)
        begin_panel(regime, watch, slot, course, place, time)
        if left <= 0.0:
            return place
        rest = lengths[piece] - clock if piece < last else left
        bound = min(rest, left)
        if place < watch.edges.shape[0] - 2 and watch.edges[place + 1] > time:
            bound = min(bound, watch.edges[place + 1] - time)
        h = min(want, bound)
        grow(regime, course, slot, lengths[piece], h)
        while is_open(regime, course, watch, slot, place, h) and h > SHORTEST * lengths[piece]:
            h, want = 0.5 * h, 0.5 * h
            grow(regime, course, slot, lengths[piece], h)
        settle(regime, watch, slot, course, place, time, h)
        want = max(want, 2.0 * h)
        accept(course)
        time, left = time + h, left - h
        clock = lengths[piece] if h >= rest and piece < last else clock + h


@kernel
def begin_panel(regime: Regime, watch: OutputWatch, slot: int, course: Course, place: int, time: float) -> None:
    """Values and slopes of the outputs at the node."""
    n = course.flow.shape[1]
    for at in range(watch.signals.shape[1]):
        weights = watch.signals[slot, at]
        value = read(weights, course.flow, row.Y) + weights[2 * n] + weights[2 * n + 1] * course.numbers[row.U]
        slope = read(weights, course.flow, row.RATE) + weights[2 * n + 1] * course.numbers[row.U1]
        watch.ends[FIRST, at], watch.ends[FIRST_SLOPE, at] = value, slope
        note_value(watch, at, place, value, time)


@kernel
def is_open(regime: Regime, course: Course, watch: OutputWatch, slot: int, place: int, h: float) -> bool:
    """True where a panel of length h, whose flow is grown, is to be halved."""
    found = False
    for at in range(watch.signals.shape[1]):
        said = settle_output(regime, course, watch, slot, at, place, h)
        watch.ends[SAYS, at] = said
        found = found or said == OPEN
    return found


@kernel
def settle(
    regime: Regime, watch: OutputWatch, slot: int, course: Course, place: int, time: float, h: float
) -> None:  # fmt: skip
    """The extremes over a panel of length h."""
    for at in range(watch.signals.shape[1]):
        note_value(watch, at, place, watch.ends[LAST, at], time + h)
        if watch.ends[SAYS, at] != WITHIN and watch.ends[FIRST_SLOPE, at] * watch.ends[LAST_SLOPE, at] < 0.0:
            turn(regime, course, watch, slot, at, place, time, h)


@kernel
def settle_output(
    regime: Regime, course: Course, watch: OutputWatch, slot: int, at: int, place: int, h: float
) -> int:  # fmt: skip
    """Verdict of a panel on one output, whose values and slopes at the end are set."""
    weights, ends, n, numbers = watch.signals[slot, at], watch.ends, course.flow.shape[1], course.numbers
    growth = read(weights, course.flow, row.GROWTH) + weights[2 * n + 1] * (numbers[row.U_LAST] - numbers[row.U])
    p0, s0 = ends[FIRST, at], ends[FIRST_SLOPE, at]
    p1, s1 = p0 + growth, read(weights, course.flow, row.TRIAL_RATE) + weights[2 * n + 1] * numbers[row.U1_LAST]
    ends[LAST, at], ends[LAST_SLOPE, at] = p1, s1
    m4, b1, b2 = bound_of(regime, weights, course.flow, 0, h), p0 + THIRD * h * s0, p1 - THIRD * h * s1
    off = m4 * h * h * h * h * VALUE
    low, high = min(min(p0, b1), min(b2, p1)) - off, max(max(p0, b1), max(b2, p1)) + off
    found = watch.found[at, place]
    slack = 4.0 * EPSILON * (parts(weights, course.flow, row.Y) + abs(weights[2 * n]))
    if low >= min(found[LEAST], p1) - slack and high <= max(found[GREATEST], p1) + slack:
        return WITHIN
    d, off = 3.0 * (b2 - b1) / h, SLOPE * m4 * h * h * h
    if min(min(s0, d), s1) > off or max(max(s0, d), s1) < -off:
        return SETTLED
    c0, c1, off = 2.0 * (d - s0) / h, 2.0 * (s1 - d) / h, m4 * h * h / 12.0
    return SETTLED if min(c0, c1) > off or max(c0, c1) < -off else OPEN


@kernel
def turn(
    regime: Regime, course: Course, watch: OutputWatch, slot: int, at: int, place: int, time: float, h: float
) -> None:  # fmt: skip
    """The value of an output where its slope changes sign, by Newton's method with the curvature of the cubic."""
    weights, ends = watch.signals[slot, at], watch.ends
    first, down, up = ends[FIRST, at], ends[FIRST_SLOPE, at], ends[LAST_SLOPE, at]
    low, high, steep = 0.0, h, TURNED * max(abs(down), abs(up))
    mean = 3.0 * (ends[LAST, at] - first) / h - down - up  # H' = down + 2 (mean − down) t + (up + down − 2 mean) t²
    bend, tilt = (down + up - 2.0 * mean) / h, mean - down
    where, value = h * down / (down - up), first
    for _ in range(ROUNDS):
        set_functions(regime, course, where)
        growth, slope = growth_of(regime, course, weights, 0, where)
        value = first + where * growth
        if abs(slope) <= steep or high - low <= 1e-9 * h:
            break
        low, high = (where, high) if (slope < 0.0) == (down < 0.0) else (low, where)
        curve = 2.0 * (tilt + bend * where) / h
        where = where - slope / curve if curve != 0.0 else 0.5 * (low + high)
        if not low < where < high:
            where = 0.5 * (low + high)
    note_value(watch, at, place, value, time + where)


@kernel
def read_steps(engine: ContactEngine, watch: OutputWatch, segment: Array, pose: Array, place: int) -> int:
    """Extremes over a segment that is integrated, from its first pose; the last bin."""
    enter_segment(engine, pose, segment)
    status, duration, clock = engine.trial, segment[layout.DURATION], segment[layout.AT_CLOCK]
    h, done, steps = first_step(engine, status), 0.0, 0
    while done < duration and steps < MOST_STEPS:
        h, steps = min(h, duration - done), steps + 1
        wrong = step(engine, status, clock + done, h)
        if wrong > 1.0:
            h = next_step(h, wrong)
            continue
        time = segment[layout.START] + done
        place = bin_of(watch, time, place)
        for at in range(watch.rows.shape[0]):
            read_step(engine, watch, at, place, time, clock + done, h)
        step(engine, status, clock + done, h)
        copy_pose(engine.state[END], engine.state[BEGIN])
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    return place


@kernel
def read_step(
    engine: ContactEngine, watch: OutputWatch, at: int, place: int, time: float, clock: float, h: float
) -> None:  # fmt: skip
    """An output at both ends of the step just made, at its middle, and at the top of the parabola through them."""
    status = engine.trial
    first = output_of(engine, watch, at, BEGIN, clock)
    last = output_of(engine, watch, at, END, clock + h)
    step(engine, status, clock, 0.5 * h)
    middle = output_of(engine, watch, at, END, clock + 0.5 * h)
    note_value(watch, at, place, first, time)
    note_value(watch, at, place, last, time + h)
    note_value(watch, at, place, middle, time + 0.5 * h)
    bend, slope = first - 2.0 * middle + last, last - first
    top = 0.5 - 0.25 * slope / bend if bend != 0.0 else 0.5
    if 0.0 < top < 1.0:
        step(engine, status, clock, top * h)
        note_value(watch, at, place, output_of(engine, watch, at, END, clock + top * h), time + top * h)
    step(engine, status, clock, h)


@kernel
def output_of(engine: ContactEngine, watch: OutputWatch, at: int, state: int, clock: float) -> float:
    """An output at the begin or end of the step just made."""
    n, wanted, value = engine.omega.shape[0], watch.rows[at], 0.0
    order, stage = int(wanted[n]), 0 if state == BEGIN else 12
    for k in range(n):
        part = engine.stages[stage, 1, k] if order == 2 else engine.state[state, order, k]
        value += wanted[k] * part
    if order == 2:
        u, _ = load_at(engine.course, int(engine.trial[contact_row.PIECE]), clock)
        value -= wanted[n + 1] * u
    return value
