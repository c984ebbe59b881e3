"""Oscillators of one degree of freedom on a base whose acceleration is a piecewise cubic, exact, with their extremes.

z'' + 2ζω z' + ω² z = −a(t), z the displacement relative to the base. With λ = −ζω + i ω_d, ω_d = ω √(1 − ζ²), and
y = z' − λ* z it is y' = λ y − a: over a piece a = Σ c_j sʲ, with the φ-functions of exponential integrators,

    y(s) = e^{λs} y₀ − Σ_j c_j j! s^{j+1} φ_{j+1}(λs),    φ_k(x) = (φ_{k−1}(x) − 1/(k−1)!)/x,    φ_0 = eˣ.

What is read off is q = Re(w* y): z by w = i/ω_d, the absolute acceleration z'' + a = −2ζω z' − ω² z likewise. Its
extremes are not those of samples: as |q''| ≤ M within a piece of length h, q stays below the larger of its ends plus
h²M/8. Pieces that may hold more than the largest known value are cut in parts; these are within h⁴N/384, |d⁴q/dt⁴| ≤ N,
of the cubic through values and slopes at their ends, and are cut again until that is 1e-13 of the largest value.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np

from vibeam_models.arrays import Array, Complex, Index

SMALL = 1.5  # |x| up to which the φ-functions are summed as series
TERMS = 22  # of the series of φ_4: 1.5^22/26! = 2e-23
DIGITS = 12  # of the lengths of pieces that are taken as equal
WORK = 1_000_000  # pieces times oscillators at once
RESOLVED = 1e-13  # share of the largest value by which an extreme may be off
PARTS, LEVELS = 4, 40  # into which an undecided piece is cut; cuts of cuts
FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0])
FALLING = np.array([[1.0, 1, 1, 1], [0, 1, 2, 3], [0, 0, 2, 6], [0, 0, 0, 6]])  # j!/(j − order)!


class Pieces(NamedTuple):
    """Acceleration of a base: ``times`` (K + 1,), ``coefficients`` (K, 4); ``jumps`` (K,) of its velocity at the ends.

    A jump is at the end of its piece, m/s; None: there are none.
    """

    times: Array
    coefficients: Array
    jumps: Array | None = None


class Oscillators(NamedTuple):
    """Exponents λ (F,), rad/s, and the rows w (2, F) of absolute acceleration and relative displacement."""

    rate: Complex
    rows: Complex

    @staticmethod
    def of(frequencies: Array, damping: float) -> Oscillators:
        """Oscillators of natural ``frequencies`` (F,), Hz, with a damping ratio from 0 to below 1."""
        omega = 2 * np.pi * frequencies
        decay, turn = damping * omega, omega * np.sqrt(1 - damping**2)
        rows = np.stack([-2 * decay - 1j * (omega**2 - 2 * decay**2) / turn, 1j / turn])
        return Oscillators(-decay + 1j * turn, rows)

    def read(self, states: Complex) -> Array:
        """Acceleration and displacement (2, …, F) of states y (…, F)."""
        rows = self.rows.reshape(2, *(1,) * (states.ndim - 1), -1)
        return np.asarray((rows.conj() * states).real)


def extremes(pieces: Pieces, frequencies: Array, damping: float) -> Array:
    """Extremes (2, 2, 2, F): acceleration and displacement; until the end and after; least and greatest."""
    step = max(1, WORK // len(pieces.coefficients))
    parts = [
        _extremes(pieces, Oscillators.of(frequencies[first : first + step], damping))
        for first in range(0, len(frequencies), step)
    ]
    return np.concatenate(parts, axis=-1)


def _extremes(pieces: Pieces, bank: Oscillators) -> Array:
    states = knot_states(pieces, bank.rate)
    begin, end = states[:-1], states[1:]
    if pieces.jumps is not None:
        end = end + pieces.jumps[:, None]
    return np.stack([_within(pieces, bank, begin, end), _after(bank, states[-1])], axis=1)


def phi(x: Complex) -> Complex:
    """φ_1 … φ_4 (4, …) of complex numbers, to round-off: by the series of φ_4 where x is small, else upward."""
    small = np.abs(x) < SMALL
    near, far = np.where(small, x, 0.0), np.where(small, 1.0, x)
    series = np.zeros_like(x)
    for k in range(TERMS, -1, -1):
        series = series * near + 1 / factorial(k + 4)
    found, up = [series], np.exp(far)
    for k in range(3, 0, -1):
        found.append(found[-1] * near + 1 / factorial(k))
    for k, down in enumerate(reversed(found)):
        up = (up - 1 / factorial(k)) / far
        down[...] = np.where(small, down, up)
    return np.stack(found[::-1])


def integrals(rate: Complex, s: Array) -> Complex:
    """∫₀ˢ e^{λ(s−r)} rʲ dr of j = 0 … 3 (4, …) for exponents and lengths that broadcast."""
    powers = s ** np.arange(1, 5).reshape(4, *(1,) * np.ndim(rate * s))
    return np.asarray(FACTORIALS.reshape(powers.shape[:1] + (1,) * (powers.ndim - 1)) * powers * phi(rate * s))


def knot_states(pieces: Pieces, rate: Complex) -> Complex:
    """States y (K + 1, F) at the times of the pieces, after the jumps there, from rest on the base."""
    mantissa, exponent = np.frexp(np.diff(pieces.times))
    lengths, which = np.unique(np.ldexp(np.round(mantissa, DIGITS), exponent), return_inverse=True)
    pushes = integrals(rate, lengths[:, None])  # (4, lengths, F)
    if len(lengths) == 1:
        push = -pieces.coefficients @ pushes[:, 0]
    else:
        push = -np.einsum("kj,jkf->kf", pieces.coefficients, pushes[:, which])
    if pieces.jumps is not None:
        push -= pieces.jumps[:, None]
    return _summed(rate * lengths[:, None], which, push)


def _summed(turns: Complex, which: Index, push: Complex) -> Complex:
    """y_{i+1} = e^{turns[which_i]} y_i + push_i from 0 (K + 1, F), in √K rows side by side that are then joined."""
    count, kinds = push.shape
    width = int(np.ceil(np.sqrt(count)))
    rows = -(-count // width)
    filled = np.zeros((rows * width, kinds), complex)
    filled[:count] = push
    sums, turn = filled.reshape(rows, width, kinds), np.zeros((rows * width, kinds), complex)
    turn[:count] = turns[which]
    angle = np.cumsum(turn.reshape(rows, width, kinds), axis=1)
    growth = np.exp(turns)[np.append(which, np.zeros(rows * width - count, int)).reshape(rows, width)]
    for j in range(1, width):
        sums[:, j] += growth[:, j] * sums[:, j - 1]
    start = np.zeros((rows + 1, kinds), complex)
    whole = np.exp(angle[:, -1])
    for row in range(rows):
        start[row + 1] = whole[row] * start[row] + sums[row, -1]
    sums += np.exp(angle) * start[:-1, None]
    return np.concatenate([np.zeros((1, kinds), complex), filled[:count]])


def _within(pieces: Pieces, bank: Oscillators, begin: Complex, end: Complex) -> Array:
    """Least and greatest (2, 2, F) of both quantities up to the end, between the times too."""
    first, last = bank.read(begin), bank.read(end)
    least = np.minimum(first.min(axis=1), last.min(axis=1))
    greatest = np.maximum(first.max(axis=1), last.max(axis=1))
    curved = _curvature(pieces, bank, begin)
    found = np.stack([least, greatest], axis=1)
    for quantity in range(2):
        for side, sign in enumerate((-1.0, 1.0)):
            ends = sign * np.stack([first[quantity], last[quantity]])
            row, bound = bank.rows[quantity] * sign, curved * np.abs(bank.rows[quantity])
            best = _largest(pieces, bank.rate, row, begin, ends, bound)
            found[quantity, side] = sign * best
    return found


def _curvature(pieces: Pieces, bank: Oscillators, begin: Complex) -> Array:
    """Bound (K, F) of |y''| = |λ²y − λa − a'| within the pieces."""
    length = np.diff(pieces.times)
    sizes = np.abs(pieces.coefficients) * length[:, None] ** np.arange(4)
    push, slope = sizes.sum(axis=1)[:, None], (sizes @ np.arange(4) / length)[:, None]
    size = np.abs(bank.rate)
    return np.asarray(size * (size * (np.abs(begin) + length[:, None] * push) + push) + slope)


