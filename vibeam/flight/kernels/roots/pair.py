"""One pair: x'' + 2σ x' + ω² x = 0 in closed form, and the drive's phasor, both without cancellation near t = 0.

With disc = σ² − ω² (negative: underdamped) the propagator over t is

    x(t)  = P00 x + P01 x',   P01 = e^{−σt} S,  P00 = e^{−σt} (C + σS)
    x'(t) = P10 x + P11 x',   P10 = −ω² P01,    P11 = e^{−σt} (C − σS)

with C, S = cos wt, sin wt / w or their hyperbolic or confluent forms. Just after an impact the motion is known as
g' t + O(t²), so what counts is what is left when the first terms are taken off:

    x(t) = x + t x' + t² (D0 x + D1 x'),     x'(t) = x' + t (V0 x + V1 x').

Far beyond critical damping (ζ > 2) the decays a = ω²/b and b = σ + μ, ab = ω², are told apart:

    x = s e^{−at} + f e^{−bt},     s = (b x + x')/(b − a),  f = −(a x + x')/(b − a)

In P11 = (b e^{−bt} − a e^{−at})/(b − a), and in every derivative, nothing cancels then: from e^{−σt} (C − σS) the slow
velocity −a s would come as the difference of two numbers b/a = 4ζ² times as large.
"""

from __future__ import annotations

from math import cos, cosh, exp, expm1, sin, sinh, sqrt

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.thresholds import APART

SERIES_BELOW = 0.7  # κt up to which the power series is used: 20 terms reach 1e-19 there

TERMS = 20


@joined
def propagator(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float, float, float]:
    """(P00, P01, P10, P11) of one pair over t ≥ 0."""
    if disc < 0.0:
        w = sqrt(-disc)
        decay = exp(-sigma * t)
        s = decay * sin(w * t) / w
        c = decay * cos(w * t)
    elif disc > APART * sigma * sigma:
        return two_decays(sigma, omega, disc, t)
    else:
        c, s = overdamped(sigma, omega, disc, t)
    return c + sigma * s, s, -omega * omega * s, c - sigma * s


@kernel
def two_decays(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float, float, float]:
    """(P00, P01, P10, P11) far beyond critical damping."""
    fast = sigma + sqrt(disc)
    slow = omega * (omega / fast)
    first, second, apart = exp(-slow * t), exp(-fast * t), fast - slow
    odd = (expm1(-slow * t) - expm1(-fast * t)) / apart
    return (
        (fast * first - slow * second) / apart,
        odd,
        -omega * omega * odd,
        (fast * second - slow * first) / apart,
    )


@kernel
def growths_of_two_decays(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float, float, float]:
    """(D0, D1, V0, V1) far beyond critical damping, bt not small."""
    fast = sigma + sqrt(disc)
    slow = omega * (omega / fast)
    first, second, apart = expm1(-slow * t), expm1(-fast * t), fast - slow
    odd = (first - second) / apart
    return (
        (fast * first - slow * second) / apart / (t * t),
        (odd - t) / (t * t),
        -omega * omega * odd / t,
        (fast * second - slow * first) / apart / t,
    )


@kernel
def decay_growths(rate: float, t: float) -> tuple[float, float]:
    """(e^{−at} − 1 + at)/t² and a (1 − e^{−at})/t, for at up to about 1.2."""
    z, term, total = rate * t, 0.5, 0.5
    for j in range(3, TERMS + 3):
        term *= -z / j
        total += term
        if abs(term) < 1e-18:
            break
    return total * rate * rate, -rate * expm1(-z) / t


@kernel
def overdamped(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float]:
    """e^{−σt} cosh μt and e^{−σt} sinh μt / μ with μ² = disc ≥ 0, by the two decays so that nothing overflows."""
    mu = sqrt(disc)
    if mu * t < 1.0:
        decay = exp(-sigma * t)
        return decay * cosh(mu * t), decay * (sinh(mu * t) / mu if mu * t > 0.0 else t)
    slow = exp(-t * omega * omega / (sigma + mu))
    fast = exp(-t * (sigma + mu))
    return 0.5 * (slow + fast), 0.5 * (slow - fast) / mu


@kernel
def increments(sigma: float, omega: float, disc: float, t: float) -> tuple[float, float, float, float]:
    """(D0, D1, V0, V1) of one pair over t > 0, to relative round-off however small t is."""
    if (omega + 2.0 * sigma) * t > SERIES_BELOW:
        if disc > APART * sigma * sigma:
            return growths_of_two_decays(sigma, omega, disc, t)
        p00, p01, p10, p11 = propagator(sigma, omega, disc, t)
        return (p00 - 1.0) / (t * t), (p01 - t) / (t * t), p10 / t, (p11 - 1.0) / t
    square = omega * omega
    damp, spring = 2.0 * sigma * t, square * t * t
    before, now = 0.0, 1.0  # coefficients of P01 = Σ y_j t^j, each times t^{j−1}
    d0, d1, v0, v1 = 0.5, 0.0, 1.0, 0.0
    for j in range(1, TERMS):
        before, now = now, (-damp * now - spring * before / j) / (j + 1)
        d1 += now
        v1 += (j + 1) * now
        d0 += now / (j + 2)
        v0 += now
        if abs(now) + abs(before) < 1e-19:
            break
    return -square * d0, d1 / t, -square * v0, v1 / t


@kernel
def phasor_increments(omega: float, t: float) -> tuple[float, float, float, float]:
    """Re and Im of (e^{iωt} − 1 − iωt)/t² and of (e^{iωt} − 1)/t."""
    z = omega * t
    half, sine = sin(0.5 * z), sin(z)
    versine = -2.0 * half * half
    return versine / (t * t), sine_rest(z, sine) / (t * t), versine / t, sine / t


@joined
def sine_rest(z: float, sine: float) -> float:
    """sin z − z."""
    if z > SERIES_BELOW:
        return sine - z
    rest, term, square = 0.0, z, -z * z
    for j in range(1, 12):
        term *= square / ((2 * j) * (2 * j + 1))
        rest += term
        if abs(term) <= 1e-18 * abs(rest):
            break
    return rest


@joined
def norm(a: float, b: float) -> float:
    """√(a² + b²) from above, at most 8 % more, without the root: the chord of the circle's octant."""
    a, b = abs(a), abs(b)
    return max(a, b) + 0.41421356237309515 * min(a, b)


@joined
def power(base: float, exponent: int) -> float:
    """base^exponent for a small whole exponent."""
    value = 1.0
    for _ in range(exponent):
        value *= base
    return value
