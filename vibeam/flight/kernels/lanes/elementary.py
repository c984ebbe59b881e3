"""exp, sin and cos of several numbers at once, to about a last digit: ranges reduced in parts, then polynomials.

Coefficients are those of the Taylor series, which on |r| ≤ ln 2/2 and π/4 leave less than 1e-17 with these degrees.
"""

from __future__ import annotations

from math import factorial

from vibeam.flight.kernels.compiler import joined
from vibeam.flight.kernels.lanes.simd import Lanes, every, larger, plain, quarter, scaled, whole

PER_LOG = 1.4426950408889634  # 1/ln 2
LOG_HIGH, LOG_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # ln 2 = HIGH + LOW, HIGH of 33 bits
PER_QUARTER = 0.6366197723675814  # 2/π
QUARTER_1, QUARTER_2 = 1.57079632673412561417e00, 6.07710050630396597660e-11  # π/2 in parts of 33 bits
QUARTER_3 = 2.02226624879595063154e-21
E = [1.0 / factorial(j) for j in range(15)]
E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12, E13 = E[2:14]
S3, S5, S7, S9, S11, S13, S15 = (-(1.0 if j % 4 == 3 else -1.0) / factorial(j) for j in range(3, 16, 2))
C4, C6, C8, C10, C12, C14, C16 = ((1.0 if j % 4 == 0 else -1.0) / factorial(j) for j in range(4, 17, 2))


@joined
def exponential(x: Lanes) -> Lanes:
    """e^x for x ≤ 0; below −708 e^−708."""
    x = larger(x, every(-708.0, x))
    n = whole(x * PER_LOG)
    m = plain(n)
    r = (x - m * LOG_HIGH) - m * LOG_LOW
    s = r * r
    f = s * s
    low = (E2 + r * E3) + s * (E4 + r * E5)
    high = (E6 + r * E7) + s * (E8 + r * E9) + f * ((E10 + r * E11) + s * (E12 + r * E13))
    return scaled(1.0 + (r + s * (low + f * high)), n)


@joined
def sine_cosine(x: Lanes) -> tuple[Lanes, Lanes]:
    """sin x and cos x for |x| ≤ ``thresholds.REDUCED``."""
    n = whole(x * PER_QUARTER)
    m = plain(n)
    r = ((x - m * QUARTER_1) - m * QUARTER_2) - m * QUARTER_3
    s = r * r
    f = s * s
    g = f * f
    sine = r + r * s * ((S3 + s * S5) + f * (S7 + s * S9) + g * ((S11 + s * S13) + f * S15))
    rest = f * ((C4 + s * C6) + f * (C8 + s * C10) + g * ((C12 + s * C14) + f * C16))
    half = 0.5 * s
    unit = 1.0 - half
    cosine = unit + (((1.0 - unit) - half) + rest)
    return quarter(sine, cosine, n, 0), quarter(cosine, sine, n, 1)
