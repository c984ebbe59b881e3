"""Analog low-pass filters, causal, for signals known at closely spaced times."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vibeam_models.arrays import Array, Complex

Family = Literal["bessel", "butterworth", "elliptic"]
FAMILIES = get_args(Family)
HIGHEST_ORDER = 10


@dataclass(frozen=True)
class LowPass:
    """Analog low-pass filter of unit gain at 0 Hz.

    ``cutoff`` Hz: where the gain is 1/√2 (Bessel, Butterworth) or leaves the ripple (elliptic). ``ripple`` (pass band)
    and ``attenuation`` (stop band) in dB are the elliptic filter's alone. ValueError names every wrong argument.
    """

    family: Family
    order: int
    cutoff: float
    ripple: float | None = None
    attenuation: float | None = None

    def __post_init__(self) -> None:
        faults = []
        if self.family not in FAMILIES:
            faults.append(f"family: {self.family!r} is none of {', '.join(FAMILIES)}")
        if not 1 <= self.order <= HIGHEST_ORDER:
            faults.append(f"order: {self.order} is outside 1 … {HIGHEST_ORDER}")
        if not (np.isfinite(self.cutoff) and self.cutoff > 0):
            faults.append(f"cutoff: {self.cutoff} Hz is not positive")
        given = (self.ripple, self.attenuation)
        if self.family == "elliptic" and not (None not in given and 0 < given[0] < given[1]):  # type: ignore[operator]
            faults.append("ripple and attenuation: an elliptic filter needs both in dB, 0 < ripple < attenuation")
        if self.family != "elliptic" and given != (None, None):
            faults.append(f"ripple and attenuation: a {self.family} filter has none")
        if faults:
            raise ValueError("; ".join(faults))

    def zpk(self) -> tuple[Complex, Complex, float]:
        """Zeros, poles (rad/s) and gain factor of the transfer function."""
        from scipy import signal

        edge = 2 * np.pi * self.cutoff
        if self.family == "bessel":
            found = signal.bessel(self.order, edge, analog=True, output="zpk", norm="mag")
        elif self.family == "butterworth":
            found = signal.butter(self.order, edge, analog=True, output="zpk")
        else:
            found = signal.ellip(self.order, self.ripple, self.attenuation, edge, analog=True, output="zpk")
        zeros, poles = np.asarray(found[0], dtype=complex), np.asarray(found[1], dtype=complex)
        return zeros, poles, float((np.prod(-poles) / np.prod(-zeros)).real)

    def response(self, frequency: ArrayLike) -> Complex:
        """Complex gain at frequencies in Hz, any shape."""
        zeros, poles, gain = self.zpk()
        s = 2j * np.pi * np.asarray(frequency, dtype=float)[..., None]
        return np.asarray(gain * np.prod(s - zeros, axis=-1) / np.prod(s - poles, axis=-1))

    def delay(self) -> float:
        """Group delay at 0 Hz, s: Σ 1/−pole − Σ 1/−zero."""
        zeros, poles, _ = self.zpk()
        return float((np.sum(-1 / poles) - np.sum(-1 / zeros)).real)

    def settling(self, share: float = 1e-9) -> float:
        """Settling time, s, after which the past has faded to ``share``, from the slowest pole."""
        return float(np.log(share) / np.max(self.zpk()[1].real))


def filtered(low_pass: LowPass, values: Array, step: float) -> Array:
    """Filter output (m,) at times ``step`` s apart, for an input (m,) that is linear between its values.

    Before the first value the input was constant. Exact for such an input: each pole is a section of its own.
    """
    from scipy.signal import lfilter

    poles, residues, direct = _partial_fractions(low_pass)
    result = direct * values
    for pole, residue in zip(poles, residues, strict=True):
        if pole.imag < -1e-9 * abs(pole):
            continue  # factor 2 for the conjugate pole
        z = pole * step
        turn, one, two = np.exp(z), _phi(z, 1), _phi(z, 2)
        held = -values[0] / pole
        start = turn * held + step * (one - two) * values[0]  # contribution of the first sample to the second
        tail, _ = lfilter([step * two, step * (one - two)], [1.0, -turn], values[1:], zi=[start])
        states = np.concatenate([[held], tail])
        result = result + (residue * states).real * (2 if pole.imag > 1e-9 * abs(pole) else 1)
    return np.asarray(result)


def _partial_fractions(low_pass: LowPass) -> tuple[Complex, Complex, float]:
    """Partial fractions of the filter, H(s) = direct + Σ residue/(s − pole); all three families have distinct poles."""
    zeros, poles, gain = low_pass.zpk()
    direct = gain if len(zeros) == len(poles) else 0.0
    differences = poles[:, None] - poles[None, :] + np.eye(len(poles))
    scale = abs(poles[0])  # products of like magnitudes: no overflow at high orders
    top = np.prod((poles[:, None] - zeros[None, :]) / scale, axis=1)
    bottom = np.prod(np.where(np.eye(len(poles), dtype=bool), 1.0, differences / scale), axis=1)
    return poles, gain * top / bottom * scale ** (len(zeros) - len(poles) + 1.0), direct


def _phi(z: complex, k: int) -> complex:
    """φ₁ = (e^z − 1)/z and φ₂ = (e^z − 1 − z)/z², by series where the formula would cancel."""
    if abs(z) < 1:
        return complex(sum(z**j / factorial(j + k) for j in range(20)))
    return complex((np.exp(z) - 1) / z if k == 1 else (np.exp(z) - 1 - z) / z**2)
