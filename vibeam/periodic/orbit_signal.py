"""Signals of motions with one impact a span T in closed form, and their extremes.

After the impact an output is a constant, the drive's harmonic and Σ Re(W_i e^{λ_i τ}) over the modes, with

    W_i = p o_i c_i κ_i,      g_i = Re(κ_i e^{λ_i τ}) the periodic Green's function.

Its values and slopes on a grid of times common to all motions are one product of matrices. Between two times the signal
is within Σ |W_i| e^{−σ_i τ} min(2, |λ_i h|⁴/384) of its cubic Hermite interpolant (Birkhoff & Priver 1967): the steps
are as short as that needs, finer just after the impact where the high modes still ring. The interpolant says in which
interval an extreme lies; its value is the signal's own, by Newton's method on the slope.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam_models.arrays import Array, Complex

TOLERANCE = 2e-6  # interpolation error aimed at, as a share of the signal's size; the modes left out have as much
MOST = 640  # times at most; for more the tolerance is relaxed
LEVELS, OCTAVES = 18, 14  # step lengths: a 16th of the flight, halved so often; stretches of equal steps
APART = 1e-7  # least 1 − ζ² at critical damping, so that the two decays of a mode stay apart
NEWTON = 3  # steps to an extreme, from where the interpolant has it
ALIKE = 1e-13  # share by which two values differ in round-off alone


class OrbitSignal(NamedTuple):
    """Output after the impact of each motion: Σ Re(``weights`` e^{λτ}) + Im(``drive`` e^{iΩτ}) + ``constant``.

    ``weights`` (parts, motions) with ``rates`` (parts,), 1/s; ``drive`` (motions,): phasor of the harmonic just after
    the impact; ``omega``, ``span`` (motions,): rad/s, and time to the next impact, s.
    """

    rates: Complex
    weights: Complex
    drive: Complex
    constant: float
    omega: Array
    span: Array


@dataclass(frozen=True, eq=False)
class Sampled:
    """A signal's values (rows, times), slopes times step at the begin and end of each interval, and the times.

    ``whole``: the signal; the values are those of its parts that are large enough.
    """

    value: Array
    begin: Array
    end: Array
    times: Array
    whole: OrbitSignal


def signal_of(
    natural: Array, zeta: Array, kicks: Array, drive: Complex, constant: float, omega: Array, span: Array
) -> OrbitSignal:
    """Signal of the displacement that modes (n,) make, whose velocity in it the impacts change by ``kicks``.

    ``kicks`` (n, motions); the rest as in ``OrbitSignal``.
    """
    seen = np.flatnonzero(kicks.any(axis=1))
    rates, shares, part_of = _parts(natural[seen], zeta[seen])
    weights = shares[:, None] / -np.expm1(rates[:, None] * span) * kicks[seen[part_of]]
    return OrbitSignal(rates, weights, drive, constant, omega, span)


def _parts(natural: Array, zeta: Array) -> tuple[Complex, Complex, NDArray[np.int64]]:
    """Rates and shares of the exponentials: one of a mode that oscillates, two of one that does not; and its mode."""
    square = zeta**2 - 1
    root = natural * np.sqrt(np.where(np.abs(square) < APART, -APART, square) + 0j)
    over = root.imag == 0
    slow = np.where(over, -(natural**2) / (zeta * natural + root), root - zeta * natural)
    rates = np.concatenate([slow, (-zeta * natural - root)[over]])
    shares = np.concatenate([np.where(over, 0.5, 1.0) / root, -0.5 / root[over]])
    return rates, shares, np.concatenate([np.arange(len(natural)), np.flatnonzero(over)])


def sampled(found: OrbitSignal) -> Sampled:
    """The signal from each impact to the next, which is the last time of each row."""
    heights = np.abs(found.weights)
    size = np.abs(found.drive) + abs(found.constant) + heights.max(axis=0, initial=0.0)
    shares = (heights / np.maximum(size, 1e-300)).max(axis=1, initial=0.0)
    ascending = np.argsort(shares)
    kept = np.sort(ascending[np.cumsum(shares[ascending]) > TOLERANCE])
    followed = found._replace(rates=found.rates[kept], weights=found.weights[kept])
    rates = np.append(found.rates[kept], 1j * found.omega.max(initial=0.0))  # the drive's harmonic is one more
    times = graded(rates, np.append(shares[kept], 1.0), float(found.span.max(initial=0.0)))
    value, slope = _at(followed, times)
    clamped = np.minimum(times, found.span[:, None])
    width = np.diff(clamped, axis=1)
    return Sampled(value, slope[:, :-1] * width, slope[:, 1:] * width, clamped, found)


def _at(found: OrbitSignal, times: Array) -> tuple[Array, Array]:
    """Values and slopes (rows, times), those beyond the next impact at its end."""
    turned = np.exp(1j * found.omega[:, None] * times) * found.drive[:, None]
    grown, last = np.exp(found.rates[:, None] * times), np.exp(found.rates[:, None] * found.span)
    real, end = np.concatenate([grown.real, -grown.imag]), np.exp(1j * found.omega * found.span) * found.drive
    beyond, both = times > found.span[:, None], []
    for weights, steady, final in (
        (found.weights, turned.imag + found.constant, end.imag + found.constant),
        (found.weights * found.rates[:, None], found.omega[:, None] * turned.real, found.omega * end.real),
    ):
        free = np.concatenate([weights.real, weights.imag]).T @ real
        ends = final + (weights.real * last.real - weights.imag * last.imag).sum(axis=0)
        both.append(np.where(beyond, ends[:, None], free + steady))
    return both[0], both[1]


def graded(rates: Complex, shares: Array, length: float) -> Array:
    """Times from 0 to ``length``: steps of a length with which the modes are resolved to the tolerance."""
    begins = length * np.concatenate([[0.0], 2.0 ** np.arange(-OCTAVES, 0), [0.625, 0.75, 0.875]])
    steps = length / 16 * 0.5 ** np.arange(LEVELS)
    left = shares[:, None] * np.exp(rates.real[:, None] * begins)
    missed = _interpolation(rates[:, None] * steps).T @ left  # (levels, begins)
    tolerance, widths = TOLERANCE, np.diff(np.append(begins, length))
    while True:
        level = np.argmax(np.vstack([missed <= tolerance, np.ones((1, len(begins)), dtype=bool)]), axis=0)
        counts = np.ceil(widths / steps[np.minimum(level, LEVELS - 1)] - 1e-9).astype(int)
        if counts.sum() <= MOST:
            break
        tolerance *= 2
    pieces = [begin + width * np.arange(n) / n for begin, width, n in zip(begins, widths, counts, strict=True)]
    return np.append(np.concatenate(pieces), length)


def highest(found: Sampled, sign: float) -> tuple[Array, Array]:
    """Largest values (rows,) of ± a signal where the interpolants are largest, and their times after the impacts."""
    tops, places = _tops(sign * found.value, sign * found.begin, sign * found.end)
    at = np.argmax(tops, axis=1)[:, None]
    begin, end = (np.take_along_axis(found.times, at + k, axis=1)[:, 0] for k in (0, 1))
    place = begin + np.take_along_axis(places, at, axis=1)[:, 0] * (end - begin)
    return _polished(found.whole, sign, place, begin, end)


def _polished(found: OrbitSignal, sign: float, place: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """Largest value (rows,) of ± the signal by Newton's method from ``place`` on, in ``begin`` to ``end``; its time."""
    value, slope, bend = sign * _derivatives(found, place)
    top, at = value, place
    for _ in range(NEWTON):
        step = np.divide(slope, bend, out=np.zeros_like(slope), where=bend < 0)
        place = np.clip(place - step, begin, end)
        value, slope, bend = sign * _derivatives(found, place)
        at = np.where(value >= top - ALIKE * np.abs(top), place, at)  # values hardly tell places beside an extreme
        top = np.maximum(top, value)
    return top, at


