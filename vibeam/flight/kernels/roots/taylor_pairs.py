"""Attached pairs: those without a usable steady response carry their force along.

A mode that is free (ω = 0), nearly so under a static force, or driven at its undamped resonance has a steady response
that is infinite or so large that taking it out would lose digits. Its own equation
X'' + 2σX' + ω²X = F sin φ + G cos φ + s is then solved by Taylor series, panel by panel, to round-off.
"""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam_models.arrays import Array


@kernel
def series(attached: Array, j: int, x: float, y: float, cosine: float, sine: float, drive: float, h: float) -> None:
    """Set rows TERM + i, i < SERIES, to X_i = X^{(i)} h^i/i! of pair j from (x, y) at drive phase (cosine, sine).

    (i + 1)(i + 2) X_{i+2} = h² u_i − 2σh (i + 1) X_{i+1} − ω²h² X_i, u_i the terms of F sin φ + G cos φ + s.
    """
    damp, spring, turn = 2.0 * attached[layout.ASIGMA, j] * h, (attached[layout.AOMEGA, j] * h) ** 2, drive * h
    pull, draw = sine, cosine  # Taylor terms of sin φ and cos φ
    attached[layout.TERM, j] = x
    attached[layout.TERM + 1, j] = y * h
    for i in range(layout.SERIES - 2):
        push = (
            attached[layout.ASINE, j] * pull
            + attached[layout.ACOSINE, j] * draw
            + (attached[layout.ASTATIC, j] if i == 0 else 0.0)
        )
        attached[layout.TERM + i + 2, j] = (
            h * h * push - damp * (i + 1) * attached[layout.TERM + i + 1, j] - spring * attached[layout.TERM + i, j]
        ) / ((i + 1) * (i + 2))
        pull, draw = turn * draw / (i + 1), -turn * pull / (i + 1)


@kernel
def force_of(attached: Array, j: int) -> float:
    """Bound of the harmonic force on pair j."""
    return float(abs(attached[layout.ASINE, j]) + abs(attached[layout.ACOSINE, j]))


@kernel
def phase_after(signal: Array, time: float) -> tuple[float, float]:
    """cos and sin of the drive's phase φ + Ωt at a flight time t."""
    c, s = cos(signal[layout.DRIVE] * time), sin(signal[layout.DRIVE] * time)
    return signal[layout.COSINE] * c - signal[layout.SINE] * s, signal[layout.SINE] * c + signal[layout.COSINE] * s


@kernel
def fastest(attached: Array, signal: Array) -> float:
    """The fastest rate among the attached pairs and what drives them."""
    rate = 0.0
    for j in range(int(signal[layout.ATTACHED])):
        rate = max(rate, max(2.0 * attached[layout.ASIGMA, j], attached[layout.AOMEGA, j]))
        if force_of(attached, j) != 0.0:
            rate = max(rate, signal[layout.DRIVE])
    return rate


@kernel
def carry(attached: Array, signal: Array, node: float, t: float) -> None:
    """Trial = node carried on by t; ``node`` is the node's flight time."""
    pieces = max(1, int(np.ceil(fastest(attached, signal) * t)))
    h = t / pieces
    for j in range(int(signal[layout.ATTACHED])):
        x, y = attached[layout.NODE_X, j], attached[layout.NODE_Y, j]
        for piece in range(pieces if t > 0.0 else 0):
            cosine, sine = phase_after(signal, node + piece * h)
            series(attached, j, x, y, cosine, sine, signal[layout.DRIVE], h)
            x, y = 0.0, 0.0
            for i in range(layout.SERIES - 1, 0, -1):
                x += attached[layout.TERM + i, j]
                y += i * attached[layout.TERM + i, j]
            x, y = x + attached[layout.TERM, j], y / h
        attached[layout.TRIAL_X, j], attached[layout.TRIAL_Y, j] = x, y


@kernel
def growth(attached: Array, signal: Array, t: float) -> tuple[float, float]:
    """Weighted γ and δ: X = X(0) + t X'(0) + t² γ, X' = X'(0) + t δ, for rate · t up to about 1.2."""
    gamma, delta = 0.0, 0.0
    for j in range(int(signal[layout.ATTACHED])):
        x, y, w = attached[layout.AX, j], attached[layout.AY, j], signal[layout.DRIVE]
        series(attached, j, x, y, signal[layout.COSINE], signal[layout.SINE], w, t)
        for i in range(layout.SERIES - 1, 1, -1):
            gamma += attached[layout.AWEIGHT, j] * attached[layout.TERM + i, j]
            delta += attached[layout.AWEIGHT, j] * i * attached[layout.TERM + i, j]
    return gamma / (t * t), delta / (t * t)


