"""Attached pairs: those without a usable steady response carry their force along.

A mode that is free (ω = 0), nearly so under a static force, or driven at its undamped resonance has a steady response
that is infinite or so large that taking it out would lose digits. Its own equation
X'' + 2σX' + ω²X = F sin φ + G cos φ + s is then solved by Taylor series, panel by panel, to round-off.
"""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.layout import (
    ACOSINE,
    AOMEGA,
    ASIGMA,
    ASINE,
    ASTATIC,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    COSINE,
    DRIVE,
    NODE_X,
    NODE_Y,
    SERIES,
    SINE,
    TERM,
    TRIAL_X,
    TRIAL_Y,
)

Array = NDArray[np.float64]


@kernel
def series(attached: Array, j: int, x: float, y: float, cosine: float, sine: float, drive: float, h: float) -> None:
    """Set rows TERM + i, i < SERIES, to X_i = X^{(i)} h^i/i! of pair j from (x, y) at drive phase (cosine, sine).

    (i + 1)(i + 2) X_{i+2} = h² u_i − 2σh (i + 1) X_{i+1} − ω²h² X_i, u_i the terms of F sin φ + G cos φ + s.
    """
    damp, spring, turn = 2.0 * attached[ASIGMA, j] * h, (attached[AOMEGA, j] * h) ** 2, drive * h
    pull, draw = sine, cosine  # Taylor terms of sin φ and cos φ
    attached[TERM, j] = x
    attached[TERM + 1, j] = y * h
    for i in range(SERIES - 2):
        push = attached[ASINE, j] * pull + attached[ACOSINE, j] * draw + (attached[ASTATIC, j] if i == 0 else 0.0)
        attached[TERM + i + 2, j] = (
            h * h * push - damp * (i + 1) * attached[TERM + i + 1, j] - spring * attached[TERM + i, j]
        ) / ((i + 1) * (i + 2))
        pull, draw = turn * draw / (i + 1), -turn * pull / (i + 1)


@kernel
def force_of(attached: Array, j: int) -> float:
    """Bound of the harmonic force on pair j."""
    return float(abs(attached[ASINE, j]) + abs(attached[ACOSINE, j]))


@kernel
def phase_after(signal: Array, time: float) -> tuple[float, float]:
    """cos and sin of the drive's phase φ + Ωt at a flight time t."""
    c, s = cos(signal[DRIVE] * time), sin(signal[DRIVE] * time)
    return signal[COSINE] * c - signal[SINE] * s, signal[SINE] * c + signal[COSINE] * s


@kernel
def fastest(attached: Array, signal: Array) -> float:
    """The fastest rate among the attached pairs and what drives them."""
    rate = 0.0
    for j in range(int(signal[ATTACHED])):
        rate = max(rate, max(2.0 * attached[ASIGMA, j], attached[AOMEGA, j]))
        if force_of(attached, j) != 0.0:
            rate = max(rate, signal[DRIVE])
    return rate


@kernel
def carry(attached: Array, signal: Array, node: float, t: float) -> None:
    """Trial = node carried on by t; ``node`` is the node's flight time."""
    pieces = max(1, int(np.ceil(fastest(attached, signal) * t)))
    h = t / pieces
    for j in range(int(signal[ATTACHED])):
        x, y = attached[NODE_X, j], attached[NODE_Y, j]
        for piece in range(pieces if t > 0.0 else 0):
            cosine, sine = phase_after(signal, node + piece * h)
            series(attached, j, x, y, cosine, sine, signal[DRIVE], h)
            x, y = 0.0, 0.0
            for i in range(SERIES - 1, 0, -1):
                x += attached[TERM + i, j]
                y += i * attached[TERM + i, j]
            x, y = x + attached[TERM, j], y / h
        attached[TRIAL_X, j], attached[TRIAL_Y, j] = x, y


@kernel
def growth(attached: Array, signal: Array, t: float) -> tuple[float, float]:
    """Weighted γ and δ: X = X(0) + t X'(0) + t² γ, X' = X'(0) + t δ, for rate · t up to about 1.2."""
    gamma, delta = 0.0, 0.0
    for j in range(int(signal[ATTACHED])):
        series(attached, j, attached[AX, j], attached[AY, j], signal[COSINE], signal[SINE], signal[DRIVE], t)
        for i in range(SERIES - 1, 1, -1):
            gamma += attached[AWEIGHT, j] * attached[TERM + i, j]
            delta += attached[AWEIGHT, j] * i * attached[TERM + i, j]
    return gamma / (t * t), delta / (t * t)


