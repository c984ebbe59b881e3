"""A signal: constant + harmonic + damped pairs (+ attached pairs), whose first root is the next event.

g(t) = CONST + Im((ZR + i ZI) e^{iΩt}) + Σ x_k(t) + Σ weight X_j(t): the gap in flight, the contact force at rest. The
x_k are what is left of each pair when its steady response is taken out.
"""

from __future__ import annotations

from math import cos, exp, sin
from typing import Any, NamedTuple

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.layout import FORGOTTEN
from vibeam.flight.kernels.roots.pair import increments, norm, phasor_increments, power, propagator
from vibeam.flight.kernels.roots.taylor_pairs import add_derivatives, carry, growth, trial_sum
from vibeam_models.arrays import Array


class EventSignal(NamedTuple):
    """g(t) = const + Im(z e^{iΩt}) + Σ x_k(t) + Σ weight X_j(t): see ``layout`` for the rows."""

    pairs: Array  # x_k: rates, state at start, node, trial end and root
    table: Array  # their propagators over every panel length
    levels: Array  # panel lengths h and e^{iΩh}
    terms: Array  # const, z, Ω; what the last panel showed; derivatives
    attached: Array  # X_j


class Start(NamedTuple):
    """Root with which a signal starts: g ~ rise t^m/m! with m = ``order`` and g^{(m)}(0) = ``rise``; m = 0: none."""

    order: int
    rise: float


@joined
def signal_of(system: Any) -> EventSignal:
    """Signal of the free flight of an Engine, or of a Regime."""
    return EventSignal(system.pairs, system.table, system.levels, system.signal, system.attached)


@joined
def decays(pairs: Array, k: int, x: float, y: float) -> tuple[float, float]:
    """(s, f) of a pair with SLOW > 0: x = s + f, x' = −a s − b f."""
    slow, fast = pairs[layout.SLOW, k], -pairs[layout.TILT, k]
    return (fast * x + y) / (fast - slow), -(slow * x + y) / (fast - slow)


@joined
def decays_at(pairs: Array, k: int, t: float) -> tuple[float, float]:
    """The same at flight time t."""
    s, f = decays(pairs, k, pairs[layout.X0, k], pairs[layout.Y0, k])
    return s * exp(-pairs[layout.SLOW, k] * t), f * exp(pairs[layout.TILT, k] * t)


@joined
def value_at(g: EventSignal, node: float, t: float) -> tuple[float, float, float]:
    """Value, slope and curvature at flight time t; XT, YT and the trial receive the pairs there.

    g = const + Im(z e^{iΩt}) + Σ x_k, x_k = P00 x_k(0) + P01 x_k'(0), x_k'' = −2σx_k' − ω²x_k.
    """
    pairs, _, _, signal, attached = g
    w = signal[layout.DRIVE]
    c, s = cos(w * t), sin(w * t)
    imaginary = signal[layout.ZI] * c + signal[layout.ZR] * s
    value = signal[layout.CONST] + imaginary
    slope = w * (signal[layout.ZR] * c - signal[layout.ZI] * s)
    curvature = -w * w * imaginary
    for k in range(pairs.shape[1]):
        x, y = 0.0, 0.0
        if pairs[layout.SLOW, k] > 0.0:
            s, f = decays_at(pairs, k, t)
            x, y = s + f, pairs[layout.TILT, k] * f - pairs[layout.SLOW, k] * s
            pairs[layout.XT, k], pairs[layout.YT, k] = x, y
            value += x
            slope += y
            curvature += (
                pairs[layout.SLOW, k] * pairs[layout.SLOW, k] * s + pairs[layout.TILT, k] * pairs[layout.TILT, k] * f
            )
            continue
        if pairs[layout.DECAY, k] * t < FORGOTTEN:
            p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], t)
            x = p00 * pairs[layout.X0, k] + p01 * pairs[layout.Y0, k]
            y = p10 * pairs[layout.X0, k] + p11 * pairs[layout.Y0, k]
        pairs[layout.XT, k], pairs[layout.YT, k] = x, y
        value += x
        slope += y
        curvature -= 2.0 * pairs[layout.SIGMA, k] * y + pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k] * x
    if signal[layout.ATTACHED] > 0.0:
        carry(attached, signal, node, t - node)
        more = trial_sum(attached, signal, t)
        return value + more[0], slope + more[1], curvature + more[2]
    return value, slope, curvature


