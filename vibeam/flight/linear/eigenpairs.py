"""Newton steps on the eigenvalues and shapes of λ² z + λ D z + Λ z + w f = 0, f the force of a stop: to ε times each.

Eigenvalues from the QR algorithm are off by ε times the *fastest* rate, which is too much for slow modes beside fast
ones. On the quadratic equation itself every coordinate is weighed with its own numbers only. Where nothing but the stop
couples them (D diagonal) it comes down to the secular equation Σ w_i²/(λ² + d_i λ + Λ_i) + 1/(k + cλ) = 0, solved for
all eigenvalues at once; the coordinate that moves most is kept out of the sum, so that an eigenvalue close to that
coordinate's own is no small difference. Two that nearly coincide
are taken together, by their common quadratic factor. Where damping couples the coordinates the equation is bordered and
solved for one eigenvalue at a time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from vibeam_models.arrays import Array, Complex, Index

Ring = tuple[Any, Any]
ROUNDS = 4  # of Newton
TINY = 1e-13  # share of the fastest rate below which an eigenvalue is zero: nothing to gain
LAST_DIGITS = 1e-15  # share of an eigenvalue below which a step says no more
TINIEST = 1e-30  # for what may be divided by
ASTRAY = 1e-3  # share by which a step may change an eigenvalue or a shape; more, and there is none by itself


@dataclass(frozen=True)
class LinearSystem:
    """``spring`` Λ (n,), ``damper`` D (n, n), and the stop: row ``contact`` w (n,), ``stiffness`` k (0: free, inf:
    held) and ``damping`` c.
    """

    spring: Array
    damper: Array
    contact: Array
    stiffness: float = 0.0
    damping: float = 0.0

    @property
    def held(self) -> bool:
        """True where the contact point cannot move."""
        return self.stiffness == inf

    @property
    def uncoupled(self) -> bool:
        """True where nothing but the stop couples the coordinates."""
        return not np.any(self.damper - np.diag(np.diag(self.damper)))

    @property
    def scale(self) -> Array:
        """s (n,): the square roots of Λ, 1 for a coordinate without stiffness."""
        return np.where(self.spring > 0, np.sqrt(np.maximum(self.spring, 0.0)), 1.0)

    def part(self, group: Index) -> LinearSystem:
        """Some of the coordinates by themselves."""
        damper = self.damper[np.ix_(group, group)]
        return replace(self, spring=self.spring[group], damper=damper, contact=self.contact[group])


def refined(part: LinearSystem, values: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """Eigenvalues (m,) and the state's eigenvectors (s z, λ z) (2n, m) of unit length, from those of QR."""
    if not len(values):
        return values, vectors
    if part.stiffness > 0 and part.uncoupled:
        found, shapes = _secular(part, values, vectors)
    else:
        each = [_bordered(part, complex(value), vectors[:, k]) for k, value in enumerate(values)]
        found, shapes = np.array([value for value, _ in each]), np.stack([shape for _, shape in each], axis=1)
    state = np.concatenate([part.scale[:, None] * shapes, found * shapes])
    state = state / np.linalg.norm(state, axis=0)
    before = vectors / np.linalg.norm(vectors, axis=0)
    near = np.abs(np.sum(before.conj() * state, axis=0)) >= 1 - ASTRAY
    usable = np.isfinite(found) & (np.abs(found - values) <= ASTRAY * np.abs(values))
    gain = usable & (np.abs(values) > TINY * float(np.max(part.scale)))
    return np.where(gain, found, values), np.where(gain & near, state, before)


def _secular(part: LinearSystem, values: Complex, vectors: Complex) -> tuple[Complex, Complex]:
    """All eigenvalues at once: φ(λ) = p_j + w_j²/h = 0 with h = Σ_{i≠j} w_i²/p_i + 1/(k + cλ), j moving most.

    What is sought is the distance ν of λ from j's own eigenvalue: p_j = ν (ν + gap), and p_i − p_j has no squares.
    """
    n, m, w = len(part.spring), len(values), part.contact
    own, half = np.arange(m), np.diag(part.damper) / 2
    j = np.argmax(np.abs(vectors[:n]) ** 2 + np.abs(vectors[n:]) ** 2, axis=0)
    others = np.ones((n, m), dtype=bool)
    others[j, own] = False
    root = np.sqrt(-_turns(part)[j] + 0j)
    root = np.where(np.abs(values + half[j] - root) <= np.abs(values + half[j] + root), root, -root)
    pole = np.where(root.real > 0, -part.spring[j] / np.where(root.real > 0, half[j] + root, 1.0), root - half[j])
    nu = values - pole
    damper, spring, row, square = 2 * half[:, None], part.spring[:, None], w[:, None], w[j] ** 2
    further, stiffer = damper - 2 * half[j], spring - part.spring[j]
    with np.errstate(all="ignore"):
        for turn in range(ROUNDS + 1):
            value = pole + nu
            p = nu * (nu + 2 * root) + further * value + stiffer
            gain = np.where(others, row / np.where(p == 0, TINIEST * (np.abs(value) ** 2 + spring), p), 0.0)
            h = np.sum(row * gain, axis=0)
            yields = 0.0 if part.held else 1 / (part.stiffness + part.damping * value)
            h = h + yields
            if turn == ROUNDS:
                break
            change = -np.sum(gain**2 * (2 * value + damper), axis=0) - part.damping * yields**2
            rise = 2 * nu + 2 * root - square * change / h**2
            step = (nu * (nu + 2 * root) + square / h) / rise
            step = np.where(np.abs(step) <= ASTRAY * np.abs(values), step, 0.0)
            if np.all(np.abs(step) <= LAST_DIGITS * np.abs(values)) and turn > 0:
                break
            nu = nu - step
        shapes = np.where(others, -gain * (w[j] / h), 1.0)
    return pole + nu, np.where(np.isfinite(shapes).all(axis=0), shapes, vectors[:n] / part.scale[:, None])


