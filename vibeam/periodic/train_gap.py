"""Gap between the impacts of a motion with several, from the modal states after each; bounds as in ``gap``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.propagator import pair
from vibeam.periodic.gap import APART, Gap
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Index


@dataclass(frozen=True)
class TrainGap:
    """Flights from impact to impact (m,): drive, duration, the drive's part of the contact just after the impact.

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
        turned = part * np.exp(1j * omega * times)
        drive = part.imag * 2 * np.sin(omega * times / 2) ** 2 - part.real * np.sin(omega * times)
        total = [drive, -omega * turned.real, omega**2 * turned.imag, np.abs(part) * omega**4]
        for i in np.flatnonzero(self.system.contact):
            natural, zeta = float(self.system.omega[i]), float(self.system.zeta[i])
            weight = float(self.system.contact[i])
            mode = _mode(natural, zeta, self.free[which, 0, i], self.free[which, 1, i], times)
            signed = (-weight, -weight, -weight, abs(weight))
            total = [sum_ + sign * row for sum_, sign, row in zip(total, signed, mode, strict=True)]
        return Gap(*total)


def _mode(natural: float, zeta: float, x: Array, y: Array, times: Array) -> Gap:
    """Free mode with stiffness: η − η(0), η', η'' and the bound on η''''."""
    sigma, p = zeta * natural, pair(natural, zeta, times)
    value, slope = p.p01 * y - p.rise * x, p.p10 * x + p.p11 * y
    bend = -2 * sigma * slope - natural**2 * (x + value)
    if zeta > APART:
        fast = sigma + natural * np.sqrt((zeta - 1) * (zeta + 1))
        slow = natural * natural / fast
        sizes = np.abs(fast * x + y) / (fast - slow), np.abs(slow * x + y) / (fast - slow)
        bounds = [size * rate**4 * np.exp(-rate * times) for size, rate in zip(sizes, (slow, fast), strict=True)]
        return Gap(value, slope, bend, bounds[0] + bounds[1])
    third = -2 * sigma * bend - natural**2 * slope
    fourth = -2 * sigma * third - natural**2 * bend
    return Gap(value, slope, bend, np.hypot(fourth, (2 * sigma * fourth + natural**2 * third) / natural))
