"""Gap between two impacts as a function of time, with a bound on its fourth derivative: one impact a span, or several.

Of motions with one, at τ after it, with H e^{iφ} = y + ix (φ the drive phase at the impact) and G of ``modal_sums``,

    d(τ) = Δ − u(τ) = x (1 − cos Ωτ) − y sin Ωτ − p (G(τ) − G(0)),

0 at both ends of the span. Every mode's g obeys g'' + 2σg' + ω²g = 0, and so do its derivatives z, whose z² + (z'/ω)²
never grows: |g''''| after τ is bounded by its value and the fifth derivative at τ. Two decays far apart are bounded
one by one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.propagator import pair, pairs
from vibeam.periodic.modal_sums import Roots, Sums, green
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index

APART = 1.2  # damping ratio from which the two decays of a mode are bounded separately
AT_ONCE = 200_000  # numbers of an array of several modes at most


class Gap(NamedTuple):
    """Gap d and its first two derivatives at some times, and a bound on |d''''| from there to the end of the span."""

    value: Array
    slope: Array
    bend: Array
    fourth: Array


@dataclass(frozen=True)
class SpanGap:
    """Gap of several motions of one system with one impact a span, each (motions,).

    Drive, span, the drive's part y + ix of the contact, impulse.
    """

    system: ImpactSystem
    omega: Array
    span: Array
    part: NDArray[np.complex128]
    impulse: Array
    start: Array  # g(0) and g'(0⁺) of every mode (n, 2, motions)

    @classmethod
    def of(cls, system: ImpactSystem, total: Sums, roots: Roots, amplitude: Array, branch: int) -> SpanGap:
        """Gap of one branch."""
        modes = zip(system.omega, system.zeta, strict=True)
        start = np.array([green(natural, pair(natural, zeta, total.span)) for natural, zeta in modes])
        part = total.unit * amplitude * np.exp(1j * roots.phase[:, branch])
        return cls(system, total.omega, total.span, part, roots.impulse[:, branch], start)

    def __len__(self) -> int:
        return len(self.omega)

    def chosen(self, which: Index) -> SpanGap:
        """Motions at the indices ``which``."""
        omega, span, part, impulse = self.omega[which], self.span[which], self.part[which], self.impulse[which]
        return SpanGap(self.system, omega, span, part, impulse, self.start[:, :, which])

    def gap(self, which: Index, times: Array) -> Gap:
        """Gap of the motions ``which`` (m,) at ``times`` (m,) after the impact, 0 ≤ τ ≤ span."""
        omega, part, impulse = self.omega[which], self.part[which], self.impulse[which]
        driven, free = _driven(omega, part, times), self._green(which, times)
        signed = (-impulse, -impulse, -impulse, np.abs(impulse))
        return Gap(*(one + sign * other for one, sign, other in zip(driven, signed, free, strict=True)))

    def _green(self, which: Index, times: Array) -> Gap:
        """Green's function G − G(0), G', G'' and the bound on G''''."""
        system, total = self.system, np.zeros((4, len(times)))
        modes = np.flatnonzero(system.contact)
        swinging = (system.omega > 0) & (system.zeta < 1) & (len(modes) * len(times) <= AT_ONCE)
        some = modes[swinging[modes]]
        if len(some):
            weights = system.contact[some] ** 2
            together = _swinging(system.omega[some], system.zeta[some], self.start[some][:, :, which], times)
            total += np.stack([weights @ each for each in together])
        for i in modes[~swinging[modes]]:
            natural, zeta = float(system.omega[i]), float(system.zeta[i])
            mode = _mode(natural, zeta, self.start[i][:, which], times, self.span[which])
            total += system.contact[i] ** 2 * np.stack(mode)
        return Gap(*total)


def _driven(omega: Array, part: NDArray[np.complex128], times: Array) -> Gap:
    """The drive's part of the gap."""
    turned = part * np.exp(1j * omega * times)
    versine = 2 * np.sin(omega * times / 2) ** 2
    drive = part.imag * versine - part.real * np.sin(omega * times)
    return Gap(drive, -omega * turned.real, omega**2 * turned.imag, np.abs(part) * omega**4)


