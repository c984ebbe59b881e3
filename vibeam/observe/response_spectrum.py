"""Spectra of random responses by Welch's method, over an ensemble, with intervals.

The periodograms of K overlapping segments of a record are correlated: with the window w, shifted by D samples each,
c_m = (Σ w_n w_{n+mD} / Σ w_n²)², their mean has ν = 2K/(1 + 2 Σ_m (1 − m/K) c_m) degrees of freedom (Welch 1967;
Percival & Walden 1993, eq. 292b), those of independent records add up, and ν Ŝ/S has the distribution χ²_ν where
segments are long against what resonances remember. Intervals are for each frequency by itself. The mean is taken off
each segment, so that there is no line at 0 Hz; samples show what is above half their rate folded below it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam_models.arguments import count, floats, number, refuse
from vibeam_models.arrays import Array, Complex, ValueRecord

SEGMENTS = 8  # of a record, where their length is not given
LEAST = 8  # samples of a segment
FEWEST = 4.0  # degrees of freedom below which there is no interval of a transfer function


class SpectralRecord(ValueRecord):
    """Record of spectral lines with intervals, as it is shown."""

    frequency: Array
    freedom: Array
    level: float

    def __repr__(self) -> str:
        span = f"{self.frequency[0]:.6g} … {self.frequency[-1]:.6g} Hz, {len(self.frequency)} lines"
        sure = f"{self.freedom[0]:.0f} degrees of freedom, intervals of {100 * self.level:g} %"
        return f"{type(self).__name__}({span}, {sure})"


@dataclass(frozen=True, eq=False, repr=False)
class ResponseSpectrum(SpectralRecord):
    """One-sided power spectral ``density`` (f,), unit²/Hz, at ``frequency`` (f,), Hz.

    ``low`` and ``high`` (f,): interval that holds it with the probability ``level``; ``freedom`` (f,): ν.

    >>> import numpy, vibeam
    >>> noise = numpy.random.default_rng(1).normal(size=(10, 4096))
    >>> found = vibeam.observe.response_spectrum(noise, 2.0, segment=256)
    >>> found, 0.9 < float(numpy.mean((found.low < 1.0) & (1.0 < found.high))) <= 1.0  # 1 unit²/Hz
    (ResponseSpectrum(0.0078125 … 1 Hz, 128 lines, 591 degrees of freedom, intervals of 95 %), True)
    """

    frequency: Array
    density: Array
    low: Array
    high: Array
    freedom: Array
    level: float


@dataclass(frozen=True, eq=False, repr=False)
class TransferFunction(SpectralRecord):
    """Linear part of an output, ``gain`` (f,) complex times the input, by H₁ = S_xy/S_xx; ``coherence`` γ² (f,).

    ``radius`` (f,): of the circle about ``gain`` that holds it with the probability ``level`` (Bendat & Piersol 2010,
    eq. 9.85); ``coherence_low`` and ``coherence_high`` (f,) by Fisher's transformation.
    What is not coherent is noise, leakage between lines, or not linear: impacts.
    """

    frequency: Array
    gain: Complex
    radius: Array
    coherence: Array
    coherence_low: Array
    coherence_high: Array
    freedom: Array
    level: float


@dataclass(frozen=True, eq=False, repr=False)
class SpectrumRatio(SpectralRecord):
    """Density of one response over that of another, ``ratio`` (f,), both of the same realisations.

    ``low`` and ``high`` (f,): interval with the probability ``level``. What both share leaves the ratio alone: its
    logarithm has the variance 4 (1 − γ²)/ν, γ² their coherence, so that like models are told apart by short records.
    """

    frequency: Array
    ratio: Array
    low: Array
    high: Array
    freedom: Array
    level: float


@dataclass(frozen=True)
class WelchEstimate:
    """Welch's method: ``rate`` of the samples, Hz, ``segment`` and ``step`` in samples, the window's weights."""

    rate: float
    segment: int
    step: int
    weights: Array
    records: int
    length: int

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the mean over all segments of all records, but at half the rate, where it is half."""
        segments = 1 + (self.length - self.segment) // self.step
        shifts = np.arange(1, min(segments, -(-self.segment // self.step)))
        w = self.weights
        shared = np.array([float(w[m * self.step :] @ w[: len(w) - m * self.step]) for m in shifts]) / float(w @ w)
        return float(self.records * 2 * segments / (1 + 2 * np.sum((1 - shifts / segments) * shared**2)))

    def freedoms(self, frequency: Array) -> Array:
        """Degrees of freedom (f,) at each frequency."""
        return np.where(np.isclose(frequency, self.rate / 2), self.freedom / 2, self.freedom)

    def density(self, first: Array, second: Array) -> tuple[Array, Any]:
        """Frequencies (f,), Hz, without 0, and the mean cross density (f,) of records (m, n)."""
        from scipy import signal

        frequency, found = signal.csd(
            first, second, self.rate, window=self.weights, nperseg=self.segment, noverlap=self.segment - self.step
        )  # fmt: skip
        return frequency[1:], found.mean(axis=0)[1:]


def response_spectrum(
    values: ArrayLike, rate: float, *, segment: int | None = None, overlap: float = 0.5, window: str = "hann",
    level: float = 0.95,
) -> ResponseSpectrum:  # fmt: skip
    """Density of a record (n,) or an ensemble (m, n) sampled ``rate`` times a second, with χ² intervals.

    ``segment``: its samples, an eighth of a record where None; ``overlap``: the share of a segment that the next one
    has too; ``window``: any name that scipy.signal knows. ValueError names all that is wrong.
    """
    from scipy import special

    (rows,), method = _welch((values,), rate, segment, overlap, window, level)
    frequency, density = method.density(rows, rows)
    freedom = method.freedoms(frequency)
    tails = (1 + level) / 2, (1 - level) / 2
    low, high = (freedom * density.real / special.chdtri(freedom, 1 - share) for share in tails)
    return ResponseSpectrum(frequency, density.real, low, high, freedom, level)


def transfer_function(
    base: ArrayLike, output: ArrayLike, rate: float, *, segment: int | None = None, overlap: float = 0.5,
    window: str = "hann", level: float = 0.95,
) -> TransferFunction:  # fmt: skip
    """Transfer function and coherence from an input to an output of the same realisations (n,) or (m, n).

    Arguments and errors as ``response_spectrum``; ValueError also for fewer than 4 degrees of freedom.
    """
    from scipy import special

    (first, second), method = _welch((base, output), rate, segment, overlap, window, level)
    frequency, crossed = method.density(first, second)
    freedom = method.freedoms(frequency)
    if freedom.min() < FEWEST:
        raise ValueError(f"segment: {freedom.min():.1f} degrees of freedom are too few: shorter segments, more records")
    power, driven = method.density(second, second)[1].real, method.density(first, first)[1].real
    coherence = np.minimum(np.abs(crossed) ** 2 / (power * driven), 1.0)
    spread = 2 / (freedom - 2) * special.fdtri(2, freedom - 2, level)
    half = np.arctanh(np.minimum(np.sqrt(coherence), 1 - 1e-15)) - 1 / (freedom - 2)
    width = special.ndtri((1 + level) / 2) / np.sqrt(freedom - 2)
    return TransferFunction(
        frequency, crossed / driven, np.sqrt(spread * (1 - coherence) * power / driven), coherence,
        np.tanh(np.maximum(half - width, 0.0)) ** 2, np.tanh(np.maximum(half + width, 0.0)) ** 2, freedom, level,
    )  # fmt: skip


def spectrum_ratio(
    first: ArrayLike, second: ArrayLike, rate: float, *, segment: int | None = None, overlap: float = 0.5,
    window: str = "hann", level: float = 0.95,
) -> SpectrumRatio:  # fmt: skip
    """Ratio of the densities of two responses to the same realisations, with intervals.

    Arguments and errors as ``response_spectrum``.

    >>> import numpy, vibeam
    >>> noise = numpy.random.default_rng(1).normal(size=8192)
    >>> found = vibeam.observe.spectrum_ratio(1.1 * noise, noise, 2.0)
    >>> bool(numpy.allclose(found.ratio, 1.21)), bool(numpy.allclose(found.low, found.high))  # nothing but a factor
    (True, True)
    """
    from scipy import special

    (one, other), method = _welch((first, second), rate, segment, overlap, window, level)
    frequency, above = method.density(one, one)
    below = method.density(other, other)[1].real
    freedom = method.freedoms(frequency)
    coherence = np.minimum(np.abs(method.density(one, other)[1]) ** 2 / (above.real * below), 1.0)
    width = special.ndtri((1 + level) / 2) * 2 * np.sqrt((1 - coherence) / freedom)
    ratio = above.real / below
    return SpectrumRatio(frequency, ratio, ratio * np.exp(-width), ratio * np.exp(width), freedom, level)


def _welch(
    signals: tuple[ArrayLike, ...], rate: float, segment: int | None, overlap: float, window: str, level: float
) -> tuple[list[Array], WelchEstimate]:
    """Records (m, n) of each signal and the method for them; ValueError with every fault."""
    from scipy.signal import get_window

    faults: list[str] = []
    rows = [np.atleast_2d(floats("values", each)) for each in signals]
    if any(each.ndim != 2 or not np.isfinite(each).all() or each.shape != rows[0].shape for each in rows):
        faults.append("values: must be finite, (n,) or (m, n) for m records, and alike for all signals")
    length = rows[0].shape[-1]
    rate = number("rate", rate, faults, above=0.0)
    share, within = number("overlap", overlap, faults, least=0.0), number("level", level, faults, above=0.0)
    faults += [f"overlap: {share:g} must be below 1"] if share >= 1 else []
    faults += [f"level: {within:g} must be below 1"] if within >= 1 else []
    samples = length // SEGMENTS if segment is None else segment
    samples = count("segment", samples, faults, least=LEAST)
    if samples > length:
        faults.append(f"segment: {samples} samples are more than a record has, {length}")
    weights = np.ones(1)
    try:
        weights = np.asarray(get_window(window, max(samples, 1)), dtype=float)
    except ValueError as reason:
        faults.append(f"window: {reason}")
    refuse("spectrum", faults)
    step = max(1, samples - round(share * samples))
    return rows, WelchEstimate(rate, samples, step, weights, len(rows[0]), length)
