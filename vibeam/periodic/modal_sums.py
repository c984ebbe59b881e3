"""Reduction of a system's modes to a few sums a frequency; impulse and phase of its periodic motions by them.

A mode struck once per span nT answers the impulse p with η_i = p c_i g_i(t), g_i periodic with a unit velocity jump:

    g_i(0) = p01/det(1 − P),   g_i'(0⁺) = (1 − p00)/det(1 − P)                    (periodic Green's function)
    G₀ = Σ c_i² g_i(0),  G₁ = Σ c_i² g_i'(0⁺),  G₂ = Σ c_i² g_i''(0⁻),  S = Σ c_i²

and the drive with Im(H e^{iφ}), H = Σ c_i load_i Ω²B/(ω_i² − Ω² + 2iσ_iΩ) (Babitsky & Krupenin's method). A mode
without stiffness answers only forces without mean: its static force must balance the impulse, s_i nT + c_i p = 0, and
then g_i = t(nT − t)/(2nT) up to a constant, which the contact fixes.

Of a motion with one impact a span impulse and phase follow from one equation:

    contact at the impact:      Im(H e^{iψ}) = Δ − p G₀,        Δ = gap less the static contact displacement
    restitution:              Ω Re(H e^{iψ}) = p κ,             κ = R S/(1 + R) − G₁
    hence              (Δ − p G₀)² + (p κ/Ω)² = |H|²

a quadratic in p for any number of modes. It never degenerates to a linear one: its leading coefficient G₀² + (κ/Ω)²
vanishes only together with the middle one, ΔG₀.
"""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.flight.linear.propagator import Pair, pairs
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arguments import count, floats, refuse, require
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
    """Reason why the system has no closed-form motion with impacts at any drive; empty where it may."""
    if system.beyond_plain:
        what = " or ".join(system.beyond_plain)
        return f"closed-form orbits cannot take {what}: vibeam.orbits finds its motions, vibeam.follow follows them"
    free = (system.omega == 0) & ((system.contact != 0) | (system.static != 0))
    if not free.any():
        return ""
    contact, static = system.contact[free], system.static[free]
    share = static @ contact / max(contact @ contact, np.finfo(float).tiny)
    if share <= 0 or np.linalg.norm(static - share * contact) > PARALLEL * np.linalg.norm(static):
        return "omega: a mode without stiffness needs a static force toward the stop, along contact, to come back to it"
    return ""


def checked(system: ImpactSystem, omega: ArrayLike, periods: int) -> Array:
    """Return the frequencies as an array; ValueError where no closed form is defined."""
    require("system", system, ImpactSystem)
    grid = np.atleast_1d(floats("omega", omega))
    if grid.ndim != 1 or not np.all(np.isfinite(grid) & (grid > 0)):
        raise ValueError("omega: must be positive frequencies in rad/s")
    faults: list[str] = []
    count("periods", periods, faults, least=1)
    refuse("", faults)
    reason = fault(system)
    if reason:
        raise ValueError(reason)
    return grid


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


def green(natural: float | Array, p: Pair) -> tuple[Array, Array]:
    """Periodic Green's function g(0), g'(0⁺) of one mode, or of several as rows; 0 and ½ without stiffness."""
    with np.errstate(divide="ignore", invalid="ignore"):
        g0, g1 = p.p01 / p.closing, p.rise / p.closing
    if np.all(natural):
        return g0, g1
    return np.where(natural == 0, 0.0, g0), np.where(natural == 0, 0.5, g1)


def _green(natural: Array, sigma: Array, p: Pair, span: Array) -> tuple[Array, Array, Array]:
    g0, g1 = green(natural, p)
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


DOUBLE = 16 * 2.220446049250313e-16  # relative round-off of a discriminant: the root counts as double


class Roots(NamedTuple):
    """Both roots, (points, 2), the lower impulse first; NaN where they are complex.

    A motion strikes the stop where ``impulse`` < 0. ``discriminant`` (points,) is that of the quadratic, < 0 where
    there is no root; ``relative_acceleration``: contact acceleration over velocity just before impact, 1/s.
    """

    impulse: Array
    phase: Array
    velocity: Array
    relative_acceleration: Array
    discriminant: Array


def balance(system: ImpactSystem, sums: Sums, amplitude: ArrayLike, gap: ArrayLike) -> Roots:
    """Solve for both roots at every frequency of ``sums``; ``amplitude`` and ``gap``, m, one number or one a point."""
    response = np.asarray(sums.unit * np.asarray(amplitude, dtype=float))
    restitution, mobility = system.restitution, system.mobility
    turn = (restitution * mobility / (1 + restitution) - sums.g1) / sums.omega
    clear = np.broadcast_to(np.asarray(gap, dtype=float) - sums.offset, sums.omega.shape)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if sums.fixed is None:
            impulse, discriminant = _quadratic(sums.g0, turn, clear, np.abs(response))
            height = clear[:, None] - impulse * sums.g0[:, None]
        else:
            impulse, height, discriminant = _without_stiffness(sums.fixed, turn, np.abs(response))
        phase = np.arctan2(height, impulse * turn[:, None]) - np.angle(response)[:, None]
        velocity = system.impact_velocity(impulse)
        toward = -(sums.omega**2)[:, None] * height + impulse * sums.g2[:, None]
        return Roots(impulse, np.mod(phase, 2 * np.pi), velocity, toward / velocity, discriminant)


def _quadratic(g0: Array, turn: Array, clear: Array, size: Array) -> tuple[Array, Array]:
    """Roots of (g0² + turn²) p² − 2 clear g0 p + clear² − size² = 0, both to round-off, and its discriminant."""
    lead, middle = g0**2 + turn**2, clear * g0
    last = (clear - size) * (clear + size)
    long, short = size * np.sqrt(lead), np.abs(clear * turn)
    discriminant = (long - short) * (long + short)
    discriminant = np.where(np.abs(discriminant) <= DOUBLE * long**2, 0.0, discriminant)
    root = np.sqrt(discriminant)
    large = middle + np.copysign(root, middle)
    near, far = np.where(large == 0, 0.0, last / np.where(large == 0, 1.0, large)), large / lead
    below = np.signbit(middle)  # sign by copysign: −0 counts as negative, at no gap
    first, second = np.where(below, far, near), np.where(below, near, far)
    return np.stack([first, second], axis=1), discriminant


def _without_stiffness(impulse: Array, turn: Array, size: Array) -> tuple[Array, Array, Array]:
    """Roots with modes without stiffness, where the impulse is given: drive part ±√(size² − (turn p)²)."""
    discriminant = (size - np.abs(turn * impulse)) * (size + np.abs(turn * impulse))
    root = np.sqrt(discriminant)
    both = np.where(np.isnan(root), np.nan, impulse)
    return np.stack([both, both], axis=1), np.stack([-root, root], axis=1), discriminant
