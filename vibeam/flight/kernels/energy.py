"""Time integral of each mode's energy ½(η'² + ω²η²) over a segment: a sum of products of exponentials, integrated.

In flight η = Σ Re(a e^{λt}): the free motion has one such term (two where it is overdamped), the steady response one
with λ = iΩ, the static offset one with λ = 0. The product of two of them integrates to two differences e^{zt} − 1 over
z, z the sum of their λ (of the second one's conjugate, too), each as good for small z as for large. Where that cannot
be good to all digits, in flights short against the mode and the drive, near critical damping, where large parts cancel,
for attached modes and at rest, it is Gauss's quadrature on panels that resolve the motion to round-off.
"""

from __future__ import annotations

from math import ceil, cos, exp, expm1, sin, sqrt
from typing import NamedTuple

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.pair import propagator
from vibeam_models.arrays import Array

NODES = tuple(float(x + 1) / 2 for x in np.polynomial.legendre.leggauss(8)[0])
WEIGHTS = tuple(float(w) / 2 for w in np.polynomial.legendre.leggauss(8)[1])
FEW_NODES = tuple(float(x + 1) / 2 for x in np.polynomial.legendre.leggauss(4)[0])
FEW_WEIGHTS = tuple(float(w) / 2 for w in np.polynomial.legendre.leggauss(4)[1])
PANEL = 2.0  # rate times length that eight nodes resolve: (2 · 2)¹⁶ (8!)⁴ / 17 (16!)³ = 7e-14
SHORT = 0.15  # the same of four: (2 · 0.15)⁸ (4!)⁴ / 9 (8!)³ = 4e-14
MOST = 128  # panels a rest, and where closed forms fail: a mode that turns oftener is not resolved
SPLIT = 0.05  # |λ₁ − λ₂| / 2ω below which the free motion is no sum of exponentials worth the name
FADED = 40.0  # decay exponent beyond which it is over
CANCELLED = 1e-3  # share of its parts below which a sum is not taken
NEAR = 0.1  # |z| t below which e^{zt} − 1 is not made of the two factors'


class SteadyResponse(NamedTuple):
    """Steady-state response of a mode, Re(phasor e^{iΩt}) + offset."""

    phasor: complex
    omega: float
    offset: float


class Term(NamedTuple):
    """Re(a e^{λt}), and how much e^{λt} − 1 its exponential has grown at the end."""

    amplitude: complex
    rate: complex
    grown: complex


@kernel
def energy_in_flight(engine: Engine, pose: Array, clock: float, duration: float, energy: Array) -> None:
    """Add ∫ E_k dt over a flight from ``pose`` to ``energy`` (n,). The engine's signal must be that of this flight."""
    pairs, modes, w = engine.pairs, engine.modes, engine.drive[layout.W]
    cosine, sine = phase(engine.drive, clock)
    turned = growth(1j * w, duration)
    for k in range(pairs.shape[1]):
        if carried(engine.attached, engine.signal, k):
            continue
        re, im, offset = modes[layout.RE, k], modes[layout.IM, k], modes[layout.OFFSET, k]
        x = pose[0, k] - offset - re * sine - im * cosine
        y = pose[1, k] - w * (re * cosine - im * sine)
        steady = (re * sine + im * cosine) - 1j * (re * cosine - im * sine)  # Re(steady e^{iΩt})
        energy[k] += flight_energy(pairs, k, x, y, SteadyResponse(steady, w, offset), duration, turned)
    if engine.signal[layout.ATTACHED] > 0.0:
        energy_attached(engine.attached, engine.signal, duration, energy)


@kernel
def growth(z: complex, t: float) -> complex:
    """e^{zt} − 1 to round-off of both its parts."""
    x, y = z.real * t, z.imag * t
    half, size = sin(0.5 * y), exp(x)
    return complex(expm1(x) - 2.0 * size * half * half, size * sin(y))


@joined
def term(amplitude: complex, rate: complex, t: float) -> Term:
    """a e^{λt} over t."""
    return Term(amplitude, rate, growth(rate, t))


@kernel
def flight_energy(pairs: Array, k: int, x: float, y: float, driven: SteadyResponse, t: float, turned: complex) -> float:
    """∫ ½(η'² + ω²η²) over t of mode k: free motion from x, x' and the steady response; turned = e^{iΩt} − 1."""
    steady, w, offset = driven
    own, sigma, disc = pairs[layout.OMEGA, k], pairs[layout.SIGMA, k], pairs[layout.DISC, k]
    none = Term(0j, 0j, 0j)
    rate = max(pairs[layout.KAPPA, k], w if steady != 0.0 else 0.0)
    if rate * t <= PANEL:
        return energy_by_quadrature(pairs, k, x, y, driven, t, 1, rate * t <= SHORT)
    if abs(disc) < SPLIT * SPLIT * own * own:
        first = min(t, FADED / sigma)
        panels = max(1, ceil(rate * first / PANEL))
        total = energy_by_quadrature(pairs, k, x, y, driven, first, panels, False)
        if first < t:
            begun = steady * (1.0 + growth(1j * w, first))
            last = term(begun, 1j * w, t - first)
            total += closed_form_energy(none, none, last, offset, own * own, t - first)[0]
        return total
    if disc < 0.0:
        turn = sqrt(-disc)
        free = term(x - 1j * (y + sigma * x) / turn, -sigma + 1j * turn, t)
        total, parts = closed_form_energy(free, none, Term(steady, 1j * w, turned), offset, own * own, t)
    else:
        fast = sigma + sqrt(disc)
        slow = own * own / fast
        a, b = (y + fast * x) / (fast - slow), -(y + slow * x) / (fast - slow)
        one, two = term(a + 0j, -slow + 0j, t), term(b + 0j, -fast + 0j, t)
        total, parts = closed_form_energy(one, two, Term(steady, 1j * w, turned), offset, own * own, t)
    if total < CANCELLED * parts and rate * t <= PANEL * MOST:
        return energy_by_quadrature(pairs, k, x, y, driven, t, ceil(rate * t / PANEL), False)
    return total