@kernel
def add_derivatives(attached: Array, signal: Array, start: int) -> None:
    """Add derivatives 0 … 5 at the start of the flight to terms[start:start + 6]: Σ weight X^{(j)}(0)."""
    for j in range(int(signal[layout.ATTACHED])):
        x, y, w = attached[layout.AX, j], attached[layout.AY, j], signal[layout.DRIVE]
        series(attached, j, x, y, signal[layout.COSINE], signal[layout.SINE], w, 1.0)
        factorial = 1.0
        for i in range(6):
            factorial *= max(i, 1)
            signal[start + i] += attached[layout.AWEIGHT, j] * attached[layout.TERM + i, j] * factorial


@kernel
def bound(attached: Array, signal: Array, time: float, order: int, h: float) -> float:
    """Bound of |Σ weight X^{(order)}| over the next h from the node at flight ``time``.

    Z = X^{(order)} obeys the same equation under F Ω^order, whose energy norm grows at most by the force:
    |Z(t)| ≤ |Z(0)| + h (√(Z'² + ω²Z²) + h |F| Ω^order).
    """
    total = 0.0
    if int(signal[layout.ATTACHED]) == 0:
        return total
    cosine, sine = phase_after(signal, time)
    for j in range(int(signal[layout.ATTACHED])):
        series(
            attached, j, attached[layout.NODE_X, j], attached[layout.NODE_Y, j], cosine, sine, signal[layout.DRIVE], h
        )
        factorial = 1.0
        for i in range(2, order + 1):
            factorial *= i
        z = abs(attached[layout.TERM + order, j]) * factorial / h**order
        slope = abs(attached[layout.TERM + order + 1, j]) * factorial * (order + 1) / h ** (order + 1)
        push = h * force_of(attached, j) * signal[layout.DRIVE] ** order
        total += abs(attached[layout.AWEIGHT, j]) * (z + h * (hypot(slope, attached[layout.AOMEGA, j] * z) + push))
    return total


@kernel
def trial_sum(attached: Array, signal: Array, t: float) -> tuple[float, float, float]:
    """Weighted value, slope and curvature of the trial at flight time t."""
    value, slope, curvature = 0.0, 0.0, 0.0
    if int(signal[layout.ATTACHED]) > 0:
        cosine, sine = phase_after(signal, t)
        for j in range(int(signal[layout.ATTACHED])):
            x, y, weight = attached[layout.TRIAL_X, j], attached[layout.TRIAL_Y, j], attached[layout.AWEIGHT, j]
            push = attached[layout.ASINE, j] * sine + attached[layout.ACOSINE, j] * cosine + attached[layout.ASTATIC, j]
            own = attached[layout.AOMEGA, j]
            value += weight * x
            slope += weight * y
            curvature += weight * (push - 2.0 * attached[layout.ASIGMA, j] * y - own * own * x)
    return value, slope, curvature


@kernel
def restart(attached: Array, signal: Array) -> None:
    """The node goes back to the start of the flight."""
    for j in range(int(signal[layout.ATTACHED])):
        attached[layout.NODE_X, j], attached[layout.NODE_Y, j] = attached[layout.AX, j], attached[layout.AY, j]


@kernel
def accept(attached: Array, signal: Array) -> None:
    """The trial becomes the node."""
    for j in range(int(signal[layout.ATTACHED])):
        attached[layout.NODE_X, j] = attached[layout.TRIAL_X, j]
        attached[layout.NODE_Y, j] = attached[layout.TRIAL_Y, j]


@kernel
def swing(attached: Array, signal: Array, span: float) -> float:
    """Size of the attached pairs' part over a flight of ``span``: |x| + t|y| + t²(|F| + |s|), weighted."""
    total = 0.0
    for j in range(int(signal[layout.ATTACHED])):
        push = force_of(attached, j) + abs(attached[layout.ASTATIC, j])
        total += abs(attached[layout.AWEIGHT, j]) * (
            abs(attached[layout.AX, j]) + span * (abs(attached[layout.AY, j]) + span * push)
        )
    return total


@kernel
def jerk_bound(attached: Array, signal: Array) -> float:
    """Bound of the attached pairs' part in g'''."""
    total = 0.0
    for j in range(int(signal[layout.ATTACHED])):
        rate = max(2.0 * attached[layout.ASIGMA, j], attached[layout.AOMEGA, j])
        push = force_of(attached, j) * (signal[layout.DRIVE] + rate) + abs(attached[layout.ASTATIC, j]) * rate
        motion = rate * rate * abs(attached[layout.AY, j]) + rate**3 * abs(attached[layout.AX, j])
        total += abs(attached[layout.AWEIGHT, j]) * (push + motion)
    return total
