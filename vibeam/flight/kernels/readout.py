"""Readout of a steady point's flights and rests: extremes of signals over a span, and the modes' energies."""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_energy import energy_in_blocks
from vibeam.flight.kernels.block_flow import set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.energy import energy_in_flight
from vibeam.flight.kernels.layout import Engine, Watch
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import PanelEnds
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.roots.panels import Node, accept, measure, next_node
from vibeam.flight.kernels.roots.signal import EventSignal, signal_of, to_node, value_at
from vibeam_models.arrays import Array

ACCURACY = 1e-11  # share of the size of the signal's parts
LIGHTLY = 1e-6  # and where not everything is read off
FINE = 1e-2  # share of that which Newton's last step may be off
ROUNDS = 60
MOST_WORK = 50_000_000  # panels, times modes and a few, then a span is given up: a mode rings too fast beside it
GLANCE = 1024  # panels after which it is asked whether what is left can reach beyond what is known at all
EPSILON = 2.220446049250313e-16


@kernel
def extremes(g: EventSignal, span: float, coarsest: int, least: float, most: float) -> tuple[float, float]:
    """(least, most) widened to the signal's values over [0, span]."""
    return extremes_to(g, span, coarsest, least, most, ACCURACY)


@kernel
def extremes_to(
    g: EventSignal, span: float, coarsest: int, least: float, most: float, share: float
) -> tuple[float, float]:
    """(least, most) widened to the signal's values over [0, span], to a ``share`` of the size of its parts.

    A panel whose hull, widened by M₄h⁴/384 + slack (``roots.bounds``), stays within what is known is passed over; where
    g is proved convex or concave its turning point is found by Newton's method. (−∞, ∞) where that takes more than
    ``MOST_WORK``.
    """
    pairs, _, levels, signal, attached = g
    total = to_node(pairs)
    att.restart(attached, signal)
    re, im = signal[layout.ZR], signal[layout.ZI]
    signal[layout.HARMONIC] = norm(re, im)
    accuracy = share * (abs(signal[layout.CONST]) + signal[layout.HARMONIC] + total + att.swing(attached, signal, span))
    node, level, panels = Node(0.0, re, im), coarsest, 0
    while panels < MOST_WORK // (pairs.shape[1] + 8):
        panels += 1
        h, time = levels[layout.STEP, level], node.time
        part, bounds, rest = measure(g, node, level)
        if time == 0.0:
            least, most = min(least, part.p0 + rest.p0), max(most, part.p0 + rest.p0)
        if time >= span:
            return least, most
        error = bounds.fourth * h * h * h * h / 384.0 + bounds.value
        low, high = hull(part, h)
        if low - error < least or high + error > most:
            last = min(span - time, h)
            if error > accuracy and level < layout.LEVELS - 1:
                bend = bent(part, h, bounds.fourth * h * h / 12.0 + bounds.curvature)
                if bend == 0.0:
                    level += 1
                    continue
                low, high = turning(g, time, part.s0 + rest.s0, last, bend, accuracy)
            else:
                low, high = cubic_range(together(part, rest), h, last)
            least, most = min(least, low), max(most, high)
        if signal[layout.ATTACHED] > 0.0:
            att.carry(attached, signal, time, h)
        accept(g)
        node = next_node(levels, level, node)
        level = max(level - 1, coarsest)
        if panels % GLANCE == 0 and contained(pairs, signal, least - accuracy, most + accuracy):
            return least, most
    return -np.inf, np.inf


@kernel
def contained(pairs: Array, signal: Array, least: float, most: float) -> bool:
    """True where const ± (|z| + Σ e_k + |s_k|), and with it the signal from the node on, stays within [least, most]."""
    reach = hypot(signal[layout.ZR], signal[layout.ZI])
    for k in range(pairs.shape[1]):
        reach += pairs[layout.E, k] + pairs[layout.CREEP, k]
    low, high = signal[layout.CONST] - reach, signal[layout.CONST] + reach
    return bool(signal[layout.ATTACHED] == 0.0 and low >= least and high <= most)