def _bordered(part: LinearSystem, value: complex, vector: Complex) -> tuple[complex, Complex]:
    """One eigenvalue and its z: equation and stop bordered by the step's being orthogonal to z, rows scaled."""
    n, w, scale = len(part.spring), part.contact, part.scale
    z = vector[n:] / value if abs(value) > 0 else vector[:n] / scale
    if abs(value) <= TINY * float(np.max(scale)):
        return value, z
    stop = 1.0 if part.held else part.stiffness
    z = np.append(z, 0.0 if part.stiffness == 0 else _force(part, value, z)) / np.linalg.norm(z)
    for _ in range(ROUNDS):
        matrix, slope = np.zeros((n + 1, n + 1), dtype=complex), np.zeros((n + 1, n + 1), dtype=complex)
        matrix[:n, :n] = np.diag(value**2 + part.spring) + value * part.damper
        slope[:n, :n] = 2 * value * np.eye(n) + part.damper
        matrix[:n, n], matrix[n, n] = w, -1.0
        if part.stiffness > 0:
            matrix[n, :n] = w if part.held else w * (1 + part.damping * value / stop)
            slope[n, :n] = 0.0 if part.held else w * part.damping / stop
            matrix[n, n] = 0.0 if part.held else -1.0 / stop
        rows = 1.0 / (np.abs(np.diag(matrix)[:n]) + part.spring + abs(value) ** 2)
        rows = np.append(rows, 1.0 / float(np.max(np.abs(matrix[n]))))
        bordered = np.zeros((n + 2, n + 2), dtype=complex)
        bordered[: n + 1, : n + 1] = rows[:, None] * matrix
        bordered[: n + 1, n + 1] = rows * (slope @ z) * abs(value)
        bordered[n + 1, :n] = z[:n].conj()
        try:
            step = np.linalg.solve(bordered, np.append(-rows * (matrix @ z), 0.0))
        except np.linalg.LinAlgError:
            break
        change = complex(step[n + 1] * abs(value))
        if not np.all(np.isfinite(step)) or abs(change) > ASTRAY * abs(value):
            break
        z, value = z + step[: n + 1], value + change
        z = z / np.linalg.norm(z[:n])
    return value, z[:n]


def _force(part: LinearSystem, value: complex, z: Complex) -> complex:
    """f that belongs to z: what the stop does, or, where it holds, what keeps the contact point."""
    w = part.contact
    if not part.held:
        return complex((part.stiffness + part.damping * value) * (w @ z))
    return complex(-(w @ (part.spring * z + value * (part.damper @ z))) / (w @ w))