@kernel
def add_derivatives(attached: Array, signal: Array, start: int) -> None:
    """Add derivatives 0 … 5 at the start of the flight to terms[start:start + 6]: Σ weight X^{(j)}(0)."""
    for j in range(int(signal[ATTACHED])):
        series(attached, j, attached[AX, j], attached[AY, j], signal[COSINE], signal[SINE], signal[DRIVE], 1.0)
        factorial = 1.0
        for i in range(6):
            factorial *= max(i, 1)
            signal[start + i] += attached[AWEIGHT, j] * attached[TERM + i, j] * factorial


@kernel
def bound(attached: Array, signal: Array, time: float, order: int, h: float) -> float:
    """Bound of |Σ weight X^{(order)}| over the next h from the node at flight ``time``.

    Z = X^{(order)} obeys the same equation under F Ω^order, whose energy norm grows at most by the force:
    |Z(t)| ≤ |Z(0)| + h (√(Z'² + ω²Z²) + h |F| Ω^order).
    """
    total = 0.0
    if int(signal[ATTACHED]) == 0:
        return total
    cosine, sine = phase_after(signal, time)
    for j in range(int(signal[ATTACHED])):
        series(attached, j, attached[NODE_X, j], attached[NODE_Y, j], cosine, sine, signal[DRIVE], h)
        factorial = 1.0
        for i in range(2, order + 1):
            factorial *= i
        z = abs(attached[TERM + order, j]) * factorial / h**order
        slope = abs(attached[TERM + order + 1, j]) * factorial * (order + 1) / h ** (order + 1)
        push = h * force_of(attached, j) * signal[DRIVE] ** order
        total += abs(attached[AWEIGHT, j]) * (z + h * (hypot(slope, attached[AOMEGA, j] * z) + push))
    return total


@kernel
def trial_sum(attached: Array, signal: Array, t: float) -> tuple[float, float, float]:
    """Weighted value, slope and curvature of the trial at flight time t."""
    value, slope, curvature = 0.0, 0.0, 0.0
    if int(signal[ATTACHED]) > 0:
        cosine, sine = phase_after(signal, t)
        for j in range(int(signal[ATTACHED])):
            x, y, weight = attached[TRIAL_X, j], attached[TRIAL_Y, j], attached[AWEIGHT, j]
            push = attached[ASINE, j] * sine + attached[ACOSINE, j] * cosine + attached[ASTATIC, j]
            own = attached[AOMEGA, j]
            value += weight * x
            slope += weight * y
            curvature += weight * (push - 2.0 * attached[ASIGMA, j] * y - own * own * x)
    return value, slope, curvature


@kernel
def restart(attached: Array, signal: Array) -> None:
    """The node goes back to the start of the flight."""
    for j in range(int(signal[ATTACHED])):
        attached[NODE_X, j], attached[NODE_Y, j] = attached[AX, j], attached[AY, j]


@kernel
def accept(attached: Array, signal: Array) -> None:
    """The trial becomes the node."""
    for j in range(int(signal[ATTACHED])):
        attached[NODE_X, j], attached[NODE_Y, j] = attached[TRIAL_X, j], attached[TRIAL_Y, j]


@kernel
def swing(attached: Array, signal: Array, span: float) -> float:
    """Size of the attached pairs' part over a flight of ``span``: |x| + t|y| + t²(|F| + |s|), weighted."""
    total = 0.0
    for j in range(int(signal[ATTACHED])):
        push = force_of(attached, j) + abs(attached[ASTATIC, j])
        total += abs(attached[AWEIGHT, j]) * (abs(attached[AX, j]) + span * (abs(attached[AY, j]) + span * push))
    return total


@kernel
def jerk_bound(attached: Array, signal: Array) -> float:
    """Bound of the attached pairs' part in g'''."""
    total = 0.0
    for j in range(int(signal[ATTACHED])):
        rate = max(2.0 * attached[ASIGMA, j], attached[AOMEGA, j])
        push = force_of(attached, j) * (signal[DRIVE] + rate) + abs(attached[ASTATIC, j]) * rate
        motion = rate * rate * abs(attached[AY, j]) + rate**3 * abs(attached[AX, j])
        total += abs(attached[AWEIGHT, j]) * (push + motion)
    return total
