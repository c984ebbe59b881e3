"""Reduction of a system's modes to a few sums a frequency, on which its periodic motions depend.

A mode struck once per span nT answers the impulse p with η_i = p c_i g_i(t), g_i periodic with a unit velocity jump:

    g_i(0) = p01/det(1 − P),   g_i'(0⁺) = (1 − p00)/det(1 − P)                    (periodic Green's function)
    G₀ = Σ c_i² g_i(0),  G₁ = Σ c_i² g_i'(0⁺),  G₂ = Σ c_i² g_i''(0⁻),  S = Σ c_i²

and the drive with Im(H e^{iφ}), H = Σ c_i load_i Ω²B/(ω_i² − Ω² + 2iσ_iΩ) (Babitsky & Krupenin's method). A mode
without stiffness answers only forces without mean: its static force must balance the impulse, s_i nT + c_i p = 0, and
then g_i = t(nT − t)/(2nT) up to a constant, which the contact fixes.
"""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.propagator import Pair, pairs
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex

T = TypeVar("T", np.float64, np.complex128)
PARALLEL = 1e-12  # tolerance for the static force on modes without stiffness to point along the contact


class Transfer(NamedTuple):
    """Sums Σ c_i² of P(λ − P)⁻¹ at one λ: rows 12 and 22, and the damped combinations in the saltation matrix."""

    t12: Array
    t22: Array
    k11: Array  # Σ c²(2σ t12 − t11)
    k21: Array  # Σ c²(2σ t22 − t21)


class Sums(NamedTuple):
    """Sums over the modes, one entry a frequency."""

    omega: Array
    span: Array
    unit: Complex  # H for a base motion of 1 m
    g0: Array
    g1: Array
    g2: Array
    plus: Transfer  # at λ = 1; NaN where a mode has no stiffness
    minus: Transfer  # at λ = −1
    offset: float  # static contact displacement of the modes with stiffness
    fixed: Array | None  # impulse required by the modes without stiffness


def fault(system: ImpactSystem) -> str:
    """Reason why the system has no periodic motion with impacts at any drive; empty where it may."""
    if system.beyond_plain:
        return f"closed-form orbits cannot take {' or '.join(system.beyond_plain)}: simulate or sweep instead"
    free = (system.omega == 0) & ((system.contact != 0) | (system.static != 0))
    if not free.any():
        return ""
    contact, static = system.contact[free], system.static[free]
    share = static @ contact / max(contact @ contact, np.finfo(float).tiny)
    if share <= 0 or np.linalg.norm(static - share * contact) > PARALLEL * np.linalg.norm(static):
        return "omega: a mode without stiffness needs a static force toward the stop, along contact, to come back to it"
    return ""


def resonant(system: ImpactSystem, omega: float, periods: int) -> str:
    """Reason why there is no steady response at this drive; empty where there is one."""
    undamped = (system.omega > 0) & (system.zeta == 0)
    if not undamped.any():
        return ""
    if np.any(undamped & (system.omega == omega) & (system.load != 0)):
        return f"drive: an undamped mode is driven at its own frequency {omega} rad/s and grows without bound"
    turns = system.omega * periods / omega
    if np.any(undamped & (system.contact != 0) & (turns == np.rint(turns))):
        return f"drive: an undamped mode makes a whole number of turns in {periods} periods: impacts make it grow"
    return ""


def sums(system: ImpactSystem, omega: Array, periods: int) -> Sums:
    """Compute the sums at drives ``omega`` (points,) rad/s; the cost is linear in the number of modes."""
    span = 2 * np.pi * periods / omega
    moving = system.contact != 0
    natural, zeta, contact, load = (
        row[moving, None] for row in (system.omega, system.zeta, system.contact, system.load)
    )
    sigma, square = zeta * natural, contact**2
    p = pairs(system.omega[moving], system.zeta[moving], span)
    unit = _total(contact * load * phasor(natural, sigma, omega))
    rows = (*_green(natural, sigma, p, span), *_transfer(p, sigma, 1.0), *_transfer(p, sigma, -1.0))
    if len(omega) == 1:
        g0, g1, g2, *both = _total(square[:, :, None] * np.stack(rows, axis=1))
    else:
        g0, g1, g2, *both = (_total(square * each) for each in rows)
    return Sums(
        omega, span, unit, g0, g1, g2, Transfer(*both[:4]), Transfer(*both[4:]),
        float(system.contact @ offsets(system)), _fixed(system, span),
    )  # fmt: skip


def _total(rows: NDArray[T]) -> NDArray[T]:
    """Sum of rows, added in order: numpy's own sum rounds differently for a single column."""
    return reduce(np.add, rows)


def phasor(natural: float | Array, sigma: float | Array, omega: float | Array) -> Complex:
    """Steady response Ω²/(ω² − Ω² + 2iσΩ) of a mode to a base motion of 1 m."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(omega**2 / ((natural - omega) * (natural + omega) + 2j * sigma * omega))


def offsets(system: ImpactSystem) -> Array:
    """Static displacements (n,), 0 for modes without stiffness."""
    stiff = system.omega > 0
    return np.where(stiff, system.static / np.where(stiff, system.omega, 1.0) ** 2, 0.0)


def green(natural: float | Array, sigma: float | Array, p: Pair) -> tuple[Array, Array]:
    """Periodic Green's function g(0), g'(0⁺) of one mode, or of several as rows; 0 and ½ without stiffness."""
    with np.errstate(divide="ignore", invalid="ignore"):
        g0, g1 = p.p01 / p.closing, p.rise / p.closing
    if np.all(natural):
        return g0, g1
    return np.where(natural == 0, 0.0, g0), np.where(natural == 0, 0.5, g1)


def _green(natural: Array, sigma: Array, p: Pair, span: Array) -> tuple[Array, Array, Array]:
    g0, g1 = green(natural, sigma, p)
    with np.errstate(invalid="ignore"):
        return g0, g1, np.where(natural == 0, -1 / span, -2 * sigma * (g1 - 1) - natural * natural * g0)


def _transfer(p: Pair, sigma: Array, sign: float) -> tuple[Array, Array, Array, Array]:
    """t12, t22, 2σ t12 − t11 and 2σ t22 − t21 of T = P(λ − P)⁻¹ = (λP − det P)/det(λ − P) at λ = ±1."""
    bottom = p.closing if sign > 0 else p.opening
    with np.errstate(divide="ignore", invalid="ignore"):
        t11, t12 = (sign * p.p00 - p.det) / bottom, sign * p.p01 / bottom
        t21, t22 = sign * p.p10 / bottom, (sign * p.p11 - p.det) / bottom
        return t12, t22, 2 * sigma * t12 - t11, 2 * sigma * t22 - t21


def _fixed(system: ImpactSystem, span: Array) -> Array | None:
    free = (system.omega == 0) & (system.contact != 0)
    if not free.any():
        return None
    contact, static = system.contact[free], system.static[free]
    return np.asarray(-span * (static @ contact) / (contact @ contact))
