"""Measuring chain of an experiment as an observer of any motion (paper §5: 500 Hz low-pass, 5 kHz).

Sensor → low-pass (analog, causal) → sampling → noise → quantisation → velocity. Stages that a chain does not name are
absent."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vibeam.observe.motion import Path
from vibeam_models.arguments import refuse
from vibeam_models.arrays import Array, Complex, ValueRecord

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
        refuse("", faults)

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


Velocity = Literal["exact", "central differences"]


@dataclass(frozen=True)
class Chain:
    """Measuring chain of a displacement.

    ``rate``: samples a second. ``low_pass``: the analog filter before sampling. ``noise``: rms of white Gaussian noise
    on the samples, m, from ``seed``, which it needs. ``quantum``: the converter's step, m. ``velocity``: by central
    differences of the record, or ``"exact"``: a second, ideal sensor behind the same filter. ``oversampling``: inputs
    of the filter a sample; its error falls with the square. ValueError names every argument that is wrong.
    """

    rate: float
    low_pass: LowPass | None = None
    noise: float | None = None
    seed: int | None = None
    quantum: float | None = None
    velocity: Velocity = "central differences"
    oversampling: int = 16

    def __post_init__(self) -> None:
        faults = []
        for name in ("rate", "noise", "quantum"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                faults.append(f"{name}: {value} is not positive")
        if (self.noise is None) != (self.seed is None):
            faults.append("noise and seed: the one needs the other")
        if self.velocity not in get_args(Velocity):
            faults.append(f"velocity: {self.velocity!r} is none of {', '.join(get_args(Velocity))}")
        if self.oversampling < 1:
            faults.append(f"oversampling: {self.oversampling} is below 1")
        refuse("", faults)


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredRecord(ValueRecord):
    """Evenly spaced samples (m,): ``time`` s, ``displacement`` m, ``velocity`` m/s."""

    time: Array
    displacement: Array
    velocity: Array

    @property
    def rate(self) -> float:
        """Sampling rate, 1/s."""
        return (len(self.time) - 1) / float(self.time[-1] - self.time[0])

    def after(self, t: float) -> MeasuredRecord:
        """Record from time t on, for example without the transient of a filter."""
        kept = self.time >= t
        return MeasuredRecord(self.time[kept], self.displacement[kept], self.velocity[kept])


def measure(path: Path, chain: Chain, output: str = "sensor") -> MeasuredRecord:
    """Measured record of an output, from the motion's start to its end.

    The filter is causal: its output lags by about ``low_pass.delay()``, and starts as if the first value had always
    been there. ValueError for a motion shorter than three samples, KeyError for an unknown output.
    """
    count = int(np.floor((path.t_end - path.t_start) * chain.rate * (1 + 1e-12)))
    if count < 2:
        raise ValueError(f"rate: at {chain.rate} Hz the motion is shorter than three samples")
    fine = chain.oversampling if chain.low_pass is not None else 1
    dense = path.t_start + np.arange(count * fine + 1) / (chain.rate * fine)
    dense = np.minimum(dense, path.t_end)
    displacement = _sampled(path.at(dense, output), chain, fine)
    displacement = _with_noise_and_steps(displacement, chain)
    if chain.velocity == "exact":
        velocity = _sampled(path.velocity_at(dense, output), chain, fine)
    else:
        velocity = central_differences(displacement, 1 / chain.rate)
    return MeasuredRecord(dense[::fine], displacement, velocity)


def central_differences(values: ArrayLike, step: float) -> Array:
    """Central differences (x_{j+1} − x_{j−1})/2h (m,); one-sided differences of first order at both ends."""
    return np.asarray(np.gradient(np.asarray(values, dtype=float), step))


def _sampled(dense: Array, chain: Chain, fine: int) -> Array:
    if chain.low_pass is None:
        return dense
    return filtered(chain.low_pass, dense, 1 / (chain.rate * fine))[::fine]


def _with_noise_and_steps(samples: Array, chain: Chain) -> Array:
    """Samples with the noise and quantisation of the chain."""
    if chain.noise is not None:
        samples = samples + chain.noise * np.random.default_rng(chain.seed).standard_normal(len(samples))
    if chain.quantum is not None:
        samples = chain.quantum * np.round(samples / chain.quantum)
    return samples
