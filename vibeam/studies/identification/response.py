"""Natural frequency, damping and gain of one mode from its forced response or the spectrum of its decay.

With r = f/f_n and D = √((1 − r²)² + (2ζr)²), amplitudes over frequency are, for a gain g and a drive u,

    base displacement   g u r²/D     base acceleration, force   g u/D     spectrum of a decay   √(a² + b² r²)/D

(eq. 43 of the paper is the first). The last is |X| of X(s) = (s x₀ + v₀ + 2ζω x₀)/(s² + 2ζωs + ω²), of a record that
lasts until the motion has died; one that is cut after T = 1/Δf, Δf the step of the frequencies, has leakage that a note
tells of. Least squares in f_n, ζ and the gain, weighted by the uncertainties where these are given.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from vibeam.studies.identification.estimates import Identification, by_logarithms, estimates, spread_of
from vibeam_models.arrays import Array

DRIVES = ("base displacement", "base acceleration", "force")
CUT = 0.02  # share of the motion left at the end of a record from which on its spectrum leaks
REMAINS = 0.05  # residual, relative to the largest value, from which on it is no single linear mode
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
    from dataclasses import replace

    frequency, ratio = found["natural frequency"].value, found["damping ratio"].value
    left = float(np.exp(-2 * np.pi * frequency * ratio / step))
    if not left > CUT:
        return found
    said = f"after {1 / step:.3g} s, the length of the record by its lines, {100 * left:.2g} % of the motion are left"
    return replace(found, notes=(*found.notes, f"{said}: damping is too high by leakage; take the decay itself"))


def _dynamic(r: Array, ratio: float) -> Array:
    return np.asarray(np.hypot(1 - r**2, 2 * ratio * r))


def _checked(
    frequency: ArrayLike, amplitude: ArrayLike, uncertainty: ArrayLike | None, least: int
) -> tuple[Array, Array, Array | None]:
    f, a = np.asarray(frequency, dtype=float), np.asarray(amplitude, dtype=float)
    if f.ndim != 1 or f.shape != a.shape:
        raise ValueError(f"frequency {f.shape} and amplitude {a.shape} must be of one shape (n,)")
    if len(f) < least:
        raise ValueError(f"{len(f)} points are too few: {least} are needed")
    if not (np.isfinite(f).all() and np.isfinite(a).all() and (f >= 0).all() and (a >= 0).all()):
        raise ValueError("every frequency and amplitude must be a finite number, not below 0")
    if not a.max() > 0 or np.ptp(f) == 0:
        raise ValueError("there is no response in it: all amplitudes are 0, or all frequencies the same")
    order = np.argsort(f)
    if uncertainty is None:
        return f[order], a[order], None
    u = np.broadcast_to(np.asarray(uncertainty, dtype=float), f.shape)
    if not (np.isfinite(u).all() and (u > 0).all()):
        raise ValueError("every uncertainty must be a finite number above 0")
    return f[order], a[order], u[order]


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
    spread = (
        spread_of(jacobian, residual, names, equal=equal)
        if u is None
        else spread_of(jacobian / u[:, None], None, names)
    )
    left = float(np.sqrt(np.mean(residual**2)) / a.max())
    rows = estimates(names, [float(each) for each in values[: len(names)]], spread.half, units)
    notes = (
        (f"{100 * left:.2g} % of the largest value remain: this is no single linear mode",) if left > REMAINS else ()
    )
    return Identification(rows, method, len(f), left, spread.directions, notes)
