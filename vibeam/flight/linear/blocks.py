"""A linear system with any damping, free, pushed by a linear stop or held on one, in real 2×2 blocks.

z'' + D z' + Λ z + w f = 0 with f = 0 (free), f = (k + c d/dt) w·z (pushed) or w·z = 0 (held). In energy coordinates
(s z, z'), s = ω (1 for a coordinate without stiffness), the state matrix is nearly normal. Coordinates that nothing
couples are blocks by themselves, exactly. The others are decoupled by eigenvectors, each refined to round-off
(``eigenpairs``): a complex pair spans a plane in which A is (a b; −b a) up to lengths, two real eigenvalues span one in
which it is diagonal, two that nearly coincide have one in common.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from vibeam.flight.linear.coincident_modes import INSEPARABLE, common_plane, deflated
from vibeam.flight.linear.eigenpairs import LinearSystem, refined, refined_plane
from vibeam_models.arrays import Array, Complex, Index

CLOSE = 0.1  # relative distance of two eigenvalues below which their common plane is taken
WORST = 1e7  # condition of the columns beyond which too many digits would be lost
PROPORTIONAL = 1e-9  # relative; modal damping of a finite-element model has that much round-off


@dataclass(frozen=True)
class Planes:
    """(s z, z') = ``columns`` · y with y' = A y in m ``blocks`` (m, 2, 2); ``inverse`` · ``columns`` = 1.

    Of a system that is held ``inverse`` takes off what moves the contact point, with the least energy.
    """

    columns: Array
    inverse: Array
    blocks: Array


def planes(system: LinearSystem) -> Planes:
    """The blocks; ValueError where modes coincide so closely that there are none: three near critical damping.

    Those found last are kept: another gap or load, as at every point of a sweep with drift, changes none of them.
    """
    arrays = (np.asarray(part, dtype=float).tobytes() for part in (system.spring, system.damper, system.contact))
    return _kept(*arrays, float(system.stiffness), float(system.damping))


@lru_cache(maxsize=8)
def _kept(spring: bytes, damper: bytes, contact: bytes, stiffness: float, damping: float) -> Planes:
    rates, n = np.frombuffer(spring), len(spring) // 8
    system = LinearSystem(rates, np.frombuffer(damper).reshape(n, n), np.frombuffer(contact), stiffness, damping)
    found = _found(system)
    for array in (found.columns, found.inverse, found.blocks):
        array.flags.writeable = False
    return found


def _found(system: LinearSystem) -> Planes:
    turned = deflated(system)
    try:
        if turned is None:
            return _planes(system)
        found, both = _planes(turned[0]), np.kron(np.eye(2), turned[1])
    except np.linalg.LinAlgError:
        raise ValueError(INSEPARABLE) from None
    return Planes(both @ found.columns, found.inverse @ both, found.blocks)


def _planes(system: LinearSystem) -> Planes:
    n, columns, inverses, blocks = len(system.spring), [], [], []
    for group in _groups(system):
        part = system.part(group)
        alone = len(group) == 1 and (system.stiffness == 0 or part.contact[0] == 0)
        found = [_single(part)] if alone else _several(part)
        if not found:
            continue
        small = np.concatenate([column for column, _ in found], axis=1)
        rows = np.concatenate([group, n + group])
        column, inverse = np.zeros((2 * n, small.shape[1])), np.zeros((small.shape[1], 2 * n))
        column[rows], inverse[:, rows] = small, _inverse(part, small)
        columns.append(column)
        inverses.append(inverse)
        blocks += [block for _, block in found]
    if not columns:
        return Planes(np.zeros((2 * n, 0)), np.zeros((0, 2 * n)), np.zeros((0, 2, 2)))
    return Planes(np.concatenate(columns, axis=1), np.concatenate(inverses), np.array(blocks))


def pair_constants(blocks: Array) -> tuple[Array, Array, Array]:
    """ω, σ and σ² − ω² of each block (m, 2, 2)."""
    a, b, c, d = blocks[:, 0, 0], blocks[:, 0, 1], blocks[:, 1, 0], blocks[:, 1, 1]
    square, disc = a * d - b * c, ((a - d) / 2) ** 2 + b * c
    return np.sqrt(np.maximum(square, 0.0)), np.maximum(-(a + d) / 2, 0.0), disc


def _groups(system: LinearSystem) -> list[Index]:
    """Coordinates that damping or the stop couples, together."""
    size = np.sqrt(np.abs(np.diag(system.damper)))
    couples = np.abs(system.damper) > 1e-15 * np.outer(size, size)
    if system.stiffness > 0:
        couples |= np.outer(system.contact != 0, system.contact != 0)
    left, groups = np.ones(len(size), dtype=bool), []
    while left.any():
        group = np.arange(len(size)) == np.argmax(left)
        while True:
            wider = group | couples[group].any(axis=0)
            if np.array_equal(wider, group):
                break
            group = wider
        groups.append(np.flatnonzero(group))
        left &= ~group
    return groups


def _inverse(part: LinearSystem, columns: Array) -> Array:
    """Inverse of the columns; of a held system with the two directions beside them that move the contact point.

    Inverted once: above 32 modes BLAS takes several threads to it, which on a busy machine wait for each other.
    """
    square = columns
    if columns.shape[1] < len(columns):
        w, zero = part.contact / np.linalg.norm(part.contact), np.zeros(len(part.contact))
        out = w / part.scale
        both = np.stack([np.concatenate([out / np.linalg.norm(out), zero]), np.concatenate([zero, w])], axis=1)
        square = np.concatenate([columns, both], axis=1)
    inverse = np.asarray(np.linalg.inv(square), dtype=np.float64)
    if np.linalg.norm(square) * np.linalg.norm(inverse) > WORST * len(square):
        raise ValueError(INSEPARABLE)
    return inverse[: columns.shape[1]]


def _single(part: LinearSystem) -> tuple[Array, Array]:
    s = part.scale[0]
    return np.eye(2), np.array([[0.0, s], [-part.spring[0] / s, -part.damper[0, 0]]])


def _several(part: LinearSystem) -> list[tuple[Array, Array]]:
    if part.held and len(part.spring) == 1:
        return []
    if part.held and proportional(part):
        return _undisturbed(part)
    state, lift = _state(part)
    values, vectors = np.linalg.eig(state)
    values, vectors = values.astype(complex), vectors.astype(complex)
    turning, couples, singles = _sorted_out(values)
    picked = np.concatenate([turning, singles]).astype(np.int64)
    value, vector = refined(part, values[picked], lift @ vectors[:, picked])
    count = len(turning)
    found = _turning(value[:count], vector[:, :count])
    for k in range(count, len(picked), 2):
        found.append((np.stack([vector[:, k].real, vector[:, k + 1].real], axis=1), np.diag(value[k : k + 2].real)))
    for couple in couples:
        column, block = common_plane(state, values[couple], vectors[:, couple])
        found.append(refined_plane(part, lift @ column, block))
    return found


def proportional(part: LinearSystem) -> bool:
    """True where D = a + bΛ to round-off (Rayleigh's, the paper's D): it couples nothing when held."""
    if not part.uncoupled:
        return False
    damping, stiffness = np.diag(part.damper), part.spring
    least, most = int(np.argmin(stiffness)), int(np.argmax(stiffness))
    if stiffness[most] == stiffness[least]:
        return bool(np.ptp(damping) == 0)
    b = (damping[most] - damping[least]) / (stiffness[most] - stiffness[least])
    off = np.abs(damping[least] + b * (stiffness - stiffness[least]) - damping)
    return bool(np.all(off <= PROPORTIONAL * np.abs(damping)))


def _undisturbed(part: LinearSystem) -> list[tuple[Array, Array]]:
    """A plane for every mode of the held system without damping, which couples none of them."""
    basis, size = _held_modes(part)
    n, scale = len(part.spring), part.scale[:, None]
    without = replace(part, damper=np.zeros((n, n)))
    rates = np.asarray(1j * size, dtype=np.complex128)
    value, vector = refined(without, rates, np.concatenate([scale * basis, rates * basis]))
    shapes, found = vector[:n].real / scale, []
    for k in range(n - 1):
        shape = shapes[:, k] / np.linalg.norm(shapes[:, k])
        length, column = float(np.linalg.norm(part.scale * shape)), np.zeros((2 * n, 2))
        column[:n, 0], column[n:, 1] = part.scale * shape / length, shape
        damping = float(np.sum(np.diag(part.damper) * shape**2))
        found.append((column, np.array([[0.0, length], [-(float(value[k].imag) ** 2) / length, -damping]])))
    return found


def _held_modes(part: LinearSystem) -> tuple[Array, Array]:
    """Modes (n, n−1) of the held system without damping, orthonormal, and their frequencies (n−1,), by QR."""
    basis = complement(part.contact)
    _, size, turn = np.linalg.svd(np.sqrt(np.maximum(part.spring, 0.0))[:, None] * basis, full_matrices=False)
    return basis @ turn.T, size


def _state(part: LinearSystem) -> tuple[Array, Array]:
    """The state matrix, of the coordinates that are left where the stop holds one, and the way back to all of them."""
    n, w, s = len(part.spring), part.contact, part.scale
    if part.held:
        basis, size = _held_modes(part)
        lengths, m = np.sqrt(np.sum((s[:, None] * basis) ** 2, axis=0)), n - 1
        state, lift = np.zeros((2 * m, 2 * m)), np.zeros((2 * n, 2 * m))
        lift[:n, :m], lift[n:, m:] = s[:, None] * basis / lengths, basis
        state[:m, m:], state[m:, :m] = np.diag(lengths), -np.diag(size**2 / lengths)
        state[m:, m:] = -basis.T @ part.damper @ basis
        return state, lift
    spring = np.diag(part.spring) + part.stiffness * np.outer(w, w)
    damper = part.damper + part.damping * np.outer(w, w)
    return np.block([[np.zeros((n, n)), np.diag(s)], [-spring / s, -damper]]), np.eye(2 * n)


def complement(row: Array) -> Array:
    """An orthonormal basis (n, n−1) of the vectors orthogonal to ``row``, by one Householder reflection."""
    unit = row / np.linalg.norm(row)
    pivot = int(np.argmax(np.abs(unit)))
    normal = unit.copy()
    normal[pivot] += np.copysign(1.0, unit[pivot])
    reflection = np.eye(len(unit)) - 2 * np.outer(normal, normal) / (normal @ normal)
    return np.delete(reflection, pivot, axis=1)


def _turning(values: Complex, vectors: Complex) -> list[tuple[Array, Array]]:
    """Columns Re v and Im v, the phase of v such that they are orthogonal, to unit length, and A in them.

    A (Re v, Im v) = (Re v, Im v) (a b; −b a).
    """
    vectors = vectors * np.exp(-0.5j * np.angle(np.sum(vectors**2, axis=0)))
    columns = np.stack([vectors.real, vectors.imag], axis=2)
    sizes = np.sqrt(np.sum(columns**2, axis=0))
    ratio = sizes[:, 0] / sizes[:, 1]
    blocks = np.array([[values.real, values.imag * ratio], [-values.imag / ratio, values.real]])
    return [(columns[:, k] / sizes[k], blocks[:, :, k]) for k in range(len(values))]


def _sorted_out(values: Complex) -> tuple[Index, list[list[int]], list[int]]:
    """Eigenvalues that turn (one of each pair), those that nearly coincide two by two, and the other real ones."""
    near = 2 * np.abs(values.imag) <= CLOSE * np.abs(values)
    turning = np.flatnonzero(~near & (values.imag > 0))
    couples = [[int(k), int(k) + 1] for k in np.flatnonzero(near & (values.imag > 0))]
    real = np.flatnonzero(near & (values.imag == 0))
    real = real[np.argsort(values[real].real, kind="stable")]
    singles, i = [], 0
    while i < len(real):
        pair = values[real[i : i + 2]]
        together = len(pair) == 2 and abs(pair[1] - pair[0]) <= CLOSE * abs(pair[0])
        if together:
            couples.append([int(k) for k in real[i : i + 2]])
        else:
            singles.append(int(real[i]))
        i += 2 if together else 1
    return turning, couples, singles
