"""Ringing between impacts: a damped sinusoid fitted beside the slow part, and the paper's counting of peaks.

x(t) = slow part + Re Σ a e^{(−σ + iω)t} in each interval between impacts. Everything but σ and ω is linear, so for each
(σ, ω) the rest is a linear least-squares problem (variable projection), and only σ and ω are searched for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.observe.slow_motion import SlowPart, fitted, solved
from vibeam_models.arrays import Array, ValueRecord

REACH = 1.5  # factor by which the search may leave its start


@dataclass(frozen=True, eq=False, repr=False)
class Ringing(ValueRecord):
    """Ringing in each interval between impacts, one entry an interval; NaN without a fit, see ``found``.

    ``begin``, ``end`` s: of the samples used. ``frequency`` Hz (damped) and ``decay`` 1/s of the sinusoid;
    ``displacement`` m and ``velocity`` m/s: its peak values at the interval's begin; ``mean_displacement`` and
    ``mean_velocity``: of its envelope over the interval (the paper's "mean peak"); ``residual`` m: rms of the
    misfit of both parts.
    """

    begin: Array
    end: Array
    frequency: Array
    decay: Array
    displacement: Array
    velocity: Array
    mean_displacement: Array
    mean_velocity: Array
    residual: Array

    @property
    def found(self) -> NDArray[np.bool_]:
        """Mask of the intervals with a fit."""
        return np.isfinite(self.frequency)

    @property
    def damping_ratio(self) -> Array:
        """σ/√(σ² + ω²) of each interval."""
        return np.asarray(self.decay / np.hypot(self.decay, 2 * np.pi * self.frequency))


def fit_ringing(
    time: ArrayLike, displacement: ArrayLike, impact_times: ArrayLike, slow: SlowPart, *,
    near: float | None = None, further: int = 0, guard: float = 0.0,
) -> Ringing:  # fmt: skip
    """Fit a damped sinusoid in each interval between impacts of samples (m,) in s and m.

    ``near`` Hz: start of the search; None: the strongest line beside the slow part. ``further``: more
    sinusoids fitted beside it, so that higher modes do not pull it. ``guard`` s: left out after and before impacts
    (a filter's settling; add its delay to the impact times). An interval is not fitted where it has fewer than three
    samples an unknown, and where the best frequency lies beyond a factor of 1.5 from the begin.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(displacement, dtype=float)
    rows = [
        _fit_interval(t[part], x[part], slow, near, further)
        for part in between(t, np.asarray(impact_times, dtype=float), guard)
    ]
    return Ringing(*np.array(rows).reshape(-1, 9).T)


def between(time: Array, impact_times: Array, guard: float) -> list[slice]:
    """Samples of each interval between two impacts within the record, ``guard`` s away from both."""
    hits = np.sort(impact_times)
    hits = hits[(hits >= time[0]) & (hits <= time[-1])]
    first = np.searchsorted(time, hits[:-1] + guard, side="right")
    last = np.searchsorted(time, hits[1:] - guard, side="left")
    return [slice(int(a), int(b)) for a, b in zip(first, last, strict=True) if b > a]


def _fit_interval(t: Array, x: Array, slow: SlowPart, near: float | None, further: int) -> Array:
    blank = np.full(9, np.nan)
    blank[:2] = t[0], t[-1]
    unknowns = slow.size + 4 * (1 + further)
    if len(t) < 3 * unknowns:
        return blank
    clock = t - t[0]
    basis = _orthonormal(slow.columns(clock)[0])
    x = x - basis @ (basis.T @ x)
    rates = _refined_rates(clock, x, basis, near, further)
    if rates is None:
        return blank
    coefficients, left = _linear_fit(rates, clock, x, basis)
    a = complex(coefficients[0], -coefficients[1])
    sigma, omega, span = rates[0].real, rates[0].imag, clock[-1]
    mean = -np.expm1(-sigma * span) / (sigma * span) if abs(sigma * span) > 1e-9 else 1.0
    size, speed = abs(a), abs(a) * np.hypot(sigma, omega)
    residual = np.sqrt(np.mean(left**2))
    return np.array([t[0], t[-1], omega / (2 * np.pi), sigma, size, speed, size * mean, speed * mean, residual])


def _refined_rates(
    clock: Array, x: Array, basis: Array, near: float | None, further: int
) -> NDArray[np.complex128] | None:
    """Refined σ + iω of each sinusoid, the first one first; None where the first leaves its bounds."""
    from scipy.optimize import least_squares

    starts = np.zeros(0)
    rates = np.zeros(0, dtype=complex)
    for turn in range(1 + further):
        left = _linear_fit(rates, clock, x, basis)[1] if len(rates) else x
        omega = 2 * np.pi * near if near is not None and turn == 0 else _strongest(clock, left)
        starts, rates = np.append(starts, omega), np.append(rates, complex(0.02 * omega, omega))
        low, high = np.outer(starts, [-0.5, 1 / REACH]).ravel(), np.outer(starts, [2.0, REACH]).ravel()
        size = float(np.linalg.norm(left)) or 1.0  # misfits in m are too small for the stopping rule of least_squares
        found = least_squares(
            lambda y, size=size: _linear_fit(y[0::2] + 1j * y[1::2], clock, x, basis)[1] / size,
            np.clip(np.stack([rates.real, rates.imag], axis=1).ravel(), low, high), bounds=(low, high),
            x_scale=np.repeat(starts, 2) * 0.1, jac="3-point", xtol=1e-12, ftol=1e-12, gtol=1e-12,
        ).x  # fmt: skip
        rates = found[0::2] + 1j * found[1::2]
        margin = 1e-4 * (high - low)
        if np.any(((found - low < margin) | (high - found < margin))[:2]):
            return None
    return rates


def _linear_fit(rates: NDArray[np.complex128], clock: Array, x: Array, basis: Array) -> tuple[Array, Array]:
    """Linear coefficients of the sinusoids for given rates, and the misfit.

    ``x`` is orthogonal to the slow part's ``basis``; with columns made so too the slow part fits itself.
    """
    turns = np.exp((-rates.real + 1j * rates.imag) * clock[:, None])
    columns = np.stack([turns.real, turns.imag], axis=2).reshape(len(clock), -1)
    columns -= basis @ (basis.T @ columns)
    found = solved(columns, x)
    return found, x - columns @ found


def _orthonormal(columns: Array) -> Array:
    """Orthonormal basis (m, k) of the span of columns (m, k)."""
    return np.asarray(np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0])


def _strongest(clock: Array, left: Array) -> float:
    """Frequency of the highest line of a signal's spectrum, zero-padded fourfold, rad/s."""
    lines = np.abs(np.fft.rfft(left * np.hanning(len(left)), 4 * len(left)))
    lines[:4] = 0.0
    step = clock[-1] / (len(clock) - 1)
    return float(2 * np.pi * np.argmax(lines) / (4 * len(left) * step))


@dataclass(frozen=True, eq=False, repr=False)
class CountedPeaks(ValueRecord):
    """One entry an interval: ``peaks`` counted, ``frequency`` Hz from the first to the last of them (NaN below two),
    ``height``: mean of their absolute values in the signal's unit.
    """

    begin: Array
    end: Array
    peaks: NDArray[np.int64]
    frequency: Array
    height: Array


def count_peaks(
    time: ArrayLike, values: ArrayLike, impact_times: ArrayLike, slow: SlowPart | None = None, *,
    guard: float = 0.0, prominence: float = 0.0, apart: float = 0.0,
) -> CountedPeaks:  # fmt: skip
    """Count maxima of samples (m,) between impacts, as in the paper, after subtracting the slow part where given.

    ``prominence``: share of an interval's range by which a maximum must stand out to be counted, ``apart`` s: the least
    time between two of them; at 0 every wiggle of a higher mode or of noise is one. A frequency read so is off by what
    samples, noise, damping, higher modes and the rest of the slow part move the first and last peak.
    """
    rows = []
    for clock, y in fast_part(time, values, impact_times, slow, guard=guard):
        top = peaks_of(clock, y, prominence, apart)
        span = clock[top[-1]] - clock[top[0]] if len(top) > 1 else np.nan
        height = float(np.mean(np.abs(y[top]))) if len(top) else np.nan
        rows.append((clock[0], clock[-1], len(top), (len(top) - 1) / span, height))
    found = np.array(rows, dtype=float).reshape(-1, 5).T
    return CountedPeaks(found[0], found[1], found[2].astype(np.int64), found[3], found[4])


def fast_part(
    time: ArrayLike, values: ArrayLike, impact_times: ArrayLike, slow: SlowPart | None = None, *, guard: float = 0.0
) -> list[tuple[Array, Array]]:
    """Times and values of each interval between impacts, less the slow part fitted to it; too short ones left out."""
    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    parts = between(t, np.asarray(impact_times, dtype=float), guard)
    if slow is None:
        return [(t[part], x[part]) for part in parts]
    long = [part for part in parts if part.stop - part.start > slow.size]
    return [(t[part], fitted(slow, t[part], x[part], float(t[part][0]))[1]) for part in long]


def peaks_of(clock: Array, values: Array, prominence: float, apart: float) -> NDArray[np.int64]:
    """Indices of the maxima that ``count_peaks`` counts in one interval."""
    from scipy.signal import find_peaks

    step = (clock[-1] - clock[0]) / max(len(clock) - 1, 1)
    least = max(apart / step, 1.0) if step else 1.0
    return np.asarray(find_peaks(values, prominence=prominence * float(np.ptp(values)), distance=least)[0])
