"""Resonant grazing: where folds and doublings of motions with one impact in n drive periods meet the grazing curve.

With the sums of ``modal_sums``, Δ the gap less the static contact displacement, B the base's amplitude, B_g = Δ/|H₁|
the one at which the free motion grazes, s = (1 + R)/S, τ = κ/Ω and t12, k11, k21, t22 at λ = −1, both curves have a
closed form for any number of modes. A motion of impulse p = qΔ, q < 0, has

    (B/B_g)² = (1 − q G₀)² + (q τ)²                                                  (contact and restitution)
    fold:        the least B:    q = G₀/(G₀² + τ²),    B/B_g = |τ|/√(G₀² + τ²)
    doubling:    D(−1) = 0:      q = s² t12 Ω²/(D₀ + s² t12 (Ω² G₀ + G₂)),   D₀ = (1 − s k11)(1 + s t22) + s² t12 k21

so that q vanishes, and the curve meets the grazing curve B = B_g, where G₀ = 0 (fold) and where t12 = 0 (doubling).
With ε = Ω − Ω_r from there

    fold:        B/B_g = 1 − ½ (G₀'/τ)² ε² + …
    doubling:    B/B_g = 1 − q' G₀ ε + (½ q'² τ² − q' G₀' − ½ q'' G₀) ε² + …

One mode has both at ω_D nT = kπ, since G₀ and t12 vanish with sin ω_D nT: both curves are tangent to the grazing curve
there, as Simpson & Ghosh prove (arXiv 2602.22797, 2026), and with E = (−1)ᵏ e^{−σnT} their coefficients are

    fold       −½ [(1 + R) E nT/((1 − E)(1 + R E))]²
    doubling   [(1 + R) E nT/((1 − E)(1 − R E))]² (1 + ½ [(1 + R E)/(1 − R E)]²)

Several modes part the two: the fold stays tangent, at another frequency, and the doubling crosses the grazing curve
with a slope. No motion with a light impact is stable then: a multiplier grows like 1/v, and where Σ c_i² p01_i = 0 like
1/√v. Stable motions begin at a finite impulse, at the least where both curves have the same q.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import brentq

from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.modal_sums import Sums, checked, offsets, sums
from vibeam.periodic.multipliers import real_crossing
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, ValueRecord

PLACES = 2001  # of the frequencies at which a change of sign is looked for
DIGITS = 12  # of frequencies that count as one
WIDTH, DEGREE = 1e-3, 8  # share of the frequency over which derivatives are taken, of a polynomial of that degree


@dataclass(frozen=True, eq=False, repr=False)
class ResonantGrazing(ValueRecord):
    """Place where a fold or a doubling meets the grazing curve: B/B_g = 1 + ``slope`` ε + ``curvature`` ε².

    ε = Ω − ``omega`` in rad/s; the curve exists on the side ``side`` (−1 or 1) of it, where impacts push.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=0.1, restitution=0.5)
    >>> fold, doubling = vibeam.resonant_grazing(system, (1.5, 2.5))
    >>> fold.kind.name, round(fold.omega, 4), doubling.slope  # 2 ω √(1 − ζ²)
    ('FOLD', 1.9975, 0.0)
    """

    kind: Kind
    periods: int
    omega: float  #: rad/s
    amplitude: float  #: base motion at which the free motion grazes there, m
    slope: float  #: s/rad
    curvature: float  #: (s/rad)²
    side: int


def resonant_grazing(system: ImpactSystem, omega: tuple[float, float], periods: int = 1) -> tuple[ResonantGrazing, ...]:
    """Find all places of resonant grazing between two drive frequencies, rad/s, by frequency.

    ValueError as in ``boundaries``, for modes without stiffness, and where the contact rests on the stop.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.05, [1.0, 0.4], [1.0, 0.4], gap=0.1, restitution=0.5)
    >>> [found.kind.name for found in vibeam.resonant_grazing(system, (1.9, 2.1))]  # several modes part the two
    ['FOLD', 'DOUBLING']
    """
    span = checked(system, omega, periods)
    _clear(system)
    grid = np.linspace(float(span[0]), float(span[-1]), PLACES)
    found = [
        _unfolded(system, kind, place, periods)
        for kind, crossing in ((Kind.FOLD, _g0), (Kind.DOUBLING, _t12))
        for place in _zeros(lambda w, crossing=crossing: crossing(sums(system, w, periods)), grid)  # type: ignore[misc]
    ]
    return tuple(sorted(found, key=lambda each: (round(each.omega / grid[-1], DIGITS), each.kind is not Kind.FOLD)))


def _g0(total: Sums) -> Array:
    return total.g0


def _t12(total: Sums) -> Array:
    return total.minus.t12


def _zeros(function: Callable[[Array], Array], grid: Array) -> list[float]:
    """Zeros of a smooth function, at most one between two places of the grid."""
    values = function(grid)
    changes = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    return [float(brentq(lambda w: float(function(np.array([w]))[0]), *grid[k : k + 2], xtol=1e-15)) for k in changes]


def _unfolded(system: ImpactSystem, kind: Kind, place: float, periods: int) -> ResonantGrazing:
    here = sums(system, np.array([place]), periods)
    tau, numerator = float(_turn(system, here)[0]), (_fold if kind is Kind.FOLD else _doubling)
    (_, top, bend), (bottom, rise, _) = _derivatives(lambda w: numerator(system, sums(system, w, periods)), place)
    ((g0, green, _),) = _derivatives(lambda w: sums(system, w, periods).g0[None], place)
    first, second = top / bottom, (bend - 2 * top * rise / bottom) / bottom  # of q, which is 0 here
    slope, curvature = 0.0, -0.5 * (green / tau) ** 2
    if kind is Kind.DOUBLING:
        g0 = g0 if np.count_nonzero(system.contact) > 1 else 0.0  # of one mode it is 0 to round-off
        slope, curvature = -first * g0, 0.5 * (first * tau) ** 2 - first * green - 0.5 * second * g0
    amplitude = _clear(system) / abs(complex(here.unit[0]))
    return ResonantGrazing(kind, periods, place, amplitude, slope, curvature, int(-np.sign(first)))


def _clear(system: ImpactSystem) -> float:
    """Gap less the static contact displacement, m."""
    if np.any((system.omega == 0) & (system.contact != 0)):
        raise ValueError("omega: a mode without stiffness has no free motion that grazes")
    clear = float(system.gap - system.contact @ offsets(system))
    if clear <= 0:
        raise ValueError("gap: the contact rests on the stop, so that no free motion grazes it")
    return clear


def _turn(system: ImpactSystem, total: Sums) -> Array:
    """κ/Ω."""
    return np.asarray((system.restitution * system.mobility / (1 + system.restitution) - total.g1) / total.omega)


def _fold(system: ImpactSystem, total: Sums) -> Array:
    """Numerator and denominator (2, points) of q at the fold; not a motion where q is positive."""
    return np.array([total.g0, total.g0**2 + _turn(system, total) ** 2])


def _doubling(system: ImpactSystem, total: Sums) -> Array:
    """The same at the doubling."""
    still = real_crossing(system, total.minus, np.zeros(len(total.omega)))
    lean, square = ((1 + system.restitution) / system.mobility) ** 2 * total.minus.t12, total.omega**2
    return np.array([lean * square, still + lean * (square * total.g0 + total.g2)])


def _derivatives(function: Callable[[Array], Array], place: float) -> list[tuple[float, float, float]]:
    """Value and first two derivatives of each row of a smooth function."""
    width = WIDTH * place
    nodes = chebyshev.chebpts1(DEGREE + 1)
    fitted = chebyshev.chebfit(nodes, function(place + width * nodes).T, DEGREE)
    first, second = (chebyshev.chebder(fitted, k) for k in (1, 2))
    rows = zip(*(chebyshev.chebval(0.0, each) for each in (fitted, first / width, second / width**2)), strict=True)
    return [tuple(map(float, row)) for row in rows]  # type: ignore[misc]
