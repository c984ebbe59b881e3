"""Harmonics and subharmonics of a motion (paper Fig. 20)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.motion import Path, last_periods
from vibeam.observe.quadrature import integral
from vibeam_models.arrays import Array, Complex


@dataclass(frozen=True)
class Harmonics:
    """x(t) ≈ Re Σ amplitude·e^{i·order·Ωt}, the drive's phase being 0 at t = 0.

    ``order`` (m,): multiples of the drive frequency, ascending, 0 first; ``frequency`` (m,) Hz; ``amplitude`` (m,)
    complex, in m: of order 0 the mean, of the others a sine's peak value and phase.
    """

    order: Array
    frequency: Array
    amplitude: Complex

    def of(self, order: float) -> complex:
        """Amplitude of one order; KeyError for an order not computed."""
        found = np.flatnonzero(np.abs(self.order - order) < 1e-9)
        if not len(found):
            raise KeyError(f"no order {order}: there are {', '.join(f'{k:g}' for k in self.order)}")
        return complex(self.amplitude[found[0]])

    @property
    def distortion(self) -> float:
        """Total harmonic distortion: the root of Σ|X_k|² over whole orders k ≥ 2, over |X₁|; NaN without a first."""
        whole = (np.abs(self.order - np.round(self.order)) < 1e-9) & (self.order > 1.5)
        first = abs(self.of(1))
        return float(np.linalg.norm(self.amplitude[whole]) / first) if first else float("nan")

    @property
    def subharmonics(self) -> float:
        """Root of Σ|X|² over the orders that are not whole numbers, m: 0 where the motion repeats every period."""
        return float(np.linalg.norm(self.amplitude[np.abs(self.order - np.round(self.order)) > 1e-9]))


def harmonic_amplitudes(
    path: Path, output: str = "sensor", *, periods: int = 1, highest: int = 8, subdivision: int = 1
) -> Harmonics:
    """Harmonics of order 0, 1/m, 2/m … ``highest`` (m = ``subdivision``) of an output over the last drive ``periods``.

    X_k = 2/T ∫ x e^{−ikΩt} dt, of order 0 half of it, to round-off: see ``quadrature``. ValueError for ``periods`` that
    are no multiple of ``subdivision`` or more than available, KeyError for an unknown output.
    """
    order = _orders(highest, subdivision)
    if periods % subdivision:
        raise ValueError(f"periods: {periods} are no multiple of the subdivision {subdivision}")
    path.system.derivative(output)  # KeyError for an unknown one
    begin, end = last_periods(path, periods)
    omega = path.drive.omega

    def turned(t: Array) -> Complex:
        return np.asarray(path.at(t, output)[:, None] * np.exp(-1j * omega * t[:, None] * order))

    amplitude: Complex = integral(path, begin, end, turned, highest=highest * omega)
    amplitude *= 2 / (end - begin)
    amplitude[0] /= 2
    return Harmonics(order, order * omega / (2 * np.pi), amplitude)


def sampled_harmonics(
    time: ArrayLike, values: ArrayLike, omega: float, *, highest: int = 8, subdivision: int = 1
) -> Harmonics:
    """Harmonics of samples (m,) at any times, by least squares; ``omega``: of the drive, rad/s.

    Samples need not fill whole periods. ValueError for fewer samples than unknowns or times over less than
    ``subdivision`` drive periods, which cannot tell the orders apart.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    order = _orders(highest, subdivision)
    if t.shape != x.shape or t.ndim != 1 or len(t) < 2 * len(order):
        raise ValueError(f"samples: times {t.shape} and values {x.shape} must be one row of {2 * len(order)} or more")
    step = float(np.ptp(t)) / (len(t) - 1)
    if not omega > 0 or np.ptp(t) + step < subdivision * 2 * np.pi / omega * (1 - 1e-9):
        raise ValueError(f"samples: they must span {subdivision} drive periods or more")
    angles = omega * np.outer(t, order[1:])
    columns = np.concatenate([np.ones((len(t), 1)), np.cos(angles), np.sin(angles)], axis=1)
    found = np.linalg.lstsq(columns, x, rcond=None)[0]
    m = len(order) - 1
    return Harmonics(order, order * omega / (2 * np.pi), np.append(found[0], found[1 : m + 1] - 1j * found[m + 1 :]))


def _orders(highest: int, subdivision: int) -> Array:
    if highest < 1 or subdivision < 1:
        raise ValueError(f"highest {highest} and subdivision {subdivision} must be ≥ 1")
    return np.arange(highest * subdivision + 1) / subdivision
