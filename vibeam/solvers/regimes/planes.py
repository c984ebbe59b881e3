"""A linear system with any damping, free, pushed by a linear stop or held on one, in real 2×2 blocks.

z'' + D z' + Λ z + w f = 0 with f = 0 (free), f = (k + c d/dt) w·z (pushed) or w·z = 0 (held). In energy coordinates
(s z, z'), s = ω (1 for a coordinate without stiffness), the state matrix is nearly normal. Coordinates that nothing
couples are blocks by themselves, exactly. The others are decoupled by eigenvectors: a complex pair spans a plane in
which A is (a b; −b a) up to lengths, two real eigenvalues span one in which it is diagonal.

Eigenvalues from the QR algorithm are off by ε times the *fastest* rate, which is too much for slow modes beside fast
ones. Each is therefore polished by Newton steps on its own quadratic equation, bordered by f so that a stiff or rigid
stop does no harm, its rows scaled: to ε times itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.int64]
CLOSE = 1e-6  # relative distance of two real eigenvalues below which their common subspace is taken
WORST = 1e7  # condition of the columns beyond which too many digits would be lost
TINY = 1e-13  # share of the fastest rate below which an eigenvalue is zero
ROUNDS = 4  # of Newton


@dataclass(frozen=True)
class Linear:
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
        """Whether the contact point cannot move."""
        return self.stiffness == inf

    @property
    def scale(self) -> Array:
        """s (n,)."""
        return np.where(self.spring > 0, np.sqrt(np.maximum(self.spring, 0.0)), 1.0)

    def part(self, group: Indices) -> Linear:
        """Some of the coordinates by themselves."""
        damper = self.damper[np.ix_(group, group)]
        return replace(self, spring=self.spring[group], damper=damper, contact=self.contact[group])

    def groups(self) -> list[Indices]:
        """Coordinates that damping or the stop couples, together."""
        from scipy.sparse.csgraph import connected_components

        size = np.sqrt(np.abs(np.diag(self.damper)))
        couples = np.abs(self.damper) > 1e-15 * np.outer(size, size)
        if self.stiffness > 0:
            couples |= np.outer(self.contact != 0, self.contact != 0)
        count, label = connected_components(couples, directed=False)
        return [np.flatnonzero(label == i) for i in range(count)]


@dataclass(frozen=True)
class Planes:
    """(s z, z') = ``columns`` · y with y' = A y in m ``blocks`` (m, 2, 2); ``inverse`` · ``columns`` = 1."""

    columns: Array
    inverse: Array
    blocks: Array


def planes(system: Linear) -> Planes:
    """The blocks; ValueError where complex modes coincide so closely that there are none."""
    n, columns, blocks = len(system.spring), [], []
    for group in system.groups():
        part = system.part(group)
        alone = len(group) == 1 and (system.stiffness == 0 or part.contact[0] == 0)
        for small, block in [_single(part)] if alone else _several(part):
            column = np.zeros((2 * n, 2))
            column[np.concatenate([group, n + group])] = small
            columns.append(column)
            blocks.append(block)
    if not columns:
        return Planes(np.zeros((2 * n, 0)), np.zeros((0, 2 * n)), np.zeros((0, 2, 2)))
    together = np.concatenate(columns, axis=1)
    inverse = np.asarray(
        np.linalg.pinv(together, rcond=1e-15) if system.held else np.linalg.inv(together), dtype=np.float64
    )
    if np.linalg.norm(together, 2) * np.linalg.norm(inverse, 2) > WORST:
        raise ValueError("damping: two or more complex modes nearly coincide, shape and rate: separate them slightly")
    return Planes(together, inverse, np.array(blocks))


def _single(part: Linear) -> tuple[Array, Array]:
    s = part.scale[0]
    return np.eye(2), np.array([[0.0, s], [-part.spring[0] / s, -part.damper[0, 0]]])


def _several(part: Linear) -> list[tuple[Array, Array]]:
    state, lift = _state(part)
    values, vectors = np.linalg.eig(state)
    values, vectors = values.astype(complex), lift @ vectors.astype(complex)
    real = np.abs(values.imag) <= CLOSE * np.abs(values)
    found = [_turning(*_polished(part, values[k], vectors[:, k])) for k in np.flatnonzero(~real & (values.imag > 0))]
    rest = np.flatnonzero(real)
    for first, second in _couples(rest[np.argsort(values[rest].real, kind="stable")], values):
        pair = values[[first, second]]
        if abs(pair[1] - pair[0]) <= CLOSE * float(np.max(np.abs(pair))):
            column, block = _common(state, pair)
            found.append((lift @ column, block))
        else:
            both = [_polished(part, complex(values[k].real), vectors[:, k].real + 0j) for k in (first, second)]
            column = np.stack([vector.real for _, vector in both], axis=1)
            found.append((column, np.diag([value.real for value, _ in both])))
    return found


def _state(part: Linear) -> tuple[Array, Array]:
    """The state matrix, of the coordinates that are left where the stop holds one, and the way back to all of them."""
    n, w, s = len(part.spring), part.contact, part.scale
    spring, damper = np.diag(part.spring), part.damper
    if part.held:
        basis = complement(w)
        spring, damper = basis.T @ (part.spring[:, None] * basis), basis.T @ damper @ basis
        squared, turn = np.linalg.eigh(spring)
        basis, damper = basis @ turn, turn.T @ damper @ turn
        t = np.sqrt(np.maximum(squared, 1e-30 * float(np.max(squared, initial=1.0))))
        zero = np.zeros((n - 1, n - 1))
        lift = np.block([[s[:, None] * basis / t, np.zeros((n, n - 1))], [np.zeros((n, n - 1)), basis]])
        return np.block([[zero, np.diag(t)], [-np.diag(squared / t), -damper]]), lift
    spring = spring + part.stiffness * np.outer(w, w)
    damper = damper + part.damping * np.outer(w, w)
    return np.block([[np.zeros((n, n)), np.diag(s)], [-spring / s, -damper]]), np.eye(2 * n)


def complement(row: Array) -> Array:
    """An orthonormal basis (n, n−1) of the vectors orthogonal to ``row``, by one Householder reflection."""
    unit = row / np.linalg.norm(row)
    pivot = int(np.argmax(np.abs(unit)))
    normal = unit.copy()
    normal[pivot] += np.copysign(1.0, unit[pivot])
    reflection = np.eye(len(unit)) - 2 * np.outer(normal, normal) / (normal @ normal)
    return np.delete(reflection, pivot, axis=1)


def _turning(value: complex, vector: Complex) -> tuple[Array, Array]:
    """Columns Re v and Im v, the phase of v such that they are orthogonal, to unit length, and A in them.

    A (Re v, Im v) = (Re v, Im v) (a b; −b a).
    """
    vector = vector * np.exp(-0.5j * np.angle(np.sum(vector**2)))
    column = np.stack([vector.real, vector.imag], axis=1)
    sizes = np.linalg.norm(column, axis=0)
    ratio = sizes[0] / sizes[1]
    return column / sizes, np.array([[value.real, value.imag * ratio], [-value.imag / ratio, value.real]])


def _polished(part: Linear, value: complex, vector: Complex) -> tuple[complex, Complex]:
    """An eigenvalue of the quadratic equation, and the state's eigenvector (s z, λ z) of unit length."""
    n, w, scale = len(part.spring), part.contact, part.scale
    z = vector[n:] / value if abs(value) > 0 else vector[:n] / scale
    if abs(value) <= TINY * float(np.max(scale)):  # without stiffness: nothing to gain
        return value, vector / np.linalg.norm(vector)
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
        if not np.all(np.isfinite(step)) or abs(change) > 1e-3 * abs(value):
            break
        z, value = z + step[: n + 1], value + change
        z = z / np.linalg.norm(z[:n])
    found = np.concatenate([scale * z[:n], value * z[:n]])
    return value, found / np.linalg.norm(found)


def _force(part: Linear, value: complex, z: Complex) -> complex:
    """f that belongs to z: what the stop does, or, where it holds, what keeps the contact point."""
    w = part.contact
    if not part.held:
        return complex((part.stiffness + part.damping * value) * (w @ z))
    return complex(-(w @ (part.spring * z + value * (part.damper @ z))) / (w @ w))


def _couples(indices: Indices, values: Complex) -> list[tuple[int, int]]:
    """Sorted real eigenvalues two by two: those that nearly coincide together, the others as they come."""
    couples, single, i = [], [], 0
    while i < len(indices):
        one, two = indices[i], indices[min(i + 1, len(indices) - 1)]
        near = one != two and abs(values[two] - values[one]) <= CLOSE * abs(values[one])
        if near:
            couples.append((int(one), int(two)))
        else:
            single.append(int(one))
        i += 2 if near else 1
    return couples + list(zip(single[::2], single[1::2], strict=True))


def _common(state: Array, pair: Complex) -> tuple[Array, Array]:
    """The invariant plane of two nearly equal real eigenvalues, which needs no eigenvectors of its own."""
    from scipy.linalg import schur

    middle, radius = pair.mean().real, abs(pair[1] - pair[0]) + 1e-8 * float(np.max(np.abs(pair)))
    _, vectors, count = schur(state, output="real", sort=lambda x, y=0.0: abs(complex(x, y) - middle) <= 2 * radius)
    if count != 2:
        raise ValueError("damping: three or more real rates nearly coincide: separate them slightly")
    column = np.asarray(vectors[:, :2])
    return column, column.T @ state @ column