def refined_plane(part: LinearSystem, column: Array, block: Array) -> tuple[Array, Array]:
    """A plane (2n, 2), orthonormal, of two eigenvalues that nearly coincide, and A in it (2, 2), from those of QR.

    Bairstow's method on the secular equation: for the quadratic factor q = μ² + e, μ = λ + σ, of the two, which is good
    where they are not. Where damping couples the coordinates they stay as they are.
    """
    n, scale = len(part.spring), part.scale
    half, size = np.diag(part.damper) / 2, float(np.linalg.norm(block, 2))
    if part.stiffness == 0 or not part.uncoupled or size <= TINY * float(np.max(scale)):
        return column, block
    moves = np.sum(column**2, axis=1)
    j = int(np.argmax(moves[:n] + moves[n:]))
    further = -float(np.trace(block)) / 2 - float(half[j])  # σ and e less what they are of j alone
    wider = -float(((block[0, 0] - block[1, 1]) / 2) ** 2 + block[0, 1] * block[1, 0]) - float(_turns(part)[j])
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS):
            e = float(_turns(part)[j]) + wider
            remainder, quotient, _ = _divided(part, further, wider, j)
            constant, slope = _times(e, remainder, _inverse(e, quotient)[0])
            if not (abs(slope) <= ASTRAY * size and abs(constant) <= ASTRAY * size**2):
                return column, block
            further, wider = further + float(slope) / 2, wider + float(constant) - float(slope) ** 2 / 4
        at, rate = _divided(part, further, wider, j)[2]
        sigma, e = float(half[j]) + further, float(_turns(part)[j]) + wider
        first = np.concatenate([scale * at, -sigma * at - e * rate])
        second = np.concatenate([scale * rate, at - sigma * rate]) * size
    if not np.all(np.isfinite(first + second)):
        return column, block
    unit, lengths = np.linalg.qr(np.stack([first, second], axis=1))
    turned = lengths @ np.array([[-sigma, size], [-e / size, -sigma]]) @ np.linalg.inv(lengths)
    return (unit, turned) if _defect(part, unit, turned) < _defect(part, column, block) else (column, block)


def _defect(part: LinearSystem, column: Array, block: Array) -> float:
    """Distance of a plane from being invariant, each coordinate weighed with its own numbers."""
    n, w, size = len(part.spring), part.contact, float(np.linalg.norm(block, 2))
    shape, moved, damper = column[:n] / part.scale[:, None], column[n:], np.diag(part.damper)
    heavy = part.spring + damper * size + size**2
    rest = (part.spring[:, None] * shape + damper[:, None] * moved + moved @ block) / heavy[:, None]
    force = -(w @ rest) / np.sum(w**2 / heavy)
    rows = (rest + np.outer(w / heavy, force)) * (part.scale + size)[:, None]
    stop = w @ shape - (0.0 if part.held else (force - part.damping * (w @ moved)) / part.stiffness)
    return float(np.linalg.norm(rows) + np.linalg.norm(stop) / np.linalg.norm(w / (part.scale + size)))


def _turns(part: LinearSystem) -> Array:
    """ω² − σ² of each coordinate by itself."""
    half, own = np.diag(part.damper) / 2, np.sqrt(np.maximum(part.spring, 0.0))
    return np.asarray((own - half) * (own + half))


def _times(e: float, one: Ring, other: Ring) -> Ring:
    """The product of two numbers a + bμ modulo μ² + e."""
    (a, b), (c, d) = one, other
    return a * c - e * b * d, a * d + b * c


def _inverse(e: float, one: Ring) -> tuple[Ring, Array]:
    """r = 1 / one modulo q = μ² + e, and t with one · r = 1 + q t."""
    a, b = one
    size = a * a + e * b * b
    return (a / size, -b / size), -b * b / size


def _inverse_twice(e: float, one: Ring, more: Ring) -> tuple[Ring, Ring]:
    """1 / (one + q more) = r + q s, modulo q²."""
    r, t = _inverse(e, one)
    square = _times(e, more, _times(e, r, r))
    return r, (-t * r[0] - square[0], -t * r[1] - square[1])


def _divided(part: LinearSystem, further: float, wider: float, j: int) -> tuple[Ring, Ring, Ring]:
    """φ = p_j + w_j²/h as remainder + q · quotient, and z_i = at + rate μ (n,) with z_j = 1."""
    w, half, turns = part.contact, np.diag(part.damper) / 2, _turns(part)
    others, e, apart = np.arange(len(w)) != j, float(turns[j]) + wider, half - half[j] - further
    off = apart**2 + (turns - turns[j]) - wider, 2 * apart  # p_i = off + q
    gain, more = _inverse_twice(e, (off[0][others], off[1][others]), (1.0, 0.0))
    square = w[others] ** 2
    h, rest = (square @ gain[0], square @ gain[1]), (square @ more[0], square @ more[1])
    if not part.held:
        stop = part.stiffness - part.damping * (half[j] + further), part.damping
        soft, beyond = _inverse_twice(e, stop, (0.0, 0.0))
        h, rest = (h[0] + soft[0], h[1] + soft[1]), (rest[0] + beyond[0], rest[1] + beyond[1])
    over, beyond = _inverse_twice(e, h, rest)
    shape, at, rate = _times(e, gain, over), np.ones(len(w)), np.zeros(len(w))
    at[others], rate[others] = -w[j] * w[others] * shape[0], -w[j] * w[others] * shape[1]
    remainder = off[0][j] + w[j] ** 2 * over[0], off[1][j] + w[j] ** 2 * over[1]
    return remainder, (1 + w[j] ** 2 * beyond[0], w[j] ** 2 * beyond[1]), (at, rate)
