"""The gap in twice the precision: whether a grazing contact touches, where one double cannot tell.

A contact at velocity v reaches v²/2a deep: for v at 1e-9 of the scale that is 5e-19 of the displacement, below the
round-off of a double. Nothing is taken from the tables: the gap is evaluated anew from the system's own numbers and the
state at the start of the flight, all in pairs of doubles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.roots.double_double import (
    Pair,
    add,
    cosine_sine,
    divide,
    exponential,
    multiply,
    root,
    subtract,
    two_product,
)

Array = NDArray[np.float64]


class InitialState(NamedTuple):
    """State at the start of a flight, and the system that flies: see ``layout`` for the rows."""

    modes: Array
    drive: Array
    pose: Array  # (2, n) η, η'
    clock: float  # time in the drive period; negative: the signal is not the gap of a flight


@kernel
def sharp_gap(pairs: Array, initial: InitialState, t: float) -> float:
    """g = Δ − w·η at flight time t in double-double arithmetic; no mode may be attached.

    η_k = Im(H_k e^{iφ}) + s_k/ω_k² + P00 x_k + P01 x_k', x_k what the initial state has beyond the steady response.
    """
    modes, drive, pose, clock = initial
    start, w = two_product(drive[layout.W], clock), drive[layout.W]
    phase = add(start, two_product(w, t))
    total: Pair = (drive[layout.GAP], 0.0)
    for k in range(pairs.shape[1]):
        own, zeta = pairs[layout.OMEGA, k], modes[layout.ZETA, k]
        re, im = steady(own, zeta, modes[layout.LOAD, k], w, drive)
        offset = divide((modes[layout.STATIC, k], 0.0), two_product(own, own))
        x0, y0 = at_phase(re, im, start, w)
        x = subtract(subtract((pose[0, k], 0.0), offset), x0)
        y = subtract((pose[1, k], 0.0), y0)
        now, _ = at_phase(re, im, phase, w)
        now = add(add(now, offset), free(own, zeta, x, y, t))
        total = subtract(total, multiply((modes[layout.CONTACT, k], 0.0), now))
    return total[0]


@kernel
def steady(own: float, zeta: float, load: float, w: float, drive: Array) -> tuple[Pair, Pair]:
    """Real and imaginary part of load Ω²B / (ω² − Ω² + 2iζωΩ)."""
    if drive[layout.AMPLITUDE] == 0.0 or load == 0.0:
        return (0.0, 0.0), (0.0, 0.0)
    force = multiply(multiply(two_product(w, w), (drive[layout.AMPLITUDE], 0.0)), (load, 0.0))
    real = subtract(two_product(own, own), two_product(w, w))
    imaginary = multiply(multiply(two_product(zeta, own), (w, 0.0)), (2.0, 0.0))
    size = add(multiply(real, real), multiply(imaginary, imaginary))
    minus = divide(multiply(force, imaginary), size)
    return divide(multiply(force, real), size), (-minus[0], -minus[1])


@kernel
def at_phase(re: Pair, im: Pair, phase: Pair, w: float) -> tuple[Pair, Pair]:
    """Im((re + i im) e^{iφ}) and its rate."""
    cosine, sine = cosine_sine(phase)
    value = add(multiply(re, sine), multiply(im, cosine))
    rate = subtract(multiply(re, cosine), multiply(im, sine))
    return value, multiply((w, 0.0), rate)


@kernel
def free(own: float, zeta: float, x: Pair, y: Pair, t: float) -> Pair:
    """What x, x' have become after t of free motion."""
    sigma = two_product(zeta, own)
    disc = multiply(two_product(own, own), multiply(add((zeta, 0.0), (-1.0, 0.0)), add((zeta, 0.0), (1.0, 0.0))))
    slope = add(y, multiply(sigma, x))
    time: Pair = (t, 0.0)
    if disc[0] < 0.0:
        w = root((-disc[0], -disc[1]))
        decay = exponential(multiply((-sigma[0], -sigma[1]), time))
        cosine, sine = cosine_sine(multiply(w, time))
        return multiply(decay, add(multiply(cosine, x), multiply(divide(sine, w), slope)))
    if disc[0] == 0.0:
        decay = exponential(multiply((-sigma[0], -sigma[1]), time))
        return multiply(decay, add(x, multiply(time, slope)))
    mu = root(disc)
    fast = exponential(multiply(subtract((-sigma[0], -sigma[1]), mu), time))
    slow = exponential(multiply(divide(two_product(own, -own), add(sigma, mu)), time))
    half: Pair = (0.5, 0.0)
    even = multiply(half, multiply(add(slow, fast), x))
    return add(even, multiply(half, multiply(divide(subtract(slow, fast), mu), slope)))
