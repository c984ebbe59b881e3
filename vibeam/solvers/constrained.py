"""The system held on the stop, in 2×2 blocks, for any damping."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.kernels.layout import (
    A11,
    A12,
    A21,
    A22,
    BLOCK_ROWS,
    CONSTANT1,
    CONSTANT2,
    LOAD1,
    LOAD2,
    ROW1,
    ROW2,
)
from vibeam.solvers.kernels.tables import rates

Array = NDArray[np.float64]
FURTHEST = 128  # binary orders by which the unit of time is moved at most
PROPORTIONAL = 1e-9  # relative; modal damping of a finite-element model has that much round-off
CLOSE = 1e-4  # relative distance of two eigenvalues below which their common subspace is taken instead of eigenvectors


@dataclass(frozen=True)
class Constrained:
    """n − 1 blocks sorted by rate (see ``layout`` for ``blocks``) and the maps between modal and block coordinates.

    The contact force is force + force_load Ω²B sin φ + Σ row·y; η = held + …, with contact·held = gap.
    """

    omega: Array
    sigma: Array
    disc: Array
    blocks: Array
    to_blocks: Array
    from_blocks: Array
    held: Array
    force: float
    force_load: float


def constrained(omega: Array, sigma: Array, contact: Array, load: Array, static: Array, gap: float) -> Constrained:
    """The system with contact·η = gap held and contact force F = contact·(f − Dη' − Λη)/S.

    It is made in a unit of time of the system's own, a power of two, so that other units of time change no digit.
    """
    fastest = max(float(omega.max()), float(sigma.max()))
    unit = float(np.ldexp(1.0, np.clip(np.frexp(fastest)[1], -FURTHEST, FURTHEST)))
    own = _in_own_time(omega / unit, sigma / unit, contact, load, static / unit**2, gap)
    n = len(omega)
    blocks, into, out = own.blocks.copy(), own.to_blocks.copy(), own.from_blocks.copy()
    blocks[[A11, A12, A21, A22, CONSTANT1, CONSTANT2]] *= unit
    blocks[[ROW1, ROW2]] *= unit**2
    blocks[[LOAD1, LOAD2]] /= unit
    into[:, n:] /= unit
    out[n:] *= unit
    return replace(
        own, omega=own.omega * unit, sigma=own.sigma * unit, disc=own.disc * unit**2, blocks=blocks,
        to_blocks=into, from_blocks=out, force=own.force * unit**2,
    )  # fmt: skip


def _in_own_time(omega: Array, sigma: Array, contact: Array, load: Array, static: Array, gap: float) -> Constrained:
    """The same in the units that are given.

    With η = contact·gap/S + Q z, Q an orthonormal basis of contact's complement, z'' + QᵀDQ z' + QᵀΛQ z = Qᵀ(f −
    Λ held). QᵀΛQ is diagonalised first; where the damping then still couples, (z, z') goes to real 2×2 blocks.
    """
    n, mobility = len(omega), float(contact @ contact)
    stiffness, damping, held = omega**2, 2 * sigma, contact * (gap / mobility)
    basis = _basis(contact, stiffness)
    damper = basis.T @ (damping[:, None] * basis)
    spring = np.diag(np.diag(basis.T @ (stiffness[:, None] * basis)))
    proportional = _proportional(damping, stiffness)
    if proportional is not None:
        damper = proportional[0] * np.eye(n - 1) + proportional[1] * spring
    state = np.block([[np.zeros((n - 1, n - 1)), np.eye(n - 1)], [-spring, -damper]])
    into, out, a = _sorted(state, _decoupled(state, int(np.count_nonzero(contact)) - 1))
    lift = np.kron(np.eye(2), basis)
    row = -np.concatenate([contact * stiffness, contact * damping]) @ lift @ out / mobility
    pushed = into[:, n - 1 :] @ basis.T
    blocks = np.zeros((BLOCK_ROWS, n - 1))
    blocks[A11 : A11 + 4] = a.reshape(n - 1, 4).T
    blocks[[ROW1, ROW2]] = row.reshape(n - 1, 2).T
    blocks[[CONSTANT1, CONSTANT2]] = (pushed @ (static - stiffness * held)).reshape(n - 1, 2).T
    blocks[[LOAD1, LOAD2]] = (pushed @ load).reshape(n - 1, 2).T
    return Constrained(
        *_pair_constants(a),
        blocks,
        np.ascontiguousarray(into @ lift.T),
        np.ascontiguousarray(lift @ out),
        held,
        float(contact @ (static - stiffness * held)) / mobility,
        float(contact @ load) / mobility,
    )


def _proportional(damping: Array, stiffness: Array) -> tuple[float, float] | None:
    """(a, b) where damping = a + b·stiffness to round-off (Rayleigh's, the paper's D): it couples nothing when held."""
    least, most = int(np.argmin(stiffness)), int(np.argmax(stiffness))
    if stiffness[most] == stiffness[least]:
        return (float(damping[0]), 0.0) if np.ptp(damping) == 0 else None
    b = (damping[most] - damping[least]) / (stiffness[most] - stiffness[least])
    a = damping[least] - b * stiffness[least]
    off = np.abs(a + b * stiffness - damping)
    return (float(a), float(b)) if np.all(off <= PROPORTIONAL * np.abs(damping)) else None


def _basis(contact: Array, stiffness: Array) -> Array:
    """An orthonormal basis (n, n−1) of contact's complement, stiffness diagonal in it; silent modes last, alone."""
    loud = contact != 0
    complement = _complement(contact[loud])
    turn = np.linalg.eigh(complement.T @ (stiffness[loud, None] * complement))[1]
    basis = np.zeros((len(contact), len(contact) - 1))
    basis[np.ix_(loud, np.arange(complement.shape[1]))] = complement @ turn
    basis[np.flatnonzero(~loud), np.arange(complement.shape[1], len(contact) - 1)] = 1.0
    return basis


def _complement(contact: Array) -> Array:
    """An orthonormal basis (n, n−1) of the vectors orthogonal to ``contact``, by one Householder reflection."""
    unit = contact / np.linalg.norm(contact)
    pivot = int(np.argmax(np.abs(unit)))
    normal = unit.copy()
    normal[pivot] += np.copysign(1.0, unit[pivot])
    reflection = np.eye(len(unit)) - 2 * np.outer(normal, normal) / (normal @ normal)
    return np.delete(reflection, pivot, axis=1)


def _decoupled(state: Array, coupled: int) -> Array:
    """Columns that take ``state`` of (z, z') to 2×2 blocks; only the first ``coupled`` z can be coupled by damping."""
    m = len(state) // 2
    out = _pairing(m)
    rows = np.concatenate([np.arange(coupled), m + np.arange(coupled)])
    inner = state[np.ix_(rows, rows)]
    if not _diagonal(inner[coupled:, coupled:]):
        out[np.ix_(rows, np.arange(2 * coupled))] = _invariant_planes(inner)
    return out


def _diagonal(matrix: Array) -> bool:
    scale = np.abs(np.diag(matrix)).max(initial=0.0)
    return bool(np.abs(matrix - np.diag(np.diag(matrix))).max(initial=0.0) <= 1e-14 * scale)


def _pairing(m: int) -> Array:
    """Columns that put z_k beside z_k'."""
    order = np.stack([np.arange(m), m + np.arange(m)], axis=1).ravel()
    return np.eye(2 * m)[:, order]


def _diagonal_blocks(matrix: Array) -> Array:
    m = len(matrix) // 2
    return np.array([matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] for k in range(m)]).reshape(m, 2, 2)


def _pair_constants(a: Array) -> tuple[Array, Array, Array]:
    """ω, σ and σ² − ω² of each block (m, 2, 2)."""
    sigma = -(a[:, 0, 0] + a[:, 1, 1]) / 2
    square = a[:, 0, 0] * a[:, 1, 1] - a[:, 0, 1] * a[:, 1, 0]
    disc = ((a[:, 0, 0] - a[:, 1, 1]) / 2) ** 2 + a[:, 0, 1] * a[:, 1, 0]
    return np.sqrt(np.maximum(square, 0.0)), np.maximum(sigma, 0.0), disc


def _sorted(state: Array, out: Array) -> tuple[Array, Array, Array]:
    """The inverse of the blocks' columns, the columns and the blocks (m, 2, 2) in the order of their rates.

    Inverted once: above 32 modes BLAS takes several threads to it, which on a busy machine wait for each other.
    """
    into = np.asarray(np.linalg.inv(out), dtype=float)
    a = _diagonal_blocks(into @ state @ out)
    omega, sigma, _ = _pair_constants(a)
    order = np.argsort(rates(omega, sigma), kind="stable")
    both = np.stack([2 * order, 2 * order + 1], axis=1).ravel()
    return into[both], out[:, both], a[order]


def _invariant_planes(state: Array) -> Array:
    """Columns that span real two-dimensional invariant subspaces of ``state``."""
    values, vectors = np.linalg.eig(state)
    near = 2 * np.abs(values.imag) <= CLOSE * np.abs(values)  # as ``_couples`` judges the two of a conjugate pair
    turning = vectors[:, ~near & (values.imag > 0)].T
    columns = list(np.linalg.qr(np.stack([turning.real, turning.imag], axis=2))[0])
    real = np.flatnonzero(near)
    real = real[np.lexsort((values[real].imag, values[real].real))]
    for first, second in _couples(real, values[real]):
        pair = values[[first, second]]
        if abs(pair[1] - pair[0]) <= CLOSE * abs(pair).max():
            columns.append(_common_plane(state, pair))
        else:
            columns.append(np.stack([vectors[:, first].real, vectors[:, second].real], axis=1))
    return np.concatenate(columns, axis=1)


def _couples(indices: NDArray[np.int64], values: NDArray[np.complex128]) -> list[tuple[int, int]]:
    """Sorted eigenvalues two by two: those that nearly coincide together, the others as they come."""
    couples, single, i = [], [], 0
    while i < len(indices):
        if i + 1 < len(indices) and abs(values[i + 1] - values[i]) <= CLOSE * abs(values[i]):
            couples.append((int(indices[i]), int(indices[i + 1])))
            i += 2
        else:
            single.append(int(indices[i]))
            i += 1
    return couples + list(zip(single[::2], single[1::2], strict=True))


def _common_plane(state: Array, pair: NDArray[np.complex128]) -> Array:
    """The invariant subspace of two nearly equal eigenvalues, which needs no eigenvectors of its own."""
    from scipy.linalg import schur

    middle, radius = pair.mean().real, abs(pair[1] - pair[0]) + 1e-9 * float(np.abs(state).max())
    _, vectors, count = schur(state, output="real", sort=lambda x, y=0.0: abs(complex(x, y) - middle) <= 2 * radius)
    if count != 2:
        raise ValueError("the system at rest on the stop has three or more equal real rates: separate them slightly")
    return np.asarray(vectors[:, :2])
