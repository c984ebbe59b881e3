"""Extremes of outputs over a motion under a load, bin by bin, to round-off.

A panel on which an output's hull stays within what its bin has seen is passed by; one on which its slope has one sign,
or its curvature, is settled by its ends and its one turn; any other is halved. In a contact that is integrated the
steps' ends count, and the tops of the cubics between them, where the step is made anew.

**Round-off.** An output r·y + c + s u is known to

    T = 4ε (Σ |r_i| (|y_i| + |A_i y| / ω) + |c| + |s u|),      |A_i y|: the sizes of the parts of y_i', added up,

for a block's rate y' = A y + c + l u, whose parts cancel where it is at rest, is known to ε of them, and the block
remembers that for 1/ω (without stiffness for the piece). Signs of slopes and curvatures that are less than what T makes
of them say nothing. So a panel is not halved where its cubic Hermite interpolant misses the output by M₄h⁴/384 ≤ T: the
cubic's turns are then the output's. M₄ ≤ Σ|r|κ⁴|y| and T ≥ 4ε Σ|r||y| make that κh ≥ (1536 ε)^¼ = 8e-4 at the latest:
halving ends, whatever the signs.
"""

from __future__ import annotations

from math import sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts import layout as contact_row
from vibeam.flight.kernels.contacts.course import Course, OutputWatch
from vibeam.flight.kernels.contacts.integrated import enter_segment
from vibeam.flight.kernels.contacts.integration import first_step, step, take
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.flow import accept, differentiate, fitted, grow, set_load
from vibeam.flight.kernels.contacts.load.panel import bound_of, growth_of, parts, read, set_functions
from vibeam.flight.kernels.contacts.load.poses import enter_loaded
from vibeam.flight.kernels.contacts.load_value import load_at
from vibeam.flight.kernels.contacts.sets import key_of, regime_of, slot_of
from vibeam.flight.kernels.events import PIECE
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.readout import MOST_WORK
from vibeam.flight.kernels.regimes.contact_integration import BEGIN, END, MOST_STEPS, next_step
from vibeam.flight.kernels.roots.bounds import SLOPE, THIRD, VALUE
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam_models.arrays import Array

LEAST, LEAST_TIME, GREATEST, GREATEST_TIME = range(4)  # of ``found``
FIRST, FIRST_SLOPE, LAST, LAST_SLOPE, SAYS, UNSURE = range(6)  # of ``ends``
WITHIN, SETTLED, CUBIC, OPEN = range(4)  # what a panel says of an output
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
def read_flow(engine: ContactEngine, watch: OutputWatch, segment: Array, pose: Array) -> int:
    """Extremes over a segment that is closed form, from its first pose.

    COMPLETE; PAUSED, and it goes on when called again; UNRESOLVED where it takes more than ``MOST_WORK``.
    """
    course, walk, n = engine.course, watch.walk, engine.omega.shape[0]
    if walk[row.ENTERED] == 0.0:
        begin_flow(engine, watch, segment, pose)
    slot = slot_of(engine, key_of(engine, segment[contact_row.HELD_AT], segment[contact_row.PUSHED_AT]))
    regime, piece = regime_of(engine, slot), PIECE // ((n + 8) * (2 + watch.rows.shape[0]))
    while walk[row.PANELS] < MOST_WORK // (n + 8):
        begin_panel(regime, watch, slot, course)
        if walk[row.LEFT] <= 0.0:
            walk[row.ENTERED] = 0.0
            return layout.COMPLETE
        if walk[row.WORK] >= piece:
            return layout.PAUSED
        read_panel(regime, watch, slot, course)
    return layout.UNRESOLVED


@kernel
def begin_flow(engine: ContactEngine, watch: OutputWatch, segment: Array, pose: Array) -> None:
    """The walk at the start of a segment."""
    enter_loaded(engine, pose, segment)
    walk = watch.walk
    walk[row.TIME], walk[row.LEFT] = segment[layout.START], segment[layout.DURATION]
    walk[row.WANT] = engine.course.lengths[int(engine.course.numbers[row.PIECE_NOW])]
    walk[row.PANELS], walk[row.ENTERED] = 0.0, 1.0


