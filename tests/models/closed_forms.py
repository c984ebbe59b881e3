"""Natural frequencies of beams from their frequency equations, by mpmath: nothing of vibeam's is in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mpmath as mp
import numpy as np

# which of w, w', w'', w''' vanish at each kind of end (the last two: bending moment, shear force)
VANISH = {"clamped": (0, 1), "pinned": (0, 2), "guided": (1, 3), "free": (2, 3)}


def roots(determinant: Callable[[Any], Any], count: int, start: float, step: float) -> np.ndarray:
    """The first ``count`` roots above ``start``, found by their changes of sign every ``step``."""
    found: list[float] = []
    x, before = mp.mpf(start), determinant(mp.mpf(start))
    while len(found) < count:
        after = determinant(x + step)
        if before * after < 0:
            found.append(float(mp.findroot(determinant, (x, x + step), solver="anderson", tol=1e-30, verify=False)))
        x, before = x + step, after
    return np.array(found)


def powers(x: Any, derivative: int) -> list[Any]:
    """Derivative of cos, sin, cosh, sinh at ``x``."""
    signs = ([1, 1], [-1, 1], [-1, -1], [1, -1])[derivative % 4]
    circular = [mp.cos(x), mp.sin(x)] if derivative % 2 == 0 else [mp.sin(x), mp.cos(x)]
    hyperbolic = [mp.cosh(x), mp.sinh(x)] if derivative % 2 == 0 else [mp.sinh(x), mp.cosh(x)]
    return [signs[0] * circular[0], signs[1] * circular[1], *hyperbolic]


def uniform_eigenvalues(ends: str, count: int) -> np.ndarray:
    """λ (count,) > 0 with ω = λ² √(EI/ρA)/L² of a uniform beam."""
    left, right = ends.split("-")

    def determinant(x: Any) -> Any:
        rows = [powers(mp.mpf(0), d) for d in VANISH[left]] + [powers(x, d) for d in VANISH[right]]
        return mp.det(mp.matrix(rows)) / mp.exp(x)

    return roots(determinant, count, 0.1, 0.05)


def stepped_omega(pieces: Sequence[tuple[float, float, float]], ends: str, count: int, step: float) -> np.ndarray:
    """ω (count,) in rad/s of uniform ``pieces`` (length, EI, ρA) in a row; ``step`` rad/s between trials.

    w, w', EI w'' and EI w''' go on from piece to piece.
    """
    left, right = ends.split("-")

    def transfer(omega: Any, length: float, bending: float, density: float) -> Any:
        k = mp.sqrt(mp.sqrt(mp.mpf(density) * omega**2 / bending))
        factors = [1, k, bending * k**2, bending * k**3]

        def at(x: Any) -> Any:
            return mp.matrix([[factor * v for v in powers(k * x, d)] for d, factor in enumerate(factors)])

        return at(length) * at(mp.mpf(0)) ** -1

    def determinant(omega: Any) -> Any:
        whole = mp.eye(4)
        for piece in pieces:
            whole = transfer(omega, *piece) * whole
        free = [i for i in range(4) if i not in VANISH[left]]
        return mp.det(mp.matrix([[whole[row, column] for column in free] for row in VANISH[right]]))

    return roots(determinant, count, step / 2, step)


def wedge_omega(order: int, length: float, ratio: float, root: float, count: int, step: float) -> np.ndarray:
    """ω (count,) in rad/s of a cantilever whose thickness falls linearly to ``ratio`` of that at the clamp.

    ``order`` 1: constant width, A ∝ s and I ∝ s³; 2: a cone, A ∝ s² and I ∝ s⁴, s counted from where it would end.
    ``root``: √(EI/ρA) at the clamp, m²/s. With z = 2κ√s, w = s^(−n/2) (a Jₙ + b Yₙ + c Iₙ + d Kₙ)(z) (Kirchhoff 1879;
    Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-10 has its values).
    """
    large = mp.mpf(length) / (1 - mp.mpf(ratio))
    small = large - length
    kinds = ((mp.besselj, -1, 1), (mp.bessely, -1, 1), (mp.besseli, 1, 1), (mp.besselk, -1, -1))

    def determinant(omega: Any) -> Any:
        """(s^(−n/2) Cₙ)' = ±κ s^(−(n+1)/2) Cₙ₊₁, (s^(m/2) Cₘ)' = ±κ s^((m−1)/2) Cₘ₋₁: w, w', EI w'', (EI w'')'."""
        kappa = mp.sqrt(omega * large / root)  # κ⁴ = ρA ω²/(EI) · s², EI/ρA ∝ s²
        near, far = 2 * kappa * mp.sqrt(large), 2 * kappa * mp.sqrt(small)
        rows = [
            [kind(order, near) for kind, _, _ in kinds],
            [down * kind(order + 1, near) for kind, down, _ in kinds],
            [kind(order + 2, far) for kind, _, _ in kinds],
            [up * kind(order + 1, far) for kind, _, up in kinds],
        ]
        return mp.det(mp.matrix(rows))

    with mp.workdps(30):
        return roots(determinant, count, step / 2, step)


def timoshenko_omega(EI: float, kGA: float, per_length: float, inertia: float, length: float, n: int) -> float:
    """ω of mode ``n`` of bending of a pinned-pinned Timoshenko beam, rad/s.

    w = sin px, θ = c cos px with p = nπ/L: (p²κGA − ρAω²)(p²EI + κGA − ρIω²) = (pκGA)².
    """
    p = n * mp.pi / length
    a, c = mp.mpf(per_length) * inertia, p**4 * kGA * EI
    b = per_length * (p**2 * EI + kGA) + inertia * p**2 * kGA
    return float(mp.sqrt((b - mp.sqrt(b**2 - 4 * a * c)) / (2 * a)))