def _swinging(natural: Array, zeta: Array, start: Array, times: Array) -> Gap:
    """As ``_mode``, of several underdamped modes (n,) at once: every field (n, times)."""
    p, natural, sigma = pairs(natural, zeta, times), natural[:, None], (zeta * natural)[:, None]
    first, second = start[:, 0], start[:, 1]
    value, slope = p.p01 * second - p.rise * first, p.p10 * first + p.p11 * second
    return Gap(value, slope, *_derivatives(natural, sigma, first, value, slope))


def _derivatives(natural: Any, sigma: Any, first: Array, value: Array, slope: Array) -> tuple[Array, Array]:
    """The second derivative of modes, and the bound on the fourth where they swing."""
    bend = -2 * sigma * slope - natural**2 * (first + value)
    third = -2 * sigma * bend - natural**2 * slope
    fourth = -2 * sigma * third - natural**2 * bend
    fifth = -2 * sigma * fourth - natural**2 * third
    return bend, np.hypot(fourth, fifth / natural)


def _mode(natural: float, zeta: float, start: Array, times: Array, span: Array) -> Gap:
    """One mode's g − g(0), g', g'' and the bound on g''''; without stiffness g = t(nT − t)/(2nT) + const."""
    if natural == 0:
        return Gap(times / 2 - times**2 / (2 * span), 0.5 - times / span, -1 / span, np.zeros_like(times))
    mode = _free_mode(natural, zeta, start[0], start[1], times)
    return mode._replace(fourth=_two_decays(natural, zeta, times, span)) if zeta > APART else mode


def _two_decays(natural: float, zeta: float, times: Array, span: Array) -> Array:
    """Overdamped mode: g = (e^{−st}/(1 − e^{−snT}) − e^{−ft}/(1 − e^{−fnT}))/(f − s), each decay bounded separately."""
    fast = zeta * natural + natural * np.sqrt((zeta - 1) * (zeta + 1))
    slow = natural * natural / fast
    parts = [rate**4 * np.exp(-rate * times) / -np.expm1(-rate * span) for rate in (slow, fast)]
    return np.asarray((parts[0] + parts[1]) / (fast - slow))


@dataclass(frozen=True)
class TrainGap:
    """Gap of flights from impact to impact (m,): drive, duration, the drive's part of the contact just after it.

    ``free`` (m, 2, n): free part of each mode's displacement and velocity, without the response to drive and load.
    """

    system: ImpactSystem
    omega: Array
    span: Array
    part: NDArray[np.complex128]
    free: Array

    def __len__(self) -> int:
        return len(self.omega)

    def gap(self, which: Index, times: Array) -> Gap:
        """Gap d of the flights ``which`` (k,) at ``times`` (k,) after their first impact."""
        omega, part = self.omega[which], self.part[which]
        total: Iterable[Array] = _driven(omega, part, times)
        for i in np.flatnonzero(self.system.contact):
            natural, zeta = float(self.system.omega[i]), float(self.system.zeta[i])
            weight = float(self.system.contact[i])
            mode = _free_mode(natural, zeta, self.free[which, 0, i], self.free[which, 1, i], times)
            signed = (-weight, -weight, -weight, abs(weight))
            total = [sum_ + sign * row for sum_, sign, row in zip(total, signed, mode, strict=True)]
        return Gap(*total)


def _free_mode(natural: float, zeta: float, x: Array, y: Array, times: Array) -> Gap:
    """Free mode with stiffness: η − η(0), η', η'' and the bound on η''''."""
    sigma, p = zeta * natural, pair(natural, zeta, times)
    value, slope = p.p01 * y - p.rise * x, p.p10 * x + p.p11 * y
    bend, fourth = _derivatives(natural, sigma, x, value, slope)
    if zeta > APART:
        fast = sigma + natural * np.sqrt((zeta - 1) * (zeta + 1))
        slow = natural * natural / fast
        sizes = np.abs(fast * x + y) / (fast - slow), np.abs(slow * x + y) / (fast - slow)
        bounds = [size * rate**4 * np.exp(-rate * times) for size, rate in zip(sizes, (slow, fast), strict=True)]
        fourth = bounds[0] + bounds[1]
    return Gap(value, slope, bend, fourth)
