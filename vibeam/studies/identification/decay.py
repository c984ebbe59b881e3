"""Natural frequency and damping from a free decay: x(t) = e^(−ζωt)(a cos ω_d t + b sin ω_d t) + c, ω_d = ω√(1 − ζ²).

Least squares over all samples (maximum likelihood for white noise). For given ω and ζ the problem is linear in a, b, c
(variable projection; Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973)), so that two parameters are searched. Started at
the peak of the spectrum and at the slope of the envelope, the modulus of the analytic signal, whose logarithmic
decrement is what Fig. 30(a) of the paper reads; that is told beside it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vibeam.studies.identification.estimates import Identification, by_logarithms, estimates, spread_of
from vibeam_models.arrays import Array

LEAST = 16  # samples
CORRELATED = 0.3  # correlation of neighbouring residuals from which on noise is not white
REMAINS = 0.05  # residual, relative to the largest value, from which on it is no single linear mode


def identify_decay(time: ArrayLike, displacement: ArrayLike) -> Identification:
    """Natural frequency (Hz) and damping ratio from a decay (n,) in s and any unit, with 95 % intervals.

    The intervals hold for white noise. ValueError for what is no decay: too few samples, times that do not ascend,
    numbers that are not finite, a motion that does not decay.
    """
    t, x = _checked(time, displacement)
    frequency, envelope = _first_guess(t, x)
    start = min(((f, z) for f in _around(frequency, t) for z in (envelope, 0.3 * envelope, 3 * envelope)),
                key=lambda each: float(np.sum(_left(t, x, *each) ** 2)))  # fmt: skip
    from scipy.optimize import least_squares

    found = least_squares(
        lambda p: _left(t, x, *np.exp(p)), np.log(start), x_scale=[1e-3, 0.1], xtol=1e-13, ftol=1e-14, gtol=1e-14
    )
    frequency, ratio = np.exp(found.x)
    if not 1e-7 < ratio < 0.9:
        raise ValueError("the motion does not decay as one mode does: take a record from the release to rest")
    basis = _basis(t, frequency, ratio)
    linear = np.linalg.lstsq(basis, x, rcond=None)[0]
    shape = by_logarithms(lambda p: _basis(t, *p) @ linear, np.array([frequency, ratio]))
    residual = x - basis @ linear
    names = ("natural frequency", "damping ratio")
    spread = spread_of(np.hstack([shape, basis]), residual, names, equal=True)
    rows = estimates(names, (float(frequency), float(ratio)), spread.half, ("Hz", "1"))
    left = float(np.sqrt(np.mean(residual**2)) / np.max(np.abs(x - linear[2])))
    method = "a decaying cosine fitted to the decay"
    return Identification(rows, method, len(t), left, spread.directions, _notes(residual, left, envelope))


def _notes(residual: Array, left: float, envelope: float) -> tuple[str, ...]:
    notes = [f"the slope of the envelope alone gives a damping ratio of {envelope:.3g}"]
    correlation = float(np.corrcoef(residual[1:], residual[:-1])[0, 1]) if np.ptp(residual) > 0 else 0.0
    if left > REMAINS:
        notes.append(f"{100 * left:.2g} % of the largest value remain: this is no single linear mode")
    if abs(correlation) > CORRELATED and left > 1e-6:
        told = f"neighbouring residuals are correlated ({correlation:+.2f})"
        notes.append(f"{told}: the noise is not white, and the intervals are too narrow")
    return tuple(notes)


def _checked(time: ArrayLike, displacement: ArrayLike) -> tuple[Array, Array]:
    t, x = np.asarray(time, dtype=float), np.asarray(displacement, dtype=float)
    if t.ndim != 1 or t.shape != x.shape:
        raise ValueError(f"time {t.shape} and displacement {x.shape} must be of one shape (n,)")
    if len(t) < LEAST:
        raise ValueError(f"a decay of {len(t)} samples is too short: {LEAST} are needed")
    if not (np.isfinite(t).all() and np.isfinite(x).all()):
        raise ValueError("every time and displacement must be a finite number")
    if not (np.diff(t) > 0).all():
        raise ValueError("the times must ascend")
    if np.ptp(x) == 0:
        raise ValueError("the displacement is constant: there is no motion in it")
    return t - t[0], x


def _first_guess(t: Array, x: Array) -> tuple[float, float]:
    """Frequency at the peak of the spectrum, and the damping ratio by the slope of the envelope."""
    from scipy.signal import hilbert

    even = np.linspace(0.0, t[-1], len(t))
    signal = np.interp(even, t, x)
    signal = signal - np.mean(signal[len(signal) // 2 :])
    step, padded = even[1], 8 * len(even)
    power = np.abs(np.fft.rfft(signal, padded))
    frequency = float(np.fft.rfftfreq(padded, step)[1 + np.argmax(power[1:])])
    size = np.abs(hilbert(signal))
    inside = slice(len(size) // 50, len(size) - len(size) // 20)  # the ends of an analytic signal are wrong
    size, at = size[inside], even[inside]
    low = max(0.1 * float(size.max()), 3 * float(np.median(np.abs(np.diff(signal, 2)))) if len(t) < 64 else 0.0)
    first = int(np.argmax(size < low)) if (size < low).any() else len(size)
    used = slice(0, max(first, 8))
    slope = -float(np.polyfit(at[used], np.log(size[used]), 1)[0])
    return frequency, float(np.clip(slope / (2 * np.pi * frequency), 1e-5, 0.5))


def _around(frequency: float, t: Array) -> list[float]:
    """Frequencies to start from, within two lines of the spectrum."""
    line = 1 / t[-1]
    return [each for each in frequency + line * np.linspace(-2, 2, 17) if each > 0.1 * frequency]


def _basis(t: Array, frequency: float, ratio: float) -> Array:
    """Functions (n, 3) that a decay is a linear combination of."""
    omega = 2 * np.pi * frequency
    ratio = min(ratio, 0.999)
    size, phase = np.exp(-ratio * omega * t), omega * np.sqrt(1 - ratio**2) * t
    return np.stack([size * np.cos(phase), size * np.sin(phase), np.ones_like(t)], axis=1)


def _left(t: Array, x: Array, frequency: float, ratio: float) -> Array:
    """Residual (n,) after the best a, b, c."""
    basis = np.linalg.qr(_basis(t, frequency, ratio))[0]
    return np.asarray(x - basis @ (basis.T @ x))
