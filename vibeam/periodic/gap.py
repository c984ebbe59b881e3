"""Gap of flights from impact to impact as a function of time, with a bound on its fourth derivative.

With H e^{iφ} = y + ix (φ the drive's phase at the impact) and the free part z of each mode, at τ after the impact

    d(τ) = Δ − u(τ) = x (1 − cos Ωτ) − y sin Ωτ − Σ c (z(τ) − z(0)),

0 at both ends of the flight. Of a motion with one impact a span z = p c g, g of ``modal_sums``. Every z obeys
z'' + 2σz' + ω²z = 0, and so do its derivatives, whose z² + (z'/ω)² never grows: |z''''| after τ is bounded by its value
and the fifth derivative at τ. Two decays far apart are bounded one by one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from vibeam.flight.linear.propagator import pair, pairs
from vibeam.periodic.modal_sums import Roots, Sums, green
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex, Index

APART = 1.2  # damping ratio from which the two decays of a mode are bounded separately
AT_ONCE = 200_000  # numbers of an array of several modes at most


class Gap(NamedTuple):
    """Gap d and its first two derivatives at some times, and a bound on |d''''| from there to the end of the span."""

    value: Array
    slope: Array
    bend: Array
    fourth: Array


@dataclass(frozen=True)
class FlightGap:
    """Gap of flights (flights,) of one system: drive, duration, the drive's part y + ix of the contact at the impact.

    ``free`` (n, 2, flights): free part of each mode's displacement and velocity just after it, without the response to
    the drive and, of modes with stiffness, to the load.
    """

    system: ImpactSystem
    omega: Array
    span: Array
    part: Complex
    free: Array

    @classmethod
    def of(cls, system: ImpactSystem, total: Sums, roots: Roots, amplitude: Array, branch: int) -> FlightGap:
        """Gap of one branch of motions with one impact a span."""
        start = np.stack(green(system.omega[:, None], pairs(system.omega, system.zeta, total.span)), axis=1)
        part = total.unit * amplitude * np.exp(1j * roots.phase[:, branch])
        kicks = system.contact[:, None, None] * roots.impulse[:, branch]
        return cls(system, total.omega, total.span, part, kicks * start)

    def __len__(self) -> int:
        return len(self.omega)

    def chosen(self, which: Index) -> FlightGap:
        """Flights at the indices ``which``."""
        return FlightGap(self.system, self.omega[which], self.span[which], self.part[which], self.free[:, :, which])

    def gap(self, which: Index, times: Array) -> Gap:
        """Gap of the flights ``which`` (m,) at ``times`` (m,) after the impact, 0 ≤ τ ≤ span."""
        system, total = self.system, list(_driven(self.omega[which], self.part[which], times))
        modes = np.flatnonzero(system.contact)
        swinging = (system.omega > 0) & (system.zeta < 1) & (len(modes) * len(times) <= AT_ONCE)
        some = modes[swinging[modes]]
        if len(some):
            c = system.contact[some]
            rows = _swinging(system.omega[some], system.zeta[some], self.free[some][:, :, which], times)
            total = [
                sum_ + weight @ row for sum_, weight, row in zip(total, (-c, -c, -c, np.abs(c)), rows, strict=True)
            ]
        for i in modes[~swinging[modes]]:
            one, rows = float(system.contact[i]), self._mode(i, which, times)
            signed = (-one, -one, -one, abs(one))
            total = [sum_ + weight * row for sum_, weight, row in zip(total, signed, rows, strict=True)]
        return Gap(*total)

    def _mode(self, i: int, which: Index, times: Array) -> Gap:
        """One mode's z − z(0), z', z'' and the bound on z''''; without stiffness a fall."""
        natural, zeta, fall = float(self.system.omega[i]), float(self.system.zeta[i]), float(self.system.static[i])
        x, y = self.free[i][:, which]
        if natural == 0:
            zero = np.zeros_like(times)
            return Gap(y * times + fall * times**2 / 2, y + fall * times, zero + fall, zero)
        return _free_mode(natural, zeta, x, y, times)


def _driven(omega: Array, part: Complex, times: Array) -> Gap:
    """The drive's part of the gap."""
    turned = part * np.exp(1j * omega * times)
    versine = 2 * np.sin(omega * times / 2) ** 2
    drive = part.imag * versine - part.real * np.sin(omega * times)
    return Gap(drive, -omega * turned.real, omega**2 * turned.imag, np.abs(part) * omega**4)


def _swinging(natural: Array, zeta: Array, free: Array, times: Array) -> Gap:
    """As ``_free_mode``, of several underdamped modes (n,) at once: every field (n, times)."""
    p, natural, sigma = pairs(natural, zeta, times), natural[:, None], (zeta * natural)[:, None]
    first, second = free[:, 0], free[:, 1]
    value, slope = p.p01 * second - p.rise * first, p.p10 * first + p.p11 * second
    return Gap(value, slope, *_derivatives(natural, sigma, first, value, slope))


def _derivatives(natural: Any, sigma: Any, first: Array, value: Array, slope: Array) -> tuple[Array, Array]:
    """The second derivative of modes, and the bound on the fourth where they swing."""
    bend = -2 * sigma * slope - natural**2 * (first + value)
    third = -2 * sigma * bend - natural**2 * slope
    fourth = -2 * sigma * third - natural**2 * bend
    fifth = -2 * sigma * fourth - natural**2 * third
    return bend, np.hypot(fourth, fifth / natural)


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