def _derivatives(found: OrbitSignal, times: Array) -> Array:
    """Signal (rows,) at one time of each row, s, with its first and second derivative (3, rows)."""
    free, steady = found.weights * np.exp(found.rates[:, None] * times), found.drive * np.exp(1j * found.omega * times)
    powers = [found.rates[:, None] ** order * free for order in range(3)]
    values = np.array([power.real.sum(axis=0) for power in powers])
    values += np.array([((1j * found.omega) ** order * steady).imag for order in range(3)])
    values[0] += found.constant
    return values


def _interpolation(turned: Complex | Array) -> Array:
    """Bound on the error of the cubic interpolant of e^{λτ} over a step h, as a share of its size, by λh."""
    return np.minimum(2.0, np.abs(turned) ** 4 / 384)


def _tops(value: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    """Largest value (rows, intervals) of the cubic interpolants that may be a row's largest, of their ends elsewhere.

    And its place in the interval, from 0 to 1.

    ``begin``, ``end``: slopes times step. With slopes of ± d at the ends a cubic rises at most ¼(d₀ − d₁) above them.
    """
    highest = np.maximum(value[:, :-1], value[:, 1:])
    places = (value[:, 1:] > value[:, :-1]).astype(float)
    reach = highest + (begin - end) / 4
    inside = (begin > 0) & (end < 0) & (reach > highest.max(axis=1, keepdims=True))
    y0, d0, d1, rise = value[:, :-1][inside], begin[inside], end[inside], np.diff(value, axis=1)[inside]
    a, b = d0 + d1 - 2 * rise, 3 * rise - 2 * d0 - d1
    s = d0 / (np.sqrt(b * b - 3 * a * d0) - b)
    top = y0 + s * (d0 + s * (b + s * a))
    places[inside] = np.where(top > highest[inside], s, places[inside])
    highest[inside] = np.maximum(highest[inside], top)
    return highest, places