@kernel
def closed_form_energy(
    one: Term, two: Term, driven: Term, offset: float, square: float, t: float
) -> tuple[float, float]:
    """∫ ½(η'² + ω²η²) of η = Re(a e^{λ₁t} + b e^{λ₂t} + c e^{iΩt}) + offset, and the sum of its parts' sizes.

    The quadratic form of the sum, product by product; ``square`` = ω².
    """
    still = Term(offset + 0j, 0j, 0j)
    total = 0.5 * product(one, one, square, t)
    parts = abs(total)
    if two.amplitude != 0.0:
        part = 0.5 * product(two, two, square, t)
        part += product(one, two, square, t)
        total, parts = total + part, parts + abs(part)
        if driven.amplitude != 0.0:
            part = product(two, driven, square, t)
            total, parts = total + part, parts + abs(part)
        if offset != 0.0:
            part = product(two, still, square, t)
            total, parts = total + part, parts + abs(part)
    if driven.amplitude != 0.0:
        part = 0.5 * product(driven, driven, square, t)
        total, parts = total + part, parts + abs(part)
        part = product(one, driven, square, t)
        total, parts = total + part, parts + abs(part)
        if offset != 0.0:
            part = product(driven, still, square, t)
            total, parts = total + part, parts + abs(part)
    if offset != 0.0:
        part = 0.5 * square * offset * offset * t
        total, parts = total + part, parts + abs(part)
        part = product(one, still, square, t)
        total, parts = total + part, parts + abs(part)
    return total, parts


@kernel
def product(u: Term, v: Term, square: float, t: float) -> float:
    """∫ u'v' + ω²uv with u = Re(a e^{λt}), v = Re(b e^{μt}).

    ½ Re[ab(λμ + ω²) ∫e^{(λ+μ)t} + ab*(λμ* + ω²) ∫e^{(λ+μ*)t}].
    """
    a, first, grown = u
    b, second, turned = v
    back, other, unturned = b.conjugate(), second.conjugate(), turned.conjugate()
    one = a * b * (first * second + square) * integral(first + second, grown, turned, t)
    two = a * back * (first * other + square) * integral(first + other, grown, unturned, t)
    return 0.5 * (one.real + two.real)


@joined
def integral(z: complex, grown: complex, turned: complex, t: float) -> complex:
    """∫ e^{zt} = (e^{zt} − 1)/z over t, z the sum of two λ whose e^{λt} − 1 are given."""
    if z == 0.0:
        return t + 0j
    if (abs(z.real) + abs(z.imag)) * t < NEAR:
        return growth(z, t) / z
    return (grown + turned + grown * turned) / z


@kernel
def energy_by_quadrature(
    pairs: Array, k: int, x: float, y: float, driven: SteadyResponse, t: float, panels: int, few: bool
) -> float:
    """The same as ``flight_energy``, by Gauss's quadrature with eight nodes a panel, or ``few``: four."""
    steady, w, offset = driven
    h, own, total = t / panels, pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k], 0.0
    for panel in range(panels):
        for i in range(4 if few else 8):
            time = (panel + (FEW_NODES[i] if few else NODES[i])) * h
            p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], time)
            value, slope = offset + p00 * x + p01 * y, p10 * x + p11 * y
            if steady != 0.0:
                c, s = cos(w * time), sin(w * time)
                value += steady.real * c - steady.imag * s
                slope -= w * (steady.real * s + steady.imag * c)
            total += (FEW_WEIGHTS[i] if few else WEIGHTS[i]) * (slope * slope + own * value * value)
    return 0.5 * total * h


@kernel
def carried(attached: Array, signal: Array, k: int) -> bool:
    """True where mode k is attached."""
    found = False
    for j in range(int(signal[layout.ATTACHED])):
        found = found or int(attached[layout.AMODE, j]) == k
    return found


@kernel
def energy_attached(attached: Array, signal: Array, duration: float, energy: Array) -> None:
    """Add the attached modes' part: their Taylor series at the nodes, panel by panel."""
    panels = max(1, ceil(att.fastest(attached, signal) * duration))
    h = duration / panels
    att.restart(attached, signal)
    for panel in range(panels):
        cosine, sine = att.phase_after(signal, panel * h)
        for j in range(int(signal[layout.ATTACHED])):
            x, y, own = attached[layout.NODE_X, j], attached[layout.NODE_Y, j], attached[layout.AOMEGA, j]
            att.series(attached, j, x, y, cosine, sine, signal[layout.DRIVE], h)
            for node in range(8):
                value, slope = attached[layout.TERM + layout.SERIES - 1, j], 0.0
                for i in range(layout.SERIES - 2, -1, -1):
                    slope = slope * NODES[node] + value
                    value = value * NODES[node] + attached[layout.TERM + i, j]
                density = (slope / h) ** 2 + (own * value) ** 2
                energy[int(attached[layout.AMODE, j])] += 0.5 * h * WEIGHTS[node] * density
        att.carry(attached, signal, panel * h, h)
        att.accept(attached, signal)
