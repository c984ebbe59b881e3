"""Natural frequency and damping of a free decay, and the stretch of a record in which it is free.

A decay is x(t) = Σ_k e^(−ζ_kω_kt)(a_k cos ω_dk t + b_k sin ω_dk t) + c, ω_d = ω√(1 − ζ²). Least squares over all
samples (maximum likelihood for white noise). For given ω and ζ the problem is linear in a, b, c (variable projection;
Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973)), so that two parameters of each mode are searched. Started at the peak
of the spectrum and at the slope of the envelope, the modulus of the analytic signal, whose logarithmic decrement is
what Fig. 30(a) of the paper reads; that is told beside it.

Before the release a record is at rest, held, driven or struck; later it may be struck again. From a part that is surely
free the fit is followed to both sides, as far as its residual there is as small: the rest is cut, and said.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam.extensions.identification.response import (
    CORRELATED,
    RANGE,
    SAMPLE,
    notes_on,
    numbered,
    require_room,
    usable,
)
from vibeam.studies.fit.linear_estimates import Identification, by_logarithms, correlation, estimates, spread_of
from vibeam.studies.measured_panel import MeasuredCurve
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array

LEAST = 16  # samples
CLIPPED = 3  # equal samples in a row at an end of the range that are cut off
MOST_CLIPPED = 0.3  # share of samples
A_SAMPLE = 1200.0  # bytes of memory of a fit, measured
MOST = 3  # modes of a decay
SMALL = 0.05  # share of the first mode's amplitude below which a further one is none
BETTER = 10.0  # by which Schwarz' criterion falls for a further mode
ROUGH = (3.0, 0.02)  # residual of an eighth of a record over the usual one, and over the motion, that is no noise
ALIKE = 6.0  # deviation from the fit, over half of those in a stretch, from which on a sample does not follow it
ROOMS = (*[0.1] * 24, *[0.01] * 6)  # and over the motion, while a stretch grows by a third at a time, and at last
CYCLES = 3.0  # of a stretch, at least
WRONG = 0.15  # share of a motion that is left, from which on it is refused
FADED = 0.97  # of its first amplitude that a motion has at its end at most, to be a decay


def identify_decay(time: ArrayLike, displacement: ArrayLike) -> Identification:
    """Natural frequency (Hz) and damping ratio from a decay (n,) in s and any unit, with 95 % intervals.

    What is before the release, or after a second event, is cut, and said in a note. The intervals hold for white
    noise. ValueError for what is no decay: too few samples, times that do not ascend, numbers that are not finite, a
    motion that does not decay.

    >>> import numpy as np
    >>> import vibeam
    >>> time = np.linspace(0.0, 2.0, 2001)
    >>> row = vibeam.identify_decay(time, np.exp(-0.5 * time) * np.cos(50.0 * time)).rows[0]
    >>> row.name, round(row.value, 3)  # 50/2π Hz
    ('natural frequency', 7.958)
    """
    t, x = _checked(time, displacement)
    clipped = _clipped(x)
    if np.mean(clipped) > MOST_CLIPPED:
        raise ValueError(f"{np.mean(clipped):.0%} of the samples are cut off at an end of the range: lower the gain")
    t, x = t[~clipped], x[~clipped]
    start = float(np.asarray(time, dtype=float)[0])
    first, last = _free(t, x)
    seen = {
        f"{counted(int(np.sum(clipped)), 'sample')} cut off at an end of the range: left out": clipped.any(),
        f"the decay is taken from {start + t[first]:.4g} s on: before it is rest, or another motion": first,
        f"from {start + t[last - 1]:.4g} s on another event follows: it is cut": last < len(t),
    }
    begun, t, x = t[first], t[first:last] - t[first], x[first:last]
    envelope = _first_guess(t, x)[1]
    poles = _poles(t, x)
    if not ((poles[:, 1] > 1e-7) & (poles[:, 1] < 0.9)).any():
        raise ValueError("the motion does not decay as one mode does: take a record from the release to rest")
    basis = _basis(t, poles)
    linear = np.linalg.lstsq(basis, x, rcond=None)[0]
    shape = by_logarithms(lambda p: _basis(t, p.reshape(-1, 2)) @ linear, poles.ravel())
    residual = x - basis @ linear
    names = numbered(SAMPLE, len(poles))
    spread = spread_of(np.hstack([shape, basis]), residual, names, equal=True)
    rows = estimates(names, poles.ravel().tolist(), spread.half, ("Hz", "1") * len(poles))
    left = float(np.sqrt(np.mean(residual**2)) / max(float(np.max(np.abs(x - linear[-1]))), 1e-300))
    method = f"{'a decaying cosine' if len(poles) == 1 else f'{len(poles)} decaying cosines'} fitted to the decay"
    notes = [f"the slope of the envelope alone gives a damping ratio of {envelope:.3g}"]
    notes += [each for each, there in seen.items() if there]
    if left > 1 or (left > WRONG and (first, last) == (0, len(t))):
        told = f"one decay leaves {100 * left:.2g} % of it, and no stretch of it is one by itself"
        raise ValueError(f"the record is not a free decay: {told}: take it from the release to rest, --from and --to")
    notes += notes_on(residual, left)
    stretch = start + float(begun), start + float(begun + t[-1])
    curve = _curve(time, displacement, np.flatnonzero(~clipped)[first:last], (poles, linear))
    return Identification(rows, method, len(t), left, spread.directions, tuple(notes), stretch=stretch, curve=curve)


def _curve(time: ArrayLike, displacement: ArrayLike, kept: Any, fit: tuple[Array, Array]) -> MeasuredCurve:
    """The record, its samples that are ``kept``, and the decay with these poles and weights from the first to the last.

    Also between those that are cut off, whose size it shows.
    """
    at, value = np.asarray(time, dtype=float), np.asarray(displacement, dtype=float)
    used, between = np.zeros(len(at), dtype=bool), slice(kept[0], kept[-1] + 1)
    used[kept] = True
    model = _basis(at[between] - at[kept[0]], fit[0]) @ fit[1]
    return MeasuredCurve(at, value, used, (at[between], _unit(value) * model), timed=True)


def _unit(x: Array) -> float:
    """Power of 2 that a record is divided by: exact, and tolerances of the fit are absolute."""
    return float(2.0 ** np.frexp(np.max(np.abs(x)))[1])


def _checked(time: ArrayLike, displacement: ArrayLike) -> tuple[Array, Array]:
    t, x = np.asarray(time, dtype=float), np.asarray(displacement, dtype=float)
    if t.ndim != 1 or t.shape != x.shape:
        raise ValueError(f"time {t.shape} and displacement {x.shape} must be of one shape (n,)")
    require_room(len(t), A_SAMPLE)
    if len(t) < LEAST:
        raise ValueError(f"a decay of {counted(len(t), 'sample')} is too short: {LEAST} are needed")
    if not (usable(t) and usable(x)):
        raise ValueError(f"every time and displacement must be a finite number{RANGE}")
    if not (np.diff(t) > 0).all():
        raise ValueError("the times must ascend")
    if np.ptp(x) == 0:
        raise ValueError("the displacement is constant: there is no motion in it")
    return t - t[0], x / _unit(x)


def _clipped(x: Array) -> Any:
    """Samples (n,) that lie cut off at an end of the range: several equal ones in a row, reached by a step."""
    found = np.zeros(len(x), dtype=bool)
    steps = np.abs(np.diff(x))
    step = CLIPPED * float(np.min(steps[steps > 0]))
    for end in (x.max(), x.min()):
        edges = np.flatnonzero(np.diff(np.r_[0, x == end, 0])).reshape(-1, 2)
        for one, other in edges[(edges[:, 0] > 0) & (edges[:, 1] < len(x))]:  # one at an end of the record is held
            found[one:other] = other - one >= CLIPPED and max(steps[one - 1], steps[other - 1]) > step
    return found


def _free(t: Array, x: Array) -> tuple[int, int]:
    """First and last but one sample of the free decay: all, or the stretch with most of the motion."""
    if _follows(t, x, _poles(t, x)):
        return 0, len(x)
    size = (x - _rest(x)) ** 2
    found = [_grown(t, x, seed) for seed in _seeds(x) if seed[1] - seed[0] >= LEAST]
    return max(filter(None, found), key=lambda each: float(np.sum(size[slice(*each)])), default=(0, len(x)))


def _rest(x: Array) -> float:
    """Value about which the last quarter moves."""
    return float(np.median(x[-max(len(x) // 4, 4) :]))


def _follows(t: Array, x: Array, poles: Array) -> bool:
    """Test whether a record is one decay throughout: what is left is noise, in no eighth more than in the others."""
    left = _left(t, x, poles)
    rough = np.array([np.sqrt(np.mean(part**2)) for part in np.array_split(left, 8)])
    small = ROUGH[1] * float(np.max(np.abs(x - _rest(x))))
    white = abs(correlation(left)) < CORRELATED
    return bool(rough.max() <= small or (white and rough.max() <= ROUGH[0] * np.median(rough)))


def _seeds(x: Array) -> list[tuple[int, int]]:
    """Parts that may begin in the decay: after the last large values of more or less of the record, and later ones."""
    size, ends = np.abs(x - _rest(x)), [int(share * len(x)) for share in (1.0, 0.75, 0.5)]
    found = [(int(np.flatnonzero(size[:end] > 0.5 * np.max(size[:end]))[-1]), end) for end in ends]
    return [*found, (int(np.argmax(size)), len(x)), (len(x) // 2, len(x))]


def _grown(t: Array, x: Array, seed: tuple[int, int]) -> tuple[int, int] | None:
    """Stretch (first, last) around a seed that one decay goes on over; None where there is none."""
    begin, end = seed
    cycle = 1 / _first_guess(t[begin:end] - t[begin], x[begin:end])[0]
    first = int(np.searchsorted(t, t[begin] + cycle / 2))
    last = max(int(np.searchsorted(t, t[min(first, len(t) - 1)] + CYCLES * cycle)), first + LEAST)
    if last > len(t):
        return None
    poles = _one(t[first:last], x[first:last])
    known: tuple[int, int, float] | None = None
    for room in ROOMS:
        off = np.flatnonzero(_off(t, x, (first, last), poles, cycle, room))
        middle, reach = (first + last) // 2, max((last - first) // 3, 4)
        low, high = off[off < middle], off[off >= middle]
        first = max(first - reach, int(low[-1]) + 1 if len(low) else 0)
        last = min(last + reach, int(high[0]) if len(high) else len(x))
        if last - first < LEAST:
            return None
        if (first, last, room) == known:
            continue
        known = first, last, room
        poles = _one(t[first:last], x[first:last], poles)
    part = t[first:last] - t[first], x[first:last]
    size = np.exp(-2 * np.pi * poles[0, 0] * poles[0, 1] * part[0][-1])
    lasting = part[0][-1] * poles[0, 0] >= CYCLES and size < FADED
    return (first, last) if lasting and _follows(*part, poles) else None


def _off(t: Array, x: Array, stretch: tuple[int, int], poles: Array, cycle: float, room: float) -> Array:
    """Samples (n,) that depart from the decay fitted to a stretch, most in a quarter of a cycle with them."""
    part, omega, ratio = slice(*stretch), 2 * np.pi * poles[0, 0], poles[0, 1]
    since = np.maximum(t - t[part][0], -20 / max(ratio * omega, 1e-300))
    inside = _basis(since, poles)
    linear = np.linalg.lstsq(inside[part], x[part], rcond=None)[0]
    away = np.abs(x - inside @ linear)
    size = np.hypot(linear[0], linear[1]) * np.exp(-ratio * omega * since)
    wrong = away > np.maximum(ALIKE * float(np.median(away[part])), room * size)
    width = max(int(0.25 * cycle / np.median(np.diff(t))), 1)
    many = np.convolve(wrong, np.ones(width), "same") > 0.5 * width
    return np.asarray(wrong & many)


def _poles(t: Array, x: Array) -> Array:
    """Frequencies in Hz and damping ratios (k, 2) of the modes, ascending: as many as Schwarz' criterion bears out."""
    found = _one(t, x)
    for _ in range(1, MOST):
        left = _left(t, x, found)
        size, line = float(np.sum(left**2)), 1 / t[-1] if t[-1] else 1.0
        if size <= (1e-9 * len(x) ** 0.5 * float(np.max(np.abs(x)))) ** 2:
            break
        guess, ratio = _first_guess(t, left)[0], found[0, 1]
        starts = [np.vstack([found, (each, ratio)]) for each in (guess, found[0, 0] + line, found[0, 0] - line)]
        tried = [_searched(t, x, each) for each in starts if each[-1, 0] > line]
        more = min(tried, key=lambda each: float(np.sum(_left(t, x, each) ** 2)), default=found)
        gain = len(x) * np.log(size / max(float(np.sum(_left(t, x, more) ** 2)), 1e-300)) - 4 * np.log(len(x))
        if gain < BETTER or not _apart(t, x, more):
            break
        found = more
    return found[np.argsort(found[:, 0])]


