"""Derivatives of a system's modal data by parameters, and of a mode's periodic Green's function by its poles.

With the poles s₁, s₂ = −σ ± √(σ² − ω²) of a mode and the span T, at 0 ≤ τ < T after an impact

    g(τ) = (f(s₁) − f(s₂))/(s₁ − s₂),   f(s) = e^{sτ}/(1 − e^{sT}),   f'(s) = f(s) (τ + T e^{sT}/(1 − e^{sT})),
    dg   = (f'(s₁) ds₁ − f'(s₂) ds₂ − g (ds₁ − ds₂))/(s₁ − s₂),       ds = −dσ ± (σ dσ − ω dω)/√(σ² − ω²),

and g', g'' with s f, s² f in place of f. Below critical damping s₂ is the conjugate of s₁, so that one exponential is
enough. At critical damping the two poles are one and the formula has no value: such modes are refused, as are modes
without stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.periodic.modal_sums import fault
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex

NEARLY = 1e-6  # distance of a damping ratio from 1 below which the closed forms lose accuracy


def derivatives_fault(system: ImpactSystem) -> str:
    """Reason why periodic motions of a system have no closed form with derivatives; empty where they have."""
    if told := fault(system):
        return told
    if (system.omega == 0).any():
        return "a mode without stiffness has no closed form here"
    return "a critically damped mode has no closed form here" if (np.abs(system.zeta - 1) < NEARLY).any() else ""


@dataclass(frozen=True)
class ModalData:
    """Data that periodic motions of a system follow from: modal rows (n,), gap, restitution, drive (points,) in m.

    ``sigma`` is ζω, 1/s; ``row`` the output's.
    """

    omega: Array
    sigma: Array
    contact: Array
    load: Array
    static: Array
    row: Array
    gap: float
    restitution: float
    drive: Array

    @classmethod
    def of(cls, system: ImpactSystem, output: str, drive: Array) -> ModalData:
        """Modal data of a system under base amplitudes ``drive`` (points,) m; KeyError for an unknown output."""
        return cls(
            system.omega, system.zeta * system.omega, system.contact, system.load, system.static, system.output(output),
            system.gap, system.restitution, drive,
        )  # fmt: skip

    @property
    def zeta(self) -> Array:
        """Damping ratios (n,)."""
        return np.asarray(self.sigma / self.omega)

    def driven(self, which: NDArray[np.int64]) -> ModalData:
        """Same data with the drives at the indices ``which``."""
        return replace(self, drive=self.drive[which])

    def packed(self) -> Array:
        """All in one row."""
        rows = (self.omega, self.sigma, self.contact, self.load, self.static, self.row)
        return np.concatenate([*rows, [self.gap, self.restitution], self.drive])

    @classmethod
    def unpacked(cls, row: Array, modes: int) -> ModalData:
        """Modal data of so many modes from ``packed``."""
        omega, sigma, contact, load, static, output = row[: 6 * modes].reshape(6, modes)
        gap, restitution, *_ = row[6 * modes :].tolist()
        return cls(omega, sigma, contact, load, static, output, gap, restitution, row[6 * modes + 2 :])


@dataclass(frozen=True)
class Tangents:
    """Derivatives of ``ModalData`` by P parameters: each of its members with one more axis (P, …) in front."""

    omega: Array
    sigma: Array
    contact: Array
    load: Array
    static: Array
    row: Array
    gap: Array
    restitution: Array
    drive: Array

    def driven(self, which: NDArray[np.int64]) -> Tangents:
        """Same derivatives with the drives at the indices ``which``."""
        return replace(self, drive=self.drive[:, which])

    @classmethod
    def unpacked(cls, rows: Array, modes: int) -> Tangents:
        """Derivatives (P, all) of ``ModalData.packed`` of so many modes."""
        rest = rows[:, 6 * modes :]
        omega, sigma, contact, load, static, row = (rows[:, k * modes : (k + 1) * modes] for k in range(6))
        return cls(omega, sigma, contact, load, static, row, rest[:, 0], rest[:, 1], rest[:, 2:])


def aligned(data: ModalData, like: ModalData) -> ModalData:
    """Same data with the modes' signs, which are arbitrary, as in ``like``."""
    rows = ("contact", "load", "static", "row")
    total = np.zeros(len(data.omega))
    for name in rows:
        one, other = getattr(data, name), getattr(like, name)
        size = float(np.abs(other).max())
        total += one * other / size**2 if size > 0 else 0.0
    sign = np.where(total < 0, -1.0, 1.0)
    return replace(data, **{name: sign * getattr(data, name) for name in rows})


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
