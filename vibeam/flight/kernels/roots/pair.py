"""One pair: x'' + 2σ x' + ω² x = 0 in closed form, and the drive's phasor, both without cancellation near t = 0.

Both are tabulated over dyadic panel lengths (``linear.block_regime``).

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

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry, joined, kernel
from vibeam.flight.kernels.layout import APART
from vibeam_models.arrays import Array

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
    return ((fast * first - slow * second) / apart, odd, -omega * omega * odd, (fast * second - slow * first) / apart)


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


@entry
def tabulate(pairs: Array, levels: Array, table: Array) -> None:
    """Fill ``table``, see ``layout``, of every panel length and pair."""
    for level in range(layout.LEVELS):
        h = levels[layout.STEP, level]
        for k in range(pairs.shape[1]):
            d0, d1, v0, v1 = increments(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], h)
            table[0, level, k] = 1.0 + h * h * d0
            table[1, level, k] = h + h * h * d1
            table[2, level, k] = h * v0
            table[3, level, k] = 1.0 + h * v1
            table[4, level, k] = d0
            table[5, level, k] = d1
            table[6, level, k] = v0
            table[7, level, k] = v1
            for i in range(4):
                table[layout.WALK + i, level, k] = table[i, level, k]
            if pairs[layout.SLOW, k] > 0.0:
                table[layout.WALK, level, k] = exp(-pairs[layout.SLOW, k] * h)
                table[layout.WALK + 3, level, k] = exp(pairs[layout.TILT, k] * h)
                table[layout.WALK + 1, level, k], table[layout.WALK + 2, level, k] = 0.0, 0.0


@kernel
def tabulate_drive(omega: float, levels: Array) -> None:
    """Fill the phasor rows of ``levels`` for one drive.

    Panels halve from level to level, so that each takes one sine: e^{iz} − 1 = −2 sin² ½z + i sin z.
    """
    sine = sin(omega * levels[layout.STEP, 0])
    for level in range(layout.LEVELS):
        h = levels[layout.STEP, level]
        inverse = 1.0 / h
        half = sin(0.5 * omega * h)
        versine = -2.0 * half * half
        levels[layout.TURN_RE, level], levels[layout.TURN_IM, level] = 1.0 + versine, sine
        levels[layout.FIRST_RE, level], levels[layout.FIRST_IM, level] = versine * inverse, sine * inverse
        levels[layout.SECOND_RE, level] = versine * inverse * inverse
        levels[layout.SECOND_IM, level] = sine_rest(omega * h, sine) * inverse * inverse
        sine = half


@kernel
def same_drive(levels: Array, others: Array) -> None:
    """Fill the phasor rows of ``others``, which have the same panel lengths."""
    for place in range(layout.TURN_RE, layout.LEVEL_ROWS):
        for level in range(layout.LEVELS):
            others[place, level] = levels[place, level]


@kernel
def level_of(levels: Array, h: float) -> int:
    """The level of the longest panel 2^{top − level} that is no longer than h."""
    level = 0
    while level < layout.LEVELS - 1 and levels[layout.STEP, level] > h:
        level += 1
    return level