@joined
def together(part: PanelEnds, rest: PanelEnds) -> PanelEnds:
    """The whole signal at both ends: what is interpolated and what is not."""
    return PanelEnds(part.p0 + rest.p0, part.s0 + rest.s0, part.p1 + rest.p1, part.s1 + rest.s1)


@kernel
def hull(ends: PanelEnds, h: float) -> tuple[float, float]:
    """Least and greatest of the Bernstein coefficients p₀, p₀ + hs₀/3, p₁ − hs₁/3, p₁ of the Hermite interpolant."""
    p0, s0, p1, s1 = ends
    b1, b2 = p0 + h * s0 / 3.0, p1 - h * s1 / 3.0
    return min(min(p0, b1), min(b2, p1)), max(max(p0, b1), max(b2, p1))


@kernel
def bent(ends: PanelEnds, h: float, error: float) -> float:
    """1 where the signal is proved convex on the panel, −1 where concave, 0 where neither is.

    The interpolant's curvature lies between 2(d − s₀)/h and 2(s₁ − d)/h, d = 3(p₁ − p₀)/h − s₀ − s₁; ``error`` bounds
    what it misses.
    """
    p0, s0, p1, s1 = ends
    middle = 3.0 * (p1 - p0) / h - s0 - s1  # the interpolant's slope in the middle of its hull
    left, right = 2.0 * (middle - s0) / h, 2.0 * (s1 - middle) / h
    if min(left, right) > error:
        return 1.0
    return -1.0 if max(left, right) < -error else 0.0


@kernel
def turning(
    g: EventSignal, node: float, slope: float, last: float, bend: float, accuracy: float
) -> tuple[float, float]:
    """Least and greatest value on (node, node + last], convex (bend 1) or concave (−1) there; ``slope`` at the node.

    The root of g' by Newton's method in a bracket.
    """
    end, down, _ = value_at(g, node, node + last)
    low, high = end, end
    if bend * slope >= 0.0 or bend * down <= 0.0:
        return low, high
    left, right, t = 0.0, last, last * slope / (slope - down)
    for _ in range(ROUNDS):
        value, rate, curvature = value_at(g, node, node + t)
        low, high = min(low, value), max(high, value)
        if rate * rate <= abs(curvature) * FINE * accuracy or right - left <= EPSILON * (node + t):
            break
        if bend * rate < 0.0:
            left = t
        else:
            right = t
        t = t - rate / curvature if bend * curvature > 0.0 else 0.5 * (left + right)
        if not left < t < right:
            t = 0.5 * (left + right)
    return low, high


@kernel
def cubic_range(ends: PanelEnds, h: float, end: float) -> tuple[float, float]:
    """Least and greatest value on [0, end], end ≤ h, of the cubic Hermite interpolant.

    p₀ + u(c₁ + u(c₂ + uc₃)) with u = t/h, at its ends and at the roots of c₁ + 2c₂u + 3c₃u².
    """
    p0, s0, p1, s1 = ends
    c1, c2 = h * s0, 3.0 * (p1 - p0) - h * (2.0 * s0 + s1)
    c3 = 2.0 * (p0 - p1) + h * (s0 + s1)
    last = end / h
    value = p0 + last * (c1 + last * (c2 + last * c3))
    low, high = min(p0, value), max(p0, value)
    root = c2 * c2 - 3.0 * c1 * c3
    if root >= 0.0:
        middle = -(c2 + (sqrt(root) if c2 >= 0.0 else -sqrt(root)))
        for i in range(2):
            top, bottom = (middle, 3.0 * c3) if i == 0 else (c1, middle)
            u = top / bottom if bottom != 0.0 else -1.0
            if 0.0 < u < last:
                value = p0 + u * (c1 + u * (c2 + u * c3))
                low, high = min(low, value), max(high, value)
    return low, high