@kernel
def begin_panel(regime: Regime, watch: OutputWatch, slot: int, course: Course) -> None:
    """The node: its piece and bin, the load there; values of the outputs, their slopes, and what is unsure of them."""
    walk, numbers, n = watch.walk, course.numbers, course.flow.shape[1]
    piece = int(numbers[row.PIECE_NOW])
    if numbers[row.CLOCK_NOW] >= course.lengths[piece] and piece + 1 < course.lengths.shape[0]:
        piece += 1
        numbers[row.PIECE_NOW], numbers[row.CLOCK_NOW] = piece, 0.0
        walk[row.WANT] = fitted(walk[row.WANT], course.lengths[piece])
    place = bin_of(watch, walk[row.TIME], int(walk[row.PLACE]))
    walk[row.PLACE] = place
    set_load(course, piece, numbers[row.CLOCK_NOW])
    differentiate(regime, course, 5)
    set_noise(regime, course, course.lengths[piece])
    for at in range(watch.signals.shape[1]):
        weights, u = watch.signals[slot, at], numbers[row.U]
        value = read(weights, course.flow, row.Y) + weights[2 * n] + weights[2 * n + 1] * u
        slope = read(weights, course.flow, row.RATE) + weights[2 * n + 1] * numbers[row.U1]
        watch.ends[FIRST, at], watch.ends[FIRST_SLOPE, at] = value, slope
        noise = parts(weights, course.flow, row.NOISE) + abs(weights[2 * n]) + abs(weights[2 * n + 1] * u)
        watch.ends[UNSURE, at] = 4.0 * EPSILON * noise
        note_value(watch, at, place, value, walk[row.TIME])


@kernel
def set_noise(regime: Regime, course: Course, length: float) -> None:
    """flow[NOISE]: |y_i| + |A_i y| / ω of every block at the node, which ε of is round-off."""
    b, flow, u = regime.blocks, course.flow, abs(course.numbers[row.U])
    for k in range(b.shape[1]):
        inverse = regime.pairs[layout.INVERSE, k]
        time = inverse if inverse > 0.0 else length
        y1, y2 = abs(flow[row.Y, k]), abs(flow[row.Y + 1, k])
        first = abs(b[layout.A11, k]) * y1 + abs(b[layout.A12, k]) * y2 + abs(b[layout.LOAD1, k]) * u
        second = abs(b[layout.A21, k]) * y1 + abs(b[layout.A22, k]) * y2 + abs(b[layout.LOAD2, k]) * u
        flow[row.NOISE, k] = y1 + time * (first + abs(b[layout.CONSTANT1, k]))
        flow[row.NOISE + 1, k] = y2 + time * (second + abs(b[layout.CONSTANT2, k]))


@kernel
def read_panel(regime: Regime, watch: OutputWatch, slot: int, course: Course) -> None:
    """Extremes over the longest panel from the node on that says enough of all outputs; the node goes to its end."""
    walk, numbers, edges = watch.walk, course.numbers, watch.edges
    piece, place, time = int(numbers[row.PIECE_NOW]), int(walk[row.PLACE]), walk[row.TIME]
    length, last = course.lengths[piece], piece + 1 >= course.lengths.shape[0]
    rest = walk[row.LEFT] if last else length - numbers[row.CLOCK_NOW]
    h = min(walk[row.WANT], min(rest, walk[row.LEFT]))
    if place < edges.shape[0] - 2 and edges[place + 1] > time:
        h = min(h, edges[place + 1] - time)
    while is_open(regime, course, watch, slot, h) and h > SHORTEST * length:
        h *= 0.5
        walk[row.WANT] = h
    settle(regime, watch, slot, course, h)
    walk[row.WANT] = max(walk[row.WANT], 2.0 * h)
    accept(course)
    walk[row.TIME], walk[row.LEFT] = time + h, walk[row.LEFT] - h
    numbers[row.CLOCK_NOW] = length if h >= rest and not last else numbers[row.CLOCK_NOW] + h


@kernel
def is_open(regime: Regime, course: Course, watch: OutputWatch, slot: int, h: float) -> bool:
    """True where a panel of length h, to whose end the flow is grown, is to be halved."""
    found = False
    grow(regime, course, slot, course.lengths[int(course.numbers[row.PIECE_NOW])], h)
    watch.walk[row.PANELS] += 1.0
    watch.walk[row.WORK] += 1.0
    for at in range(watch.signals.shape[1]):
        said = settle_output(regime, course, watch, slot, at, h)
        watch.ends[SAYS, at] = said
        found = found or said == OPEN
    return found