def _largest(pieces: Pieces, rate: Complex, row: Complex, begin: Complex, ends: Array, bound: Array) -> Array:
    """Largest Re(row* y) (F,) over all pieces, ``ends`` (2, K, F) known, |q''| within ``bound`` (K, F)."""
    best, size = ends.max(axis=(0, 1)), np.abs(ends).max(axis=(0, 1))
    length = np.diff(pieces.times)[:, None]
    piece, kind = np.nonzero(ends.max(axis=0) + bound * length**2 / 8 > best + RESOLVED * size)
    left, width = np.zeros(len(piece)), np.broadcast_to(length, bound.shape)[piece, kind]
    fourth = np.abs(row)[kind] * _fourth(pieces, rate, begin, piece, kind)
    for _ in range(LEVELS):
        if not len(piece):
            break
        at = left + np.arange(PARTS + 1)[:, None] * (width / PARTS)
        values, slopes = _curve(pieces, rate, row, begin, piece, kind, at)
        np.maximum.at(size, kind, np.abs(values).max(axis=0))
        width, tolerance = width / PARTS, RESOLVED * size
        top, missed = _cubic_top(values, slopes, width), fourth * width**4 / 384
        sure = missed <= tolerance[kind]
        np.maximum.at(best, kind, np.where(sure, top.max(axis=0), values.max(axis=0)))
        part, which = np.nonzero((top + missed > (best + tolerance)[kind]) & ~sure)
        left, width, fourth = at[part, which], width[which], fourth[which]
        piece, kind = piece[which], kind[which]
    return np.asarray(best)


