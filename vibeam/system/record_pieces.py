"""Piecewise cubic polynomials over time: values, integrals, largest values, common knots; interpolation of samples.

Piece i is Σ c_ij sʲ with s = t − t_i on [t_i, t_i+1]; outside of the span there is none, and the polynomial is 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Self

import numpy as np

from vibeam_models.arrays import Array, Index

POWERS = np.arange(4)
BLOCK = 1 << 17  # pieces at once: what is made of a record of millions of samples on the way stays small beside it
OVERLAP = 64  # samples beyond a block: what lies there changes its spline by less than 2⁻⁶⁴ of itself
BINOMIAL = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 1.0, 3.0], [0.0, 0.0, 0.0, 1.0]])


def place(times: Array, t: Array) -> tuple[Index, Array]:
    """Piece and time within it of each time ``t``, that of the nearest piece outside of the span."""
    piece = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    return piece, t - times[piece]


def integrated(coefficients: Array, s: Array, order: int) -> Array:
    """Integral of ``order`` 0 to 3 from a piece's start to ``s``, both 0 at its start; coefficients (m, 4), s (m,)."""
    factor = np.ones(4)
    for step in range(1, order + 1):
        factor = factor / (POWERS + step)
    inner = coefficients[..., 3] * factor[3]
    for power in (2, 1, 0):
        inner = inner * s + coefficients[..., power] * factor[power]
    return np.asarray(inner * s**order)


def knot_integrals(times: Array, coefficients: Array, start: tuple[float, float]) -> tuple[Array, Array, Array]:
    """First, second and third integral (K + 1,) at the knots; the first two begin with ``start``, the third with 0."""
    lengths = np.diff(times)
    first, second, third = (integrated(coefficients, lengths, order) for order in (1, 2, 3))
    one = start[0] + _sums(first)
    two = start[1] + _sums(second + one[:-1] * lengths)
    three = _sums(third + one[:-1] * lengths**2 / 2 + two[:-1] * lengths)
    return one, two, three


def _sums(parts: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(parts)])


def blocks(count: int, size: int = BLOCK) -> Iterator[slice]:
    """Blocks of ``count`` pieces, in order."""
    return (slice(first, min(first + size, count)) for first in range(0, count, size))


def bounds(times: Array, coefficients: Array) -> tuple[float, float]:
    """Least and greatest value of all pieces, exact: at their ends and where the slope is zero."""
    low, high = np.inf, -np.inf
    for part in blocks(len(coefficients)):
        own, lengths = coefficients[part], np.diff(times[part.start : part.stop + 1])
        which, s = turning_points(own, lengths)
        every = np.concatenate([own[:, 0], integrated(own, lengths, 0), integrated(own[which], s, 0)])
        low, high = np.minimum(low, every.min()), np.maximum(high, every.max())
    return float(low), float(high)


def turning_points(coefficients: Array, spans: Array) -> tuple[Index, Array]:
    """Pieces of ``coefficients`` (k, 4) that turn within (0, ``span``): which of them, and s."""
    _, c1, c2, c3 = coefficients.T
    root = np.sqrt(np.maximum(c2 * c2 - 3 * c1 * c3, 0.0))
    q = -(c2 + np.copysign(root, c2))  # of 3 c3 s² + 2 c2 s + c1 = 0, without cancellation
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = np.stack([q / (3 * c3), c1 / q])
        which = np.nonzero((found > 0) & (found < spans) & (c2 * c2 > 3 * c1 * c3))
    return which[1], found[which]


def moved(coefficients: Array, s: Array) -> Array:
    """The same polynomials about points ``s`` (m,) after their starts."""
    powers = s[:, None, None] ** np.maximum(POWERS[None, :] - POWERS[:, None], 0)
    return np.asarray(np.einsum("mj,kj,mkj->mk", coefficients, BINOMIAL, powers))


def on_knots(times: Array, coefficients: Array, knots: Array) -> Array:
    """Coefficients on pieces between ``knots``, among which all ``times`` are; 0 outside of the span."""
    piece, s = place(times, knots[:-1])
    inside = (knots[:-1] >= times[0]) & (knots[:-1] < times[-1])
    return np.asarray(np.where(inside[:, None], moved(coefficients[piece], np.where(inside, s, 0.0)), 0.0))


def linear(times: Array, values: Array) -> Array:
    """Coefficients of straight lines between samples."""
    made = np.zeros((len(times) - 1, 4))
    made[:, 0], made[:, 1] = values[:-1], np.diff(values) / np.diff(times)
    made.setflags(write=False)
    return made


def spline(times: Array, values: Array, derivative: int = 0) -> Array:
    """Coefficients of a derivative of the cubic spline through samples, not-a-knot at the ends (scipy)."""
    from scipy.interpolate import CubicSpline

    made = np.zeros((len(times) - 1, 4))
    for part in blocks(len(made)):
        low, high = max(part.start - OVERLAP, 0), part.stop + OVERLAP + 1
        curve = CubicSpline(times[low:high], values[low:high])
        found = (curve.derivative(derivative) if derivative else curve).c[::-1].T
        made[part, : found.shape[1]] = found[part.start - low : part.stop - low]
    made.setflags(write=False)
    return made


def without_line(times: Array, coefficients: Array, constant: float, slope: float) -> Array:
    """Coefficients less ``constant`` + ``slope`` (t − t_0)."""
    made = coefficients.copy()
    made[:, 0] -= constant + slope * (times[:-1] - times[0])
    made[:, 1] -= slope
    return made


def _mean(duration: float, one: Array, two: Array, three: Array) -> tuple[float, float, float]:
    return float(one[-1] - one[0]) / duration, 0.0, 0.0


def _velocity(duration: float, one: Array, two: Array, three: Array) -> tuple[float, float, float]:
    """The line that is nearest to the velocity, ∫(v − α − βt)² least."""
    whole = float(two[-1] - two[0])
    moment = duration * float(two[-1]) - float(three[-1])  # ∫ t v dt by parts
    slope = 12 * (moment - duration * whole / 2) / duration**3
    return slope, 0.0, whole / duration - slope * duration / 2


def _displacement(duration: float, one: Array, two: Array, three: Array) -> tuple[float, float, float]:
    v, b = float(one[-1]), float(two[-1])
    return 6 * b / duration**2 - 2 * v / duration, 6 * v / duration**2 - 12 * b / duration**3, 0.0


#: constant and slope of the acceleration and velocity at the start that are taken off, of a duration and the integrals
BASELINES: dict[str, Callable[[float, Array, Array, Array], tuple[float, float, float]]] = {
    "mean": _mean,
    "velocity": _velocity,
    "displacement": _displacement,
}


class MadeOfPieces:
    """Base of the chapters of a record's class: how a record is made."""

    if TYPE_CHECKING:
        times: Array
        coefficients: Array

        def __init__(
            self,
            times: Array,
            coefficients: Array,
            quantity: str = ...,
            initial: tuple[float, float] = ...,
            samples: str | None = ...,
        ) -> None: ...

        def without(self, remove: str | None) -> Self:
            """The record without drift."""
