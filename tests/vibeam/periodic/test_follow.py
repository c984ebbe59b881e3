"""Boundaries followed along a second parameter, against closed forms of one mode at every value."""

from __future__ import annotations

from math import cos, exp, hypot, pi, sin, sqrt

import numpy as np
import pytest

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries, follow_boundary
from vibeam.system.impact_system import ImpactSystem

BETA, R, B = 0.015, 0.9, 0.5e-3
NOMINAL = ImpactSystem.from_modes([1.0], BETA, 1.0, 1.0, restitution=R)
OWN = sqrt(1 - BETA**2)
MEETING = 2 * OWN  # G₀ = 0: half a turn of the mode a period


def green(omega: float) -> tuple[float, float]:
    """G₀ and κ of one mode, by hand."""
    span = 2 * pi / omega
    e, c, s = exp(-BETA * span), cos(OWN * span), sin(OWN * span) / OWN
    bottom = 1 - 2 * e * c + e * e
    return e * s / bottom, R / (1 + R) - (1 - e * (c + BETA * s)) / bottom


def response(omega: float) -> float:
    return omega**2 * B / hypot(1 - omega**2, 2 * BETA * omega)


def found(kind: Kind, omega: float, sign: int, width: float = 12e-3) -> Boundary:
    (one,) = [
        b for b in boundaries(NOMINAL, B, omega, gap=(-width, width), kinds=(kind,)) if np.sign(b.gap) == sign
    ]  # fmt: skip
    return one


@pytest.mark.parametrize(
    ("start", "stop", "sign"), [(1.7, 2.5, 1), (2.5, 1.7, -1)], ids=["above resonance", "below resonance"]
)
def test_a_fold_ends_where_it_meets_grazing(start: float, stop: float, sign: int) -> None:
    """Δ = ∓|H|√((ΩG₀/κ)² + 1) with p = ΔG₀/(G₀² + (κ/Ω)²): where G₀ changes its sign the stop would have to pull."""
    values = np.linspace(start, stop, 81)
    fold = follow_boundary(NOMINAL, found(Kind.FOLD, start, sign), "omega", values)
    assert len(fold) == np.count_nonzero((values - MEETING) * (start - MEETING) > 0)
    for b in fold:
        g0, kappa = green(b.omega)
        assert b.gap == pytest.approx(sign * response(b.omega) * hypot(b.omega * g0 / kappa, 1), rel=1e-12)
        impulse = b.gap * g0 / (g0**2 + (kappa / b.omega) ** 2)
        assert b.velocity == pytest.approx(-impulse / (1 + R), rel=1e-6)
    nearer = follow_boundary(NOMINAL, fold[-1], "omega", MEETING + np.sign(start - MEETING) * np.array([1e-3, 1e-5]))
    assert nearer[-1].gap == pytest.approx(sign * response(MEETING), rel=1e-4)
    assert nearer[-1].velocity < 1e-2 * response(MEETING)


@pytest.mark.parametrize("sign", [1, -1])
def test_grazing_goes_on_where_the_motions_change_their_order(sign: int) -> None:
    """Δ = ±|H|; the other motion's impulse passes zero on the way."""
    values = np.linspace(1.7, 2.5, 81)
    curve = follow_boundary(NOMINAL, found(Kind.GRAZING, 1.7, sign), "omega", values)
    np.testing.assert_allclose([b.gap for b in curve], [sign * response(omega) for omega in values], rtol=1e-12)
    assert {b.branch for b in curve} == {0, 1}


def test_touching_goes_round_a_fold() -> None:
    values = np.linspace(1.98, 2.03, 6)
    curve = follow_boundary(NOMINAL, found(Kind.TOUCHING, 1.98, -1, 1e-3), "omega", values)
    assert {b.branch for b in curve} == {0, 1}
    for b, omega in zip(curve, values, strict=True):
        assert b.gap == pytest.approx(found(Kind.TOUCHING, omega, -1, 1e-3).gap, rel=1e-10)


def test_a_boundary_at_no_gap_is_followed() -> None:
    """From Δ = 0, where a share of the gap is no window at all: 1 + tr J + det J = 0 at every value."""
    (start,) = boundaries(NOMINAL, B, (2.6, 2.7), points=11, kinds=(Kind.DOUBLING,))
    (there,) = boundaries(NOMINAL, B, start.omega, gap=(-1e-4, 1e-4), points=11, kinds=(Kind.DOUBLING,))
    assert abs(there.gap) < 1e-15
    for values in (np.linspace(start.omega, 2.9, 20), np.linspace(start.omega, 2.4, 20)):
        curve = follow_boundary(NOMINAL, there, "omega", values)
        assert len(curve) == 20
        for b in curve:
            span = 2 * pi / b.omega
            force = b.omega**2 * B * sin(b.phase)
            ratio = (1 + R) * (force - b.gap) * sin(OWN * span) / (OWN * b.velocity)
            trace = exp(-BETA * span) * (ratio - 2 * R * cos(OWN * span))
            assert 1 + trace + R**2 * exp(-2 * BETA * span) == pytest.approx(0, abs=1e-10)
