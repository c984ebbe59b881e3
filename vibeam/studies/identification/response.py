"""Natural frequency, damping and gain of one mode from its forced response, its free decay, or the spectrum of that.

With r = f/f_n and D = √((1 − r²)² + (2ζr)²), amplitudes over frequency are, for a gain g and a drive u,

    base displacement   g u r²/D     base acceleration, force   g u/D     spectrum of a decay   √(a² + b² r²)/D

(eq. 43 of the paper is the first). The last is |X| of X(s) = (s x₀ + v₀ + 2ζω x₀)/(s² + 2ζωs + ω²), of a record that
lasts until the motion has died; one that is cut after T = 1/Δf, Δf the step of the frequencies, has leakage that a note
tells of. Least squares in f_n, ζ and the gain, weighted by the uncertainties where these are given.

A decay is x(t) = e^(−ζωt)(a cos ω_d t + b sin ω_d t) + c, ω_d = ω√(1 − ζ²). Least squares over all samples (maximum
likelihood for white noise). For given ω and ζ the problem is linear in a, b, c (variable projection; Golub & Pereyra,
SIAM J. Numer. Anal. 10 (1973)), so that two parameters are searched. Started at the peak of the spectrum and at the
slope of the envelope, the modulus of the analytic signal, whose logarithmic decrement is what Fig. 30(a) of the paper
reads; that is told beside it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from vibeam.studies.identification.estimates import Identification, by_logarithms, estimates, spread_of
from vibeam_models.arrays import Array
from vibeam_models.memory import check_room

DRIVES = ("base displacement", "base acceleration", "force")
CUT = 0.02  # share of the motion left at the end of a record from which on its spectrum leaks
REMAINS = 0.05  # residual, relative to the largest value, from which on it is no single linear mode
A_POINT = 340.0  # bytes of memory of a fit, measured
NEAR = 0.15  # share of the peak from which on a spectrum is fitted: below, noise has a floor
Shape = Callable[[Array, Array], Array]


def identify_response(
    frequency: ArrayLike, amplitude: ArrayLike, *, drive: str = "base displacement", level: float = 1.0,
    uncertainty: ArrayLike | None = None,
) -> Identification:  # fmt: skip
    """Natural frequency (Hz), damping ratio and gain (unit of amplitude over ``level``'s) from a forced response (n,).

    ``level``: amplitude of the drive, in m, m/s², N or V, the same at all frequencies. ``uncertainty``: standard
    deviations (n,) or one; None: taken from the scatter. The gain includes the mode's value at the sensor. ValueError
    for what is no response.

    >>> import numpy as np
    >>> import vibeam
    >>> ratio = np.linspace(0.5, 1.5, 101)
    >>> found = vibeam.identify_response(10.0 * ratio, ratio**2 / np.abs(1 - ratio**2 + 0.04j * ratio))
    >>> {row.name: round(row.value, 4) for row in found.rows}
    {'natural frequency': 10.0, 'damping ratio': 0.02, 'gain': 1.0}
    """
    if drive not in DRIVES:
        raise ValueError(f"drive: {drive!r} is none of {', '.join(DRIVES)}")
    if not (np.isfinite(level) and level > 0):
        raise ValueError(f"level: {level!r} is not above 0")
    f, a, u = _checked(frequency, amplitude, uncertainty, 4)

    def shape(at: Array, p: Array) -> Array:
        r = at / p[0]
        return np.asarray(level * p[2] * (r**2 if drive == DRIVES[0] else 1.0) / _dynamic(r, p[1]))

    peak = int(np.argmax(a))
    ratio = _half_power(f, a)
    start = np.array([f[peak], ratio, a[peak] * 2 * ratio / level])
    names = ("natural frequency", "damping ratio", "gain")
    return _fitted((f, a, u), shape, start, names, ("Hz", "1", "amplitude/level"), f"eq. 43 of a {drive}, fitted")


def identify_spectrum(
    frequency: ArrayLike, magnitude: ArrayLike, *, uncertainty: ArrayLike | None = None
) -> Identification:
    """Natural frequency (Hz) and damping ratio from the spectrum (n,) of a decay: magnitudes, without a window.

    Points above 15 % of the peak are fitted, around it. ValueError for what is no spectrum.

    >>> import numpy as np
    >>> import vibeam
    >>> ratio = np.linspace(0.5, 1.5, 101)
    >>> found = vibeam.identify_spectrum(10.0 * ratio, 1 / np.abs(1 - ratio**2 + 0.04j * ratio))
    >>> {row.name: round(row.value, 4) for row in found.rows}
    {'natural frequency': 10.0, 'damping ratio': 0.02}
    """
    f, a, u = _checked(frequency, magnitude, uncertainty, 5)
    inside = _around_peak(a)
    f, a, u = f[inside], a[inside], None if u is None else u[inside]
    if len(f) < 5:
        raise ValueError(f"{len(f)} points above {100 * NEAR:.0f} % of the peak: a longer record is needed")

    def shape(at: Array, p: Array) -> Array:
        r = at / p[0]
        return np.asarray(np.sqrt(p[2] ** 2 + (p[3] * r) ** 2) / _dynamic(r, p[1]))

    peak, ratio = int(np.argmax(a)), _half_power(f, a)
    size = a[peak] * np.sqrt(2) * ratio
    names = ("natural frequency", "damping ratio")
    best = min(
        (_least_squares((f, a, u), shape, np.array([f[peak], ratio, *parts]) ) for parts in
         ((size, size), (2**0.5 * size, 0.1 * size), (0.1 * size, 2**0.5 * size))), key=lambda each: each[1]
    )  # fmt: skip
    found = _fitted(
        (f, a, u), shape, best[0], names, ("Hz", "1"), "the spectrum of a decaying cosine, fitted", equal=True
    )
    return _with_leakage(found, float(np.min(np.diff(f))))


def _with_leakage(found: Identification, step: float) -> Identification:
    """A note where the record ends before the motion has died."""
    frequency, ratio = found["natural frequency"].value, found["damping ratio"].value
    left = float(np.exp(-2 * np.pi * frequency * ratio / step))
    if not left > CUT:
        return found
    said = f"after {1 / step:.3g} s, the length of the record by its lines, {100 * left:.2g} % of the motion are left"
    return replace(found, notes=(*found.notes, f"{said}: damping is too high by leakage; take the decay itself"))


def _dynamic(r: Array, ratio: float) -> Array:
    return np.asarray(np.hypot(1 - r**2, 2 * ratio * r))


def usable(values: Array) -> bool:
    """Test whether values are finite, and 0 or such that the fourth power of the largest is a number."""
    return bool(1e-60 <= np.max(np.abs(values), initial=0.0) <= 1e60 or not np.any(values))


def _checked(
    frequency: ArrayLike, amplitude: ArrayLike, uncertainty: ArrayLike | None, least: int
) -> tuple[Array, Array, Array | None]:
    f, a = _of_one_shape(frequency=frequency, amplitude=amplitude)
    if len(f) < least:
        raise ValueError(f"{len(f)} points are too few: {least} are needed")
    if not (usable(f) and usable(a) and (f >= 0).all() and (a >= 0).all()):
        raise ValueError(f"every frequency and amplitude must be a finite number, not below 0{RANGE}")
    if not a.max() > 0 or np.ptp(f) == 0:
        raise ValueError("there is no response in it: all amplitudes are 0, or all frequencies the same")
    if f[np.argmax(a)] == 0:
        raise ValueError("the largest value is at 0 Hz: there is no peak in it")
    order = np.argsort(f)
    if uncertainty is None:
        return f[order], a[order], None
    u = np.broadcast_to(np.asarray(uncertainty, dtype=float), f.shape)
    if not (usable(u) and (u > 0).all()):
        raise ValueError(f"every uncertainty must be a finite number above 0{RANGE}")
    return f[order], a[order], u[order]


def _of_one_shape(**columns: ArrayLike) -> tuple[Array, Array]:
    """Two columns (n,) by their names; ValueError where they are none, or where there is no room for a fit to them."""
    one, other = (np.asarray(each, dtype=float) for each in columns.values())
    if one.ndim != 1 or one.shape != other.shape:
        said = " and ".join(f"{name} {each.shape}" for name, each in zip(columns, (one, other), strict=True))
        raise ValueError(f"{said} must be of one shape (n,)")
    check_room(f"a fit to {len(one)} points", A_POINT * len(one), "cut the record, or take every second point of it")
    return one, other


def _half_power(f: Array, a: Array) -> float:
    """Damping ratio by the width at the half of the power, for a start."""
    above = f[a > a.max() / np.sqrt(2)]
    width = max(float(np.ptp(above)), float(np.median(np.diff(f))))
    return float(np.clip(width / (2 * f[np.argmax(a)]), 1e-4, 0.5))


def _around_peak(a: Array) -> slice:
    """The neighbours of the peak above the share that is fitted."""
    peak, low = int(np.argmax(a)), a < NEAR * a.max()
    before, after = np.flatnonzero(low[:peak]), np.flatnonzero(low[peak:])
    return slice(int(before[-1]) + 1 if len(before) else 0, peak + int(after[0]) if len(after) else len(a))


Data = tuple[Array, Array, Array | None]


def _least_squares(data: Data, shape: Shape, start: Array) -> tuple[Array, float]:
    """Parameters by their logarithms, and the sum of squares."""
    from scipy.optimize import least_squares

    f, a, u = data
    weight = 1 / a.max() if u is None else 1 / u
    found = least_squares(
        lambda p: weight * (shape(f, np.exp(p)) - a), np.log(start), x_scale=np.r_[1e-3, np.full(len(start) - 1, 0.1)],
        bounds=(np.log(start) - 14, np.log(start) + 14), xtol=1e-13, ftol=1e-14, gtol=1e-14,
    )  # fmt: skip
    return np.exp(found.x), float(found.cost)


def _fitted(
    data: Data, shape: Shape, start: Array, names: tuple[str, ...], units: tuple[str, ...], method: str, *,
    equal: bool = False,
) -> Identification:  # fmt: skip
    f, a, u = data
    values, _ = _least_squares(data, shape, start)
    jacobian, residual = by_logarithms(lambda p: shape(f, p), values), a - shape(f, values)
    if u is None:
        spread = spread_of(jacobian, residual, names, equal=equal)
    else:
        spread = spread_of(jacobian / u[:, None], None, names)
    left = float(np.sqrt(np.mean(residual**2)) / a.max())
    rows = estimates(names, values[: len(names)].tolist(), spread.half, units)
    return Identification(rows, method, len(f), left, spread.directions, tuple(_remains(left)))


def _remains(left: float) -> list[str]:
    """Note on the share of the largest value that no single linear mode explains."""
    told = f"{100 * left:.2g} % of the largest value remain: this is no single linear mode"
    return [told] if left > REMAINS else []


LEAST = 16  # samples
RANGE = "; the largest lies between 1e-60 and 1e+60 in its unit"
CORRELATED = 0.3  # correlation of neighbouring residuals from which on noise is not white


def identify_decay(time: ArrayLike, displacement: ArrayLike) -> Identification:
    """Natural frequency (Hz) and damping ratio from a decay (n,) in s and any unit, with 95 % intervals.

    The intervals hold for white noise. ValueError for what is no decay: too few samples, times that do not ascend,
    numbers that are not finite, a motion that does not decay.

    >>> import numpy as np
    >>> import vibeam
    >>> time = np.linspace(0.0, 2.0, 2001)
    >>> row = vibeam.identify_decay(time, np.exp(-0.5 * time) * np.cos(50.0 * time)).rows[0]
    >>> row.name, round(row.value, 3)  # 50/2π Hz
    ('natural frequency', 7.958)
    """
    t, x = _checked_decay(time, displacement)
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
    notes += _remains(left)
    if abs(correlation) > CORRELATED and left > 1e-6:
        told = f"neighbouring residuals are correlated ({correlation:+.2f})"
        notes.append(f"{told}: the noise is not white, and the intervals are too narrow")
    return tuple(notes)


def _checked_decay(time: ArrayLike, displacement: ArrayLike) -> tuple[Array, Array]:
    t, x = _of_one_shape(time=time, displacement=displacement)
    if len(t) < LEAST:
        raise ValueError(f"a decay of {len(t)} samples is too short: {LEAST} are needed")
    if not (usable(t) and usable(x)):
        raise ValueError(f"every time and displacement must be a finite number{RANGE}")
    if not (np.diff(t) > 0).all():
        raise ValueError("the times must ascend")
    if np.ptp(x) == 0:
        raise ValueError("the displacement is constant: there is no motion in it")
    return t - t[0], x / 2.0 ** np.frexp(np.max(np.abs(x)))[1]  # exact; tolerances of the fit are absolute


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