@kernel
def quotient_at(g: EventSignal, start: Start, t: float) -> tuple[float, float, float]:
    """p = g / t^m, its slope and 0 (no curvature at hand) at flight time t > 0; XT, YT and the trial as in value_at.

    From γ = (g − g(0) − tg'(0))/t² and δ = (g' − g'(0))/t, sums of the pairs' own: no digit cancels near t = 0.
    """
    pairs, _, _, signal, attached = g
    e0, e1, r0, r1 = phasor_increments(signal[layout.DRIVE], t)
    gamma = signal[layout.ZR] * e1 + signal[layout.ZI] * e0
    delta = signal[layout.DRIVE] * (signal[layout.ZR] * r0 - signal[layout.ZI] * r1)
    for k in range(pairs.shape[1]):
        d0, d1, v0, v1 = increments(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], t)
        x, y = pairs[layout.X0, k], pairs[layout.Y0, k]
        more_gamma, more_delta = d0 * x + d1 * y, v0 * x + v1 * y
        pairs[layout.XT, k] = x + t * y + t * t * more_gamma
        pairs[layout.YT, k] = y + t * more_delta
        gamma += more_gamma
        delta += more_delta
    if signal[layout.ATTACHED] > 0.0:
        carry(attached, signal, 0.0, t)
        more = growth(attached, signal, t)
        gamma += more[0]
        delta += more[1]
    p, slope = quotient(start, signal[layout.WHOLE + 2], gamma, delta, t)
    return p, slope, 0.0


@joined
def quotient(start: Start, second: float, gamma: float, delta: float, h: float) -> tuple[float, float]:
    """p and p' at t = h of p = g / t^m from g = g'(0) h + γh², g' = g'(0) + δh; ``second`` = g''(0) as computed."""
    order, rise = start
    if order == 1:
        return rise + h * gamma, delta - gamma
    if order == 2:
        return gamma, (delta - 2.0 * gamma) / h
    return (gamma - 0.5 * second) / h, (delta - second - 3.0 * (gamma - 0.5 * second)) / (h * h)


@joined
def derivatives(g: EventSignal, count: int, start: int, depth: int) -> None:
    """terms[start + j] = g^{(j)}(0), j = 0 … depth ≤ 5, of all but the pairs from ``count`` on.

    Im((iΩ)^j z), and x^{(j)} = −2σx^{(j−1)} − ω²x^{(j−2)} pair by pair.
    """
    pairs, _, _, signal, attached = g
    w = signal[layout.DRIVE]
    signal[start] = signal[layout.CONST] + signal[layout.ZI]
    signal[start + 1] = w * signal[layout.ZR]
    signal[start + 2] = -w * w * signal[layout.ZI]
    for j in range(3, depth + 1):
        signal[start + j] = -w * w * signal[start + j - 2]
    for k in range(count):
        damp, spring = 2.0 * pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
        before, now = pairs[layout.X0, k], pairs[layout.Y0, k]
        signal[start] += before
        signal[start + 1] += now
        for j in range(2, depth + 1):
            before, now = now, -damp * now - spring * before
            signal[start + j] += now
    if signal[layout.ATTACHED] > 0.0:
        add_derivatives(attached, signal, start)


@joined
def to_node(pairs: Array) -> float:
    """The node goes to the start; the sum of the e_k ≥ √(x² + (x'/ω)²), which bound |x_k| for all later times."""
    total = 0.0
    for k in range(pairs.shape[1]):
        x, y = pairs[layout.X0, k], pairs[layout.Y0, k]
        if pairs[layout.SLOW, k] > 0.0:
            x, y = decays(pairs, k, x, y)
        set_node(pairs, k, x, y)
        total += pairs[layout.E, k] + pairs[layout.CREEP, k]
    return total


@joined
def set_node(pairs: Array, k: int, x: float, y: float) -> None:
    """Set X, Y and the bounds e and |s|; of two decays e is |f|."""
    pairs[layout.X, k], pairs[layout.Y, k] = x, y
    apart = pairs[layout.JOIN, k] > 0.0
    pairs[layout.E, k] = abs(y) if apart else norm(x, y * pairs[layout.INVERSE, k])
    pairs[layout.CREEP, k] = abs(x) if apart else 0.0


@kernel
def magnitude(pairs: Array, signal: Array, order: int) -> float:
    """Ω^j |z| + Σ κ_k^j e_k + a_k^j |s_k|, j = ``order``: bound of that derivative of g from the node on.

    Attached pairs apart.
    """
    total = signal[layout.HARMONIC] * power(signal[layout.DRIVE], order)
    for k in range(pairs.shape[1]):
        total += pairs[layout.E, k] * power(pairs[layout.KAPPA, k], order) + pairs[layout.CREEP, k] * power(
            pairs[layout.SLOW, k], order
        )
    return float(total)
