"""Verdicts on a panel, proved from values and slopes at its two ends and bounds on what lies between.

On a panel of length h the cubic Hermite interpolant H of p misses it by at most M₄h⁴/384, its slope by √3/216 M₄h³ and
its curvature by M₄h²/12 (Birkhoff & Priver 1967), with M₄ a bound on |p⁗|. H lies in the hull of its Bernstein
coefficients, and so do H′ and H″. Parts too fast for the panel are left out of H and enter as slack on value, slope
and curvature.
"""

from __future__ import annotations

from typing import NamedTuple

from vibeam.flight.kernels.compiler import joined

CLEAR, ROOT, MINIMUM, SPLIT = 0, 1, 2, 3
THIRD, VALUE = 1.0 / 3.0, 1.0 / 384.0
SLOPE = 0.0080187537387448  # √3/216


class PanelEnds(NamedTuple):
    """Values p₀, p₁ and slopes s₀, s₁ at the ends of a panel: of the interpolant H, or of what it leaves out."""

    p0: float
    s0: float
    p1: float
    s1: float


class Bounds(NamedTuple):
    """Bounds over a panel: M₄ ≥ |p⁗| of what is interpolated; value, slope, curvature of what is not, the slack."""

    fourth: float
    value: float
    slope: float
    curvature: float


@joined
def verdict(ends: PanelEnds, h: float, bounds: Bounds, end: float, end_slope: float, tolerance: float) -> int:
    """Verdict on a panel of length h from the hulls of H, H′, H″ and their errors (Birkhoff & Priver 1967).

    CLEAR: p > 0 on (0, h]; ROOT: exactly one root there; MINIMUM: p is convex, positive at both ends; SPLIT: open.

    With b₁ = p₀ + hs₀/3, b₂ = p₁ − hs₁/3: the hull of H, min(p₀, b₁, b₂, p₁), counts against M₄h⁴/384 + slack; that of
    H′, s₀, d = 3(b₂ − b₁)/h, s₁, against √3/216 M₄h³ + slack; that of H″, 2(d − s₀)/h, 2(s₁ − d)/h, against M₄h²/12 +
    slack. p is known positive just after the left end; ``end`` and ``end_slope`` are its whole value and slope at the
    right one (p₁, s₁: those of the interpolated part).
    """
    p0, s0, p1, s1 = ends
    m4, slack0, slack1, slack2 = bounds
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