def _apart(t: Array, x: Array, poles: Array) -> bool:
    """Test whether all modes have a part in the motion, swing more than once, and decay."""
    linear = np.linalg.lstsq(_basis(t, poles), x, rcond=None)[0]
    size = np.hypot(linear[:-1:2], linear[1:-1:2])
    swinging = (poles[:, 0] * t[-1] > 1) & (poles[:, 1] < 0.2)
    return bool(swinging.all() and size.min() > SMALL * size.max() and size.max() < 10 * np.max(np.abs(x)))


def _one(t: Array, x: Array, poles: Array | None = None) -> Array:
    """Pole (1, 2) of one mode, from ``poles`` or from what the record shows."""
    t = t - t[0]
    frequency, envelope = _first_guess(t, x) if poles is None else poles[0]
    lines = np.linspace(-2, 2, 17 if poles is None else 5) / t[-1]
    tried = [(frequency + line, share * envelope) for line in lines for share in (1, 0.3, 3)]
    starts = [np.array([each]) for each in tried if each[0] > 0.1 * frequency]
    return _searched(t, x, min(starts, key=lambda each: float(np.sum(_left(t, x, each) ** 2))))


def _searched(t: Array, x: Array, start: Array) -> Array:
    """Poles of the least squares from where the search starts."""
    from scipy.optimize import least_squares

    found = least_squares(
        lambda p: _left(t, x, _exp(p)), np.log(start.ravel()), max_nfev=200,
        x_scale=np.tile([1e-3, 0.1], len(start)), xtol=1e-13, ftol=1e-14, gtol=1e-14,
    )  # fmt: skip
    return _exp(found.x)


def _exp(p: Array) -> Array:
    return np.exp(np.clip(p.reshape(-1, 2), -40, 40))


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
    slope = -float(np.polyfit(at[used], np.log(np.maximum(size[used], 1e-300)), 1)[0])
    return frequency, float(np.clip(slope / (2 * np.pi * frequency), 1e-5, 0.5))


def _basis(t: Array, poles: Array) -> Array:
    """Functions (n, 2k + 1) that a decay is a linear combination of."""
    found = []
    for frequency, ratio in poles:
        omega, ratio = 2 * np.pi * frequency, min(ratio, 0.999)
        size, phase = np.exp(-ratio * omega * t), omega * np.sqrt(1 - ratio**2) * t
        found += [size * np.cos(phase), size * np.sin(phase)]
    return np.stack([*found, np.ones_like(t)], axis=1)


def _left(t: Array, x: Array, poles: Array) -> Array:
    """Residual (n,) after the best a, b, c."""
    basis = np.linalg.qr(_basis(t, poles))[0]
    return np.asarray(x - basis @ (basis.T @ x))