@kernel
def settle(regime: Regime, watch: OutputWatch, slot: int, course: Course, h: float) -> None:
    """The extremes over a panel of length h."""
    place, time, ends = int(watch.walk[row.PLACE]), watch.walk[row.TIME], watch.ends
    for at in range(watch.signals.shape[1]):
        note_value(watch, at, place, ends[LAST, at], time + h)
        if ends[SAYS, at] == SETTLED and ends[FIRST_SLOPE, at] * ends[LAST_SLOPE, at] < 0.0:
            turn(regime, course, watch, slot, at, h)
        elif ends[SAYS, at] >= CUBIC:
            turns_of_cubic(watch, at, h)


@kernel
def settle_output(regime: Regime, course: Course, watch: OutputWatch, slot: int, at: int, h: float) -> int:
    """Verdict of a panel on one output, whose values and slopes at the end are set."""
    weights, ends, n, numbers = watch.signals[slot, at], watch.ends, course.flow.shape[1], course.numbers
    growth = read(weights, course.flow, row.GROWTH) + weights[2 * n + 1] * (numbers[row.U_LAST] - numbers[row.U])
    p0, s0 = ends[FIRST, at], ends[FIRST_SLOPE, at]
    p1, s1 = p0 + growth, read(weights, course.flow, row.TRIAL_RATE) + weights[2 * n + 1] * numbers[row.U1_LAST]
    ends[LAST, at], ends[LAST_SLOPE, at] = p1, s1
    m4, b1, b2 = bound_of(regime, weights, course.flow, 0, h), p0 + THIRD * h * s0, p1 - THIRD * h * s1
    missed, unsure, found = m4 * h * h * h * h * VALUE, ends[UNSURE, at], watch.found[at, int(watch.walk[row.PLACE])]
    low, high = min(min(p0, b1), min(b2, p1)) - missed, max(max(p0, b1), max(b2, p1)) + missed
    if low >= min(found[LEAST], p1) - unsure and high <= max(found[GREATEST], p1) + unsure:
        return WITHIN
    d, off = 3.0 * (b2 - b1) / h, SLOPE * m4 * h * h * h
    if min(min(s0, d), s1) > off or max(max(s0, d), s1) < -off:
        return SETTLED
    c0, c1, off = 2.0 * (d - s0) / h, 2.0 * (s1 - d) / h, m4 * h * h / 12.0
    if min(c0, c1) > off or max(c0, c1) < -off:
        return SETTLED
    return OPEN if missed > unsure else CUBIC


@kernel
def turns_of_cubic(watch: OutputWatch, at: int, h: float) -> None:
    """The values where the slope of the panel's cubic, s₀ + 2bu + au² with u = t/h, vanishes."""
    ends, place, time = watch.ends, int(watch.walk[row.PLACE]), watch.walk[row.TIME]
    first, down, up = ends[FIRST, at], ends[FIRST_SLOPE, at], ends[LAST_SLOPE, at]
    b = 3.0 * (ends[LAST, at] - first) / h - 2.0 * down - up
    a = up - down - 2.0 * b
    if b * b < a * down:
        return
    root = sqrt(b * b - a * down)
    middle = -b - root if b >= 0.0 else root - b
    for i in range(2):
        top, bottom = (middle, a) if i == 0 else (down, middle)
        u = top / bottom if bottom != 0.0 else -1.0
        if 0.0 < u < 1.0:
            note_value(watch, at, place, first + h * u * (down + u * (b + u * a / 3.0)), time + u * h)


@kernel
def turn(regime: Regime, course: Course, watch: OutputWatch, slot: int, at: int, h: float) -> None:
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
    note_value(watch, at, int(watch.walk[row.PLACE]), value, watch.walk[row.TIME] + where)


@kernel
def read_steps(engine: ContactEngine, watch: OutputWatch, segment: Array, pose: Array) -> int:
    """Extremes over a segment that is integrated, from its first pose; UNRESOLVED after ``MOST_STEPS``."""
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
        place = bin_of(watch, time, int(watch.walk[row.PLACE]))
        watch.walk[row.PLACE] = place
        for at in range(watch.rows.shape[0]):
            read_step(engine, watch, at, place, time, clock + done, h)
        step(engine, status, clock + done, h)
        take(engine)
        done = done + h if h < duration - done else duration
        h = next_step(h, wrong)
    watch.walk[row.WORK] += 2.0 * (1.0 + watch.rows.shape[0]) * steps
    return layout.UNRESOLVED if done < duration else layout.COMPLETE


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
