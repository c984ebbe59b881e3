"""What a panel proves: from values and slopes at its two ends and bounds on what lies between.

On a panel of length h the cubic Hermite interpolant H of p misses it by at most M₄h⁴/384, its slope by √3/216 M₄h³ and
its curvature by M₄h²/12 (Birkhoff & Priver 1967), with M₄ a bound on |p⁗|. H lies in the hull of its Bernstein
coefficients, and so do H′ and H″. Parts too fast for the panel are left out of H and enter as slack on value, slope
and curvature.
"""

from __future__ import annotations

from vibeam.flight.kernels.compiler import joined

CLEAR, ROOT, MINIMUM, SPLIT = 0, 1, 2, 3

THIRD, VALUE = 1.0 / 3.0, 1.0 / 384.0

SLOPE = 0.0080187537387448  # √3/216


@joined
def verdict(
    p0: float,
    s0: float,
    p1: float,
    s1: float,
    h: float,
    m4: float,
    slack0: float,
    slack1: float,
    slack2: float,
    end: float,
    end_slope: float,
    tolerance: float,
) -> int:
    """CLEAR: p > 0 on (0, h]; ROOT: exactly one root there; MINIMUM: p is convex, positive at both ends; SPLIT: open.

    p is known positive just after the left end; ``end`` and ``end_slope`` are its whole value and slope at the right
    one (p1, s1: those of the interpolated part).
    """
    square = h * h
    third = h * THIRD
    b1 = p0 + third * s0
    b2 = p1 - third * s1
    if min(min(p0, b1), min(b2, p1)) > m4 * square * square * VALUE + slack0 + tolerance:
        return CLEAR
    inverse = 1.0 / h
    d1 = 3.0 * (b2 - b1) * inverse
    slope_error = SLOPE * m4 * square * h + slack1
    if max(max(s0, d1), s1) < -slope_error:  # falling throughout
        return CLEAR if end > 0.0 else ROOT
    if min(min(s0, d1), s1) > slope_error:  # rising throughout
        return CLEAR
    c0 = 2.0 * (d1 - s0) * inverse
    c1 = 2.0 * (s1 - d1) * inverse
    curvature_error = m4 * square * (1.0 / 12.0) + slack2
    if max(c0, c1) < -curvature_error:  # concave: least at an end
        return CLEAR if end > 0.0 else ROOT
    if min(c0, c1) > curvature_error:  # convex: one crossing, or one minimum, or neither
        if end <= 0.0:
            return ROOT
        return MINIMUM if end_slope > 0.0 else CLEAR
    return SPLIT