def _curve(
    pieces: Pieces, rate: Complex, row: Complex, begin: Complex, piece: Index, kind: Index, at: Array
) -> tuple[Array, Array]:
    """q and q' (m, n) at times ``at`` (m, n) after the begin of ``piece`` (n,), of the oscillators ``kind`` (n,)."""
    turn, load = rate[kind], pieces.coefficients[piece]
    states = np.exp(turn * at) * begin[piece, kind] - np.einsum("nj,jmn->mn", load, integrals(turn, at))
    push = ((load[:, 3] * at + load[:, 2]) * at + load[:, 1]) * at + load[:, 0]
    across = row[kind].conj()
    return (across * states).real, (across * (turn * states - push)).real


def _fourth(pieces: Pieces, rate: Complex, begin: Complex, piece: Index, kind: Index) -> Array:
    """Bound (n,) of |d⁴y/dt⁴| = |λ⁴y − λ³a − λ²a' − λa'' − a'''| within pieces."""
    length, load, size = np.diff(pieces.times)[piece], np.abs(pieces.coefficients[piece]), np.abs(rate[kind])
    powers = load * length[:, None] ** np.arange(4)
    push = powers.sum(axis=1)
    total = size**4 * (np.abs(begin[piece, kind]) + length * push)
    for order in range(4):
        total += size ** (3 - order) * (powers @ FALLING[order]) / length**order
    return np.asarray(total)


def _cubic_top(values: Array, slopes: Array, width: Array) -> Array:
    """Largest value (m − 1, n) between neighbours of the cubics through values and slopes (m, n)."""
    low, high = values[:-1], values[1:]
    first, last, rise = slopes[:-1] * width, slopes[1:] * width, high - low
    b, a = 3 * rise - 2 * first - last, first + last - 2 * rise
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - 3 * a * first)
        at = np.stack([-first / (b + root), -first / (b - root)])
    at = np.where((at > 0) & (at < 1), at, 0.0)
    return np.asarray(np.maximum((((a * at + b) * at + first) * at + low).max(axis=0), high))


def _after(bank: Oscillators, last: Complex) -> Array:
    """Least and greatest (2, 2, F) of the free decay from states (F,): at its start or one of its first two turns."""
    turning = np.angle(bank.rows.conj() * bank.rate * last)  # q' = Re(w*λ y e^{λτ}) = 0
    first = np.mod(np.pi / 2 - turning, np.pi) / bank.rate.imag
    times = np.stack([np.zeros_like(first), first, first + np.pi / bank.rate.imag])
    values = (bank.rows.conj() * last * np.exp(bank.rate * times)).real
    return np.stack([values.min(axis=0), values.max(axis=0)], axis=1)
