"""Periodic Green's function of a mode at any time after an impact, and its derivatives by frequency and damping.

With the poles s₁, s₂ = −σ ± √(σ² − ω²) of a mode and the span T, at 0 ≤ τ < T after an impact

    g(τ) = (f(s₁) − f(s₂))/(s₁ − s₂),   f(s) = e^{sτ}/(1 − e^{sT}),   f'(s) = f(s) (τ + T e^{sT}/(1 − e^{sT})),
    dg   = (f'(s₁) ds₁ − f'(s₂) ds₂ − g (ds₁ − ds₂))/(s₁ − s₂),       ds = −dσ ± (σ dσ − ω dω)/√(σ² − ω²),

and g', g'' with s f, s² f in place of f. Below critical damping s₂ is the conjugate of s₁, so that one exponential is
enough. At critical damping the two poles are one and the formula has no value: such modes are refused, as are modes
without stiffness.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array, Complex


class Poles(NamedTuple):
    """Poles of the modes (n,) and their derivatives by natural frequency and by σ = ζω."""

    first: Complex
    second: Complex
    under: NDArray[np.bool_]
    by_omega: Complex  # of the first; the second's is the negative
    by_sigma: Complex  # of √(σ² − ω²): ds = −dσ ± by_sigma dσ

    @classmethod
    def of(cls, omega: Array, zeta: Array) -> Poles:
        """Poles of modes with stiffness, none of them critically damped."""
        sigma = zeta * omega
        root = np.sqrt((sigma**2 - omega**2).astype(complex))
        return cls(-sigma + root, -sigma - root, zeta < 1, -omega / root, sigma / root)


class Green(NamedTuple):
    """A derivative of g in time of some order, and its partial derivatives by ω and σ; each of one shape (…, n)."""

    value: Array
    by_omega: Array
    by_sigma: Array


def green_at(poles: Poles, span: Array, after: Array, order: int = 0) -> Green:
    """``order``-th derivative of g at ``after`` the impact, 0 … ``span``, both (…, 1), s, with its partials."""
    first, slope = _part(poles.first, span, after, order)
    if poles.under.all():
        second, other = first.conj(), slope.conj()
    else:
        second, other = _part(poles.second, span, after, order)
    apart = poles.first - poles.second
    value = (first - second) / apart
    by_omega = (slope * poles.by_omega + other * poles.by_omega - value * 2 * poles.by_omega) / apart
    by_sigma = (
        slope * (poles.by_sigma - 1) + other * (poles.by_sigma + 1) - value * 2 * poles.by_sigma
    ) / apart  # ds₁ = −1 + by_sigma, ds₂ = −1 − by_sigma
    return Green(value.real, by_omega.real, by_sigma.real)


def _part(s: Complex, span: Array, after: Array, order: int) -> tuple[Complex, Complex]:
    """s^order f(s) and its derivative by s."""
    closing = np.exp(s * span)
    f = np.exp(s * after) / (1 - closing)
    slope = f * (after + span * closing / (1 - closing))
    if not order:
        return f, slope
    return s**order * f, s**order * slope + order * s ** (order - 1) * f
