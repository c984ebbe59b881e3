"""The first root of a signal, with proof: no interval is left behind on which a bound does not exclude a root.

Panels are walked from left to right. Each is rejected with proof, or found to hold exactly one root or one minimum, or
halved (``bounds.verdict``).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.bounds import CLEAR, MINIMUM, ROOT, SPLIT
from vibeam.flight.kernels.roots.double_gap import InitialState, sharp_gap
from vibeam.flight.kernels.roots.newton import EPSILON, guess, polish, polish_minimum
from vibeam.flight.kernels.roots.pair import level_of, norm, power
from vibeam.flight.kernels.roots.panels import Node, accept, launching, next_node, ordinary, step_pairs
from vibeam.flight.kernels.roots.signal import EventSignal, Start, derivatives, to_node, value_at

MOST_PANELS = 100_000  # a flight takes ten, or a few dozen where modes decay by orders faster than they are driven
GLANCE = 256  # panels after which it is asked whether what is left can reach zero at all
FAINT = 1e-9  # share of the parts of a gap below which its rise is lost in their round-off
AMPLE = 1.25  # first panel over the flight that is foretold, where it matters that the flight ends on it
CANCELLED = 64.0  # parts over |g'| t beyond which a root at t is known to fewer digits than its flight's data
SHALLOW = 1e9  # times round-off: how far from zero a minimum is still judged, and its touch found, sharply


class PanelSpan(NamedTuple):
    """Begin and length of a panel, in flight time."""

    begin: float
    length: float


@kernel
def first_root(
    g: EventSignal, start: Start, span: float, coarsest: int, initial: InitialState
) -> tuple[bool, float, int]:
    """(found, flight time, panels tried) of the first root in (0, span]; there XT, YT and the trial hold the pairs.

    A negative time: it was not isolated within ``MOST_PANELS``. The walk is bisection with the proofs of
    ``bounds.verdict``, then Newton's method. ``start.order`` 0: g starts positive; 1 … 3: it starts with a root of that
    order. ``coarsest``: the level of the longest panel to try. ``initial.clock`` ≥ 0: g is the gap from that state, and
    a minimum that round-off leaves in doubt is judged in twice the precision.
    """
    pairs, table, levels, signal, attached = g
    order, rise = start
    total = to_node(pairs)
    if signal[layout.ATTACHED] > 0.0:
        att.restart(attached, signal)
    re, im = signal[layout.ZR], signal[layout.ZI]
    harmonic = norm(re, im)
    signal[layout.HARMONIC] = harmonic
    size = abs(signal[layout.CONST]) + harmonic + total
    tolerance = 8.0 * EPSILON * size
    if order == 0 and signal[layout.ATTACHED] == 0.0 and signal[layout.CONST] - harmonic - total > tolerance:
        return False, span, 0
    node, level, panels, since, patience, lengthened = Node(0.0, re, im), coarsest, 0, 0, 1, False
    if order > 0:
        derivatives(g, pairs.shape[1], layout.WHOLE, order + 1)
        level = first_level(g, start, coarsest, size)
    while node.time < span:
        panels += 1
        if panels > MOST_PANELS:
            return False, -1.0, panels
        h, time = levels[layout.STEP, level], node.time
        here = Start(order if time == 0.0 else 0, rise)
        if signal[layout.ATTACHED] > 0.0:
            tolerance = (
                8.0 * EPSILON * (size + att.swing(attached, signal, min(time + h, levels[layout.STEP, coarsest])))
            )
        found = launching(g, start, level) if here.order > 0 else ordinary(g, node, level, tolerance)
        if found == SPLIT and level == layout.LEVELS - 1:
            found = ROOT if signal[layout.P1] <= 0.0 else CLEAR
        if found == SPLIT:
            level += 1
            patience = min(2 * patience, 64) if lengthened else patience
            since, lengthened = 0, False
            continue
        bracket = h
        if found == MINIMUM:
            where, value = polish_minimum(g, here, time, h)
            found, bracket = (ROOT, where) if value <= 0.0 else (CLEAR, h)
            shallow = SHALLOW * tolerance if here.order == 0 else SHALLOW * tolerance / power(where, here.order)
            if initial.clock >= 0.0 and value < shallow and signal[layout.ATTACHED] == 0.0:
                touch = graze(g, initial, time, time + where)
                if 0.0 < touch <= span:
                    return True, touch, panels
                found = CLEAR
        if found == ROOT:
            root = polish(g, here, time, time + guess(signal, h, bracket), bracket)
            if here.order == 0 and size > CANCELLED * root * abs(signal[layout.S0]):
                root = sharpened(g, initial, PanelSpan(time, h), root, size)
            return root <= span, min(root, span), panels
        if here.order > 0:
            step_pairs(pairs, table, level)
        if signal[layout.ATTACHED] > 0.0:
            att.carry(attached, signal, time, h)
        accept(g)
        node = next_node(levels, level, node)
        since += 1
        patience = max(1, patience // 2) if lengthened else patience
        lengthened = False
        if level > coarsest and since > patience:
            level -= 1
            since, lengthened = 0, True
        if panels % GLANCE == 0 and is_out_of_reach(g, tolerance):
            break
    return False, span, panels


@kernel
def sharpened(g: EventSignal, initial: InitialState, panel: PanelSpan, root: float, size: float) -> float:
    """``root`` of a gap after one Newton step in twice the precision, where its parts cancel; else as it is.

    Round-off ε ``size`` of the parts moves a root of slope g' by ε ``size``/|g'|, here by 64 last digits and more. A
    step as long as the panel that holds the root would be none of round-off.
    """
    if initial.clock < 0.0 or g.terms[layout.ATTACHED] > 0.0:
        return root
    _, slope, _ = value_at(g, panel.begin, root)
    if size <= CANCELLED * root * abs(slope) or slope >= 0.0:
        return root
    step = sharp_gap(g.pairs, initial, root) / slope
    if abs(step) < panel.length and step < root:
        root -= step
    value_at(g, panel.begin, root)
    return root


@joined
def is_out_of_reach(g: EventSignal, tolerance: float) -> bool:
    """True where const − |z| − Σ (e_k + |s_k|), least that the signal can still be from the node on, is above zero."""
    least = g.terms[layout.CONST] - g.terms[layout.HARMONIC]
    for k in range(g.pairs.shape[1]):
        least -= g.pairs[layout.E, k] + g.pairs[layout.CREEP, k]
    return bool(g.terms[layout.ATTACHED] == 0.0 and least > tolerance)


@joined
def first_level(g: EventSignal, start: Start, coarsest: int, size: float) -> int:
    """The level to start with: twice the flight 2g'(0)/|g''(0)| that the first two derivatives foretell.

    That is a panel of one to two such flights. Damping makes a flight longer, so that now and then it ends just beyond
    the panel: there g is known to round-off of its parts, ``size`` and the attached pairs' swing, not of the flight. A
    flight that rises to no more than 1e-9 of them takes a panel of at least 1¼ flights.
    """
    ahead = g.terms[layout.WHOLE + 2]
    if start.order > 1 or ahead >= 0.0:
        return coarsest
    flight = -2.0 * start.rise / ahead
    level = level_of(g.levels, 2.0 * flight)
    if g.terms[layout.ATTACHED] > 0.0:
        size += att.swing(g.attached, g.terms, min(flight, g.levels[layout.STEP, coarsest]))
    if start.rise * flight < FAINT * size and g.levels[layout.STEP, level] < AMPLE * flight:
        level -= 1
    return max(coarsest, level)


@kernel
def graze(g: EventSignal, initial: InitialState, node: float, where: float) -> float:
    """The flight time at which a gap with its minimum near ``where`` touches the stop, or −1 where it does not.

    The depth d below the stop comes from ``sharp_gap``; with curvature a it is struck √(2d/a) before the minimum.
    """
    pairs = g.pairs
    t = where
    for _ in range(3):
        _, slope, curvature = value_at(g, node, t)
        if curvature <= 0.0:
            return -1.0
        t -= slope / curvature
    depth = -sharp_gap(pairs, initial, t)
    if depth < 0.0:
        return -1.0
    touch = t - sqrt(2.0 * depth / curvature)
    for _ in range(4 if depth > 0.0 else 0):
        _, slope, _ = value_at(g, node, touch)
        touch -= sharp_gap(pairs, initial, touch) / slope
    value_at(g, node, touch)
    return float(touch)
