"""Periodic motions with one impact a span, and their exact derivatives by parameters (implicit function theorem).

The equation of ``modal_sums``, with y = Δ − p G₀ and x = p κ/Ω, are Q(p; θ) = y² + x² − |H|² = 0 and
φ = arg(x + iy) − arg H. Where ∂Q/∂p ≠ 0,

    dp = −(y (dΔ − p dG₀) + x p d(κ/Ω) − |H| d|H|) / (x κ/Ω − y G₀),
    dφ = (x dy − y dx)/(x² + y²) − Im(dH/H),        κ = R S/(1 + R) − G₁,

and dG₀, dG₁, dH, dS follow from those of the modal data (ω, σ, c, load, …) mode by mode. ∂Q/∂p = 0 at a fold. Beyond
it there is no motion; so that a cost may be continued there, the motion at the least drive B* that has one is taken,

    p* = ΔG₀/L,   |H*| = |Δκ/Ω|/√L,   L = G₀² + (κ/Ω)²,        beyond = ln(B*/B) > 0.

A displacement u(τ) = o·η at τ after the impact is

    u = o·s/ω² + Im(H_o e^{i(φ + Ωτ)}) + p Σ o_i c_i g_i(τ).

Its extremes over a span lie where u' = 0, or at the impact, τ = 0: in both cases their derivatives by a parameter are
those of u at constant τ (envelope theorem).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.periodic.tangents import Green, ModalData, Poles, Tangents, green_at
from vibeam_models.arrays import Array, Complex


class Struck(NamedTuple):
    """One root at every point: phase, impulse (points,), their derivatives (P, points), ln(B*/B) (0: it exists).

    NaN where not even a larger drive gives a motion of this root. ``height`` and ``turn`` are y and x.
    """

    phase: Array
    impulse: Array
    by_phase: Array
    by_impulse: Array
    beyond: Array
    by_beyond: Array


class Driven(NamedTuple):
    """Response to the drive alone of some row: phasor (points,), derivatives (P, points)."""

    value: Complex
    by: Complex


def driven(data: ModalData, tangents: Tangents, row: Array, by_row: Array, omega: Array) -> Driven:
    """Phasor B Σ row_i load_i Φ_i(Ω), Φ = Ω²/(ω² − Ω² + 2iσΩ), and its derivatives."""
    natural, sigma, w = data.omega, data.sigma, omega[:, None]
    share = w**2 / ((natural - w) * (natural + w) + 2j * sigma * w)  # (points, n)
    by_omega, by_sigma = -(share**2) * 2 * natural / w**2, -2j * share**2 / w
    weight = row * data.load
    unit = share @ weight
    changes = by_row * data.load + row * tangents.load
    by_unit = changes @ share.T + (weight * tangents.omega) @ by_omega.T + (weight * tangents.sigma) @ by_sigma.T
    by: Complex = np.asarray(by_unit * data.drive + unit * tangents.drive, dtype=complex)
    return Driven(np.asarray(unit * data.drive, dtype=complex), by)


def contracted(green: Green, weight: Array, by_weight: Array, tangents: Tangents) -> tuple[Array, Array]:
    """Σ weight_i g_i (points,) and its derivatives (P, points)."""
    value = green.value @ weight
    by = by_weight @ green.value.T + (weight * tangents.omega) @ green.by_omega.T
    return value, by + (weight * tangents.sigma) @ green.by_sigma.T


def offset_of(data: ModalData, tangents: Tangents, row: Array, by_row: Array) -> tuple[float, Array]:
    """Static displacement Σ row_i s_i/ω_i² and its derivatives (P,)."""
    soft = data.static / data.omega**2
    by = by_row @ soft + tangents.static @ (row / data.omega**2) - 2 * tangents.omega @ (row * soft / data.omega)
    return float(row @ soft), by


def struck(data: ModalData, tangents: Tangents, omega: Array, periods: Array, root: int) -> Struck:
    """Root 0 (the harder impact) or 1 at drives ``omega`` (points,) rad/s, one impact in ``periods`` (points,)."""
    poles, span = Poles.of(data.omega, data.zeta), (2 * np.pi * periods / omega)[:, None]
    now = np.zeros_like(span)
    square, by_square = data.contact**2, 2 * data.contact * tangents.contact
    g0, by_g0 = contracted(green_at(poles, span, now), square, by_square, tangents)
    g1, by_g1 = contracted(green_at(poles, span, now, 1), square, by_square, tangents)
    restitution, mobility, by_mobility = data.restitution, float(square.sum()), by_square.sum(axis=1)
    kappa = restitution * mobility / (1 + restitution) - g1
    by_kappa = (
        (mobility * tangents.restitution / (1 + restitution) + restitution * by_mobility)[:, None] / (1 + restitution)
    ) - by_g1
    turn, by_turn = kappa / omega, by_kappa / omega
    static, by_static = offset_of(data, tangents, data.contact, tangents.contact)
    clear, by_clear = data.gap - static, (tangents.gap - by_static)[:, None]
    h = driven(data, tangents, data.contact, tangents.contact, omega)
    return _solved((g0, by_g0), (turn, by_turn), (clear, by_clear), h, root)


Pair = tuple[Array, Array]


def _solved(g0: Pair, turn: Pair, clear: tuple[float, Array], h: Driven, root: int) -> Struck:
    (g, by_g), (t, by_t), (c, by_c) = g0, turn, clear
    size = np.abs(h.value)
    lead, by_lead = g**2 + t**2, 2 * (g * by_g + t * by_t)
    with np.errstate(invalid="ignore", divide="ignore"):
        by_size = (h.value.conj() * h.by).real / size
        long, short = size * np.sqrt(lead), np.abs(c * t)
        real = long > short
        inner = np.sqrt(np.where(real, (long - short) * (long + short), 0.0))
        p = (c * g + (inner if root else -inner)) / lead
        y, x = c - p * g, p * t
        within = -(y * (by_c - p * by_g) + x * p * by_t - size * by_size) / (x * t - y * g)
        fold = (by_c * g + c * by_g) / lead - p * by_lead / lead
        by_p = np.where(real, within, fold)
        by_y, by_x = by_c - by_p * g - p * by_g, by_p * t + p * by_t
        by_phase = (x * by_y - y * by_x) / (x**2 + y**2) - (h.by / h.value).imag
        beyond = np.where(real, 0.0, np.log(short / long))
        by_beyond = np.where(real, 0.0, by_c / c + by_t / t - by_lead / (2 * lead) - by_size / size)
    phase = np.arctan2(y, x) - np.angle(h.value)
    none = ~(p < 0)
    return Struck(
        np.where(none, np.nan, phase), np.where(none, np.nan, p), by_phase, by_p,
        np.where(none, np.nan, beyond), by_beyond,
    )  # fmt: skip