@joined
def widen_output(g: EventSignal, duration: float, coarsest: int, result: Array, share: float) -> None:
    """Widen the extremes of the output in ``result`` by the signal that it is over a segment."""
    least, high = extremes_to(g, duration, coarsest, result[layout.LEAST], result[layout.HIGH], share)
    result[layout.LEAST], result[layout.HIGH] = least, high


@kernel
def begin_output(engine: Engine, row: Array, pose: Array, clock: float) -> None:
    """row·η in flight as the free signal; the attached pairs must be those of this flight (``begin_flight``)."""
    pairs, modes, signal, attached = engine.pairs, engine.modes, engine.signal, engine.attached
    cosine, sine = phase(engine.drive, clock)
    w = engine.drive[layout.W]
    const, re, im = 0.0, 0.0, 0.0
    for k in range(pairs.shape[1]):
        const += row[k] * modes[layout.OFFSET, k]
        re += row[k] * modes[layout.RE, k]
        im += row[k] * modes[layout.IM, k]
        own = modes[layout.OFFSET, k] + modes[layout.RE, k] * sine + modes[layout.IM, k] * cosine
        pairs[layout.X0, k] = row[k] * (pose[0, k] - own)
        pairs[layout.Y0, k] = row[k] * (pose[1, k] - w * (modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine))
    for j in range(int(signal[layout.ATTACHED])):
        k = int(attached[layout.AMODE, j])
        attached[layout.AX, j], attached[layout.AY, j], attached[layout.AWEIGHT, j] = pose[0, k], pose[1, k], row[k]
        pairs[layout.X0, k], pairs[layout.Y0, k] = 0.0, 0.0
    signal[layout.CONST], signal[layout.DRIVE], signal[layout.COSINE], signal[layout.SINE] = const, w, cosine, sine
    signal[layout.ZR], signal[layout.ZI] = re * cosine - im * sine, re * sine + im * cosine


@kernel
def read_segment(engine: Engine, watch: Watch, i: int) -> None:
    """Read off the i-th segment just traced, from its first pose in ``watch.frame``."""
    clock, duration = watch.trace[i, layout.AT_CLOCK], watch.trace[i, layout.DURATION]
    share = ACCURACY if watch.reading >= layout.EVERYTHING else LIGHTLY
    if watch.trace[i, layout.WHAT] == layout.RESTING:
        watch.result[layout.CONTACT_LEAST] = min(watch.result[layout.CONTACT_LEAST], engine.drive[layout.GAP])
        read_rest(engine, watch, watch.frame, clock, duration, int(engine.drive[layout.COARSEST_AT_REST]), share)
    else:
        read_flight(engine, watch, watch.frame, clock, duration, int(engine.drive[layout.COARSEST]), share)


@kernel
def read_rest(
    engine: Engine, watch: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, the modes' energies, over one rest."""
    rest, result = engine.rest, watch.result
    to_block_coordinates(rest, engine.drive, pose, clock)
    set_signal(rest, engine.drive, layout.OUTPUT_SIGNAL, 1.0, clock)
    widen_output(signal_of(rest), duration, coarsest, result, share)
    if watch.reading >= layout.EVERYTHING:
        energy_in_blocks(rest, engine.drive, engine.pairs[layout.OMEGA], clock, duration, watch)


@kernel
def read_flight(
    engine: Engine, watch: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, of the gap, and the modes' energies, over one flight."""
    result = watch.result
    cosine, sine = phase(engine.drive, clock)
    begin_flight(engine, pose, cosine, sine)
    if watch.reading >= layout.EVERYTHING:
        energy_in_flight(engine, pose, clock, duration, watch.energy)
    if watch.reading >= layout.REACH_TOO:
        _, widest = extremes_to(
            signal_of(engine), duration, coarsest, 0.0, engine.drive[layout.GAP] - result[layout.CONTACT_LEAST], share
        )
        result[layout.CONTACT_LEAST] = engine.drive[layout.GAP] - widest
    begin_output(engine, watch.row, pose, clock)
    widen_output(signal_of(engine), duration, coarsest, result, share)
