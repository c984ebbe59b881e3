"""One mode over a span of time, η'' + 2σ η' + ω² η = 0, as arrays: what a periodic motion needs, free of cancellation.

P = [[p00, p01], [p10, p11]] carries (η, η') over the span; with e = e^{−σt}, C and S as in ``kernels.roots.pair``,

    det(1 − P) = 1 − 2eC + e² = (1 − e)² + 4e sin²(wt/2)       (a sum of squares; (1 − e₁)(1 − e₂) when overdamped)
    det(1 + P) = 1 + 2eC + e² = (1 − e)² + 4e cos²(wt/2)
    1 − p00    = (1 − e) + 2e sin²(wt/2) − eσS
"""

from __future__ import annotations

from functools import lru_cache
from math import sqrt
from typing import NamedTuple

import numpy as np

from vibeam_models.arrays import Array

KEPT = 8  # propagators over one span
APART = 0.3  # μ/σ from which the two decays of an overdamped mode are told apart


class Pair(NamedTuple):
    """The propagator of a mode over a time (points,), its determinant, 1 − p00, det(1 − P) and det(1 + P)."""

    p00: Array
    p01: Array
    p10: Array
    p11: Array
    det: Array
    rise: Array
    closing: Array
    opening: Array


def pair(omega: float, zeta: float, span: Array) -> Pair:
    """The mode (ω, ζ) over ``span`` s, of any damping, ω = 0 included; no overflow for any ζωt."""
    sigma, disc = zeta * omega, omega * omega * (zeta - 1.0) * (zeta + 1.0)
    e = np.exp(-sigma * span)
    shape = _underdamped if disc < 0 else _overdamped
    return _propagated(omega, sigma, e, *shape(omega, sigma, sqrt(abs(disc)), span, e))


def pairs(omega: Array, zeta: Array, span: Array) -> Pair:
    """Pairs of modes (n,) over spans (points,) at once: every field (n, points)."""
    if len(span) == 1:  # one motion asks for the same ones several times
        return _pairs_over(omega.tobytes(), zeta.tobytes(), float(span[0]))
    return _pairs(omega, zeta, span)


@lru_cache(maxsize=KEPT)
def _pairs_over(omega: bytes, zeta: bytes, span: float) -> Pair:
    found = _pairs(np.frombuffer(omega), np.frombuffer(zeta), np.array([span]))
    for field in found:
        field.setflags(write=False)
    return found


def _pairs(omega: Array, zeta: Array, span: Array) -> Pair:
    disc = omega * omega * (zeta - 1.0) * (zeta + 1.0)
    if (disc < 0).all():
        rate, sigma, w = omega[:, None], (zeta * omega)[:, None], np.sqrt(-disc[:, None])
        e = np.exp(-sigma * span)
        return _propagated(rate, sigma, e, *_underdamped(rate, sigma, w, span, e))
    found = Pair(*np.empty((len(Pair._fields), len(omega), len(span))))
    each = [pair(own, damping, span) for own, damping in zip(omega.tolist(), zeta.tolist(), strict=True)]
    for field, *rows in zip(found, *each, strict=True):
        field[:] = rows
    return found


def _propagated(
    omega: float | Array, sigma: float | Array, e: Array,
    cosine: Array, sine: Array, rise: Array, closing: Array, opening: Array,
) -> Pair:  # fmt: skip
    """The propagator of e^{−σt}, eC, eS, and what else a ``Pair`` has."""
    return Pair(
        cosine + sigma * sine, sine, -omega * omega * sine, cosine - sigma * sine, e * e, rise, closing, opening
    )


def _underdamped(omega: float | Array, sigma: float | Array, w: float | Array, t: Array, e: Array) -> tuple[Array, ...]:
    """eC, eS, 1 − p00, det(1 − P), det(1 + P) of modes that oscillate at w."""
    half_sine, half_cosine = np.sin(w * t / 2), np.cos(w * t / 2)
    lost, versine = -np.expm1(-sigma * t), 2 * e * half_sine**2
    sine = 2 * e * half_sine * half_cosine / w
    opening = lost**2 + 4 * e * half_cosine**2
    return e - versine, sine, lost + versine - sigma * sine, lost**2 + 2 * versine, opening


def _overdamped(omega: float, sigma: float, mu: float, t: Array, e: Array) -> tuple[Array, ...]:
    """The same by the two decays σ ± μ, of which ω²/(σ + μ) is the slow one."""
    fast = sigma + mu
    slow = omega * omega / fast if fast > 0 else 0.0
    first, second = np.exp(-slow * t), np.exp(-fast * t)
    lost, lost_fast = -np.expm1(-slow * t), -np.expm1(-fast * t)
    sine = first * -np.expm1(-2 * mu * t) / (2 * mu) if mu > 0 else t * e
    if mu > APART * sigma:
        rise = (fast * lost - slow * lost_fast) / (2 * mu)
    else:
        rise = -np.expm1(-sigma * t) - first * np.expm1(-mu * t) ** 2 / 2 - sigma * sine
    return (first + second) / 2, sine, rise, lost * lost_fast, (1 + first) * (1 + second)


def propagators(omega: Array, zeta: Array, span: Array) -> Pair:
    """Propagators of modes (n,) over spans (points,), every field (points, n)."""
    return Pair(*(np.ascontiguousarray(field.T) for field in pairs(omega, zeta, span)))
