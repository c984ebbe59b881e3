"""Stationary motion against a hard stop without loss (R = 1) under white noise: its law, and noise that keeps it.

    η'' + D η' + ω² η = l f(t),  ⟨f(t) f(t')⟩ = S δ(t − t'),  D = γ l lᵀ,  row·η ≤ gap, row·η' → −row·η' there

Law. Between impacts the density p of (η, η') follows Kramers' equation, with diffusion ½ S l lᵀ and friction γ l lᵀ.
With T = S/2γ both act on exp(−H/T), H = ½ η'² + ½ ω²η², as ∂_v (γ v p + ½ S ∂_v p) = 0; the flow of H keeps every
function of H; an impact with R = 1 keeps H and the volume of (η, η'), for on the wall it turns the speed along one
direction. So exp(−H/T), cut at the gap, is stationary, whatever the number of modes: velocities are Gaussian with
⟨η_i'²⟩ = T, all modes alike, and row·η is Gaussian with σ² = T Σ row²/ω², cut. Impacts a second are the flux through
the wall, p(gap) ⟨v⁺⟩ = e^{−Δ²/2σ²} / (√(2π) σ Φ(Δ/σ)) · √(T row²/2π), for one mode ω/2π · e^{−Δ²/2σ²} / Φ(Δ/σ).

Noise that keeps it. Independent kicks at equal times, η' += l q ξ, q² = 2γTh: each adds ½ q² l² to the energy in the
mean whatever the impacts do, so that ⟨(l·η')²⟩ = T exactly in the mean over time. The error left comes from damping at
all times and kicks at some: (h²/24) of the second derivative along the flow of H, of the order ζ(ωh)².

Noise that does not. Of a force with correlation C(τ), Novikov's formula gives the power ⟨v f⟩ = ∫₀^∞ C(τ) K(τ) dτ, with
K(τ) the mean response of v to a kick ε a time τ before. An impact between them turns its sign: −2λτ, λ impacts a
second. And it moves the impact itself, by −ετ/v, while v jumps by −2v there: −2λτ once more. So K = cos ωτ (1 − 4λτ) up
to τ², and a force that is remembered gives less, T_eff/T = ∫ C K dτ / ∫ C dτ, in first order; without a stop in second.
Lines between independent samples h apart have C ~ B₃(τ/h), the cubic B-spline, whose mean |τ| is 7h/15:
T_eff/T ≈ 1 − 28/15 λh.
"""

from __future__ import annotations

import math

import numpy as np


def normal(z: float) -> float:
    """Φ(z)."""
    return 0.5 * math.erfc(-z / math.sqrt(2))


def deviation(omega: np.ndarray, row: np.ndarray, temperature: float) -> float:
    """σ of row·η without a stop."""
    return math.sqrt(temperature * float(np.sum((row / omega) ** 2)))


def impact_rate(omega: np.ndarray, row: np.ndarray, gap: float, temperature: float) -> float:
    """Impacts a second."""
    sigma = deviation(omega, row, temperature)
    density = math.exp(-0.5 * (gap / sigma) ** 2) / (math.sqrt(2 * math.pi) * sigma * normal(gap / sigma))
    return density * math.sqrt(temperature * float(row @ row) / (2 * math.pi))


def share_below(x: float, gap: float, sigma: float) -> float:
    """Probability of row·η ≤ x ≤ gap."""
    return normal(x / sigma) / normal(gap / sigma)


def kicks(rng: np.random.Generator, count: int, step: float, size: float, width: float) -> tuple:
    """Knots and pieces (2 count, 4) of kicks of r.m.s. ``size`` every ``step``, each a force for a time ``width``."""
    begins = step * np.arange(count + 1)
    knots = np.sort(np.concatenate([begins, begins[:-1] + width]))
    pieces = np.zeros((2 * count, 4))
    pieces[::2, 0] = size / width * rng.normal(size=count)
    return knots, pieces


def remembered(omega: float, rate: float, step: float) -> float:
    """T_eff/T for lines between independent samples ``step`` apart, ``rate`` impacts a second."""
    tau = np.linspace(0.0, 2.0, 4001)
    spline = np.where(tau < 1, 2 / 3 - tau**2 + tau**3 / 2, (2 - tau) ** 3 / 6)
    response = np.cos(omega * step * tau) * (1 - 4 * rate * step * tau)
    return float(np.trapezoid(spline * response, tau) / np.trapezoid(spline, tau))


def spread(values: np.ndarray) -> tuple[float, float]:
    """Mean of batches and its standard error."""
    return float(np.mean(values)), float(np.std(values, ddof=1) / math.sqrt(len(values)))
