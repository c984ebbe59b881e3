"""Modes that coincide: equal ones turned so that one carries all of the contact, the common plane of nearly equal ones.

Two equal modes with contact values a, b are one mode with √(a² + b²) and another that never feels the contact (Cuppen
1981; Golub & Van Loan, § 8.4.2). Left as they are, the secular equation has poles that coincide and the state matrix
eigenvalues of which no method tells the planes: rigid bodies' Jordan blocks, critical twins. Each set is turned by a
Householder reflection; what it leaves beside the carrier stands alone, exactly.

Two eigenvalues that nearly coincide span an invariant plane; where they do coincide, there are no two eigenvectors.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam_models.arrays import Array, Complex, Index

EQUAL = 16 * np.finfo(float).eps  # relative: what rounding may leave between equal rates
INSEPARABLE = (
    "damping: modes coincide so nearly, in rates and shapes, that contact has no closed form in which they are told "
    "apart: make their damping ratios differ by 0.1 % or more"
)
DISTINCT = 1e-4  # relative distance of two eigenvalues above which QR's eigenvectors span their plane


def deflated(system: LinearSystem) -> tuple[LinearSystem, Array] | None:
    """The system in coordinates z̃ = Q z, and the orthogonal, symmetric Q (n, n); None where no two are equal."""
    sets = _equal_sets(system)
    if not sets:
        return None
    turn, contact = np.eye(len(system.spring)), system.contact.copy()
    spring, damper = system.spring.copy(), system.damper.copy()
    for group in sets:
        turn[np.ix_(group, group)], contact[group[0]], contact[group[1:]] = _reflection(contact[group])
        spring[group], damper[group, group] = spring[group[0]], damper[group[0], group[0]]
    return replace(system, spring=spring, damper=damper, contact=contact), turn


def _equal_sets(system: LinearSystem) -> list[Index]:
    """The sets of two and more that the stop couples, and damping does not."""
    damping = np.diag(system.damper)
    alone = np.count_nonzero(system.damper, axis=1) - (damping != 0) == 0
    left = np.flatnonzero(alone & (system.contact != 0)) if system.stiffness > 0 else np.zeros(0, dtype=np.int64)
    found = []
    while len(left) > 1:
        first = left[0]
        near = np.abs(system.spring[left] - system.spring[first]) <= EQUAL * system.spring[first]
        near &= np.abs(damping[left] - damping[first]) <= EQUAL * damping[first]
        if np.count_nonzero(near) > 1:
            found.append(left[near])
        left = left[~near]
    return found


def _reflection(row: Array) -> tuple[Array, float, float]:
    """The Householder matrix H with H row = (±|row|, 0, …), and these two values."""
    size = float(np.linalg.norm(row))
    normal = row / size
    first = -float(np.copysign(1.0, row[0]))
    normal[0] -= first
    return np.eye(len(row)) - 2 * np.outer(normal, normal) / (normal @ normal), first * size, 0.0


def common_plane(state: Array, pair: Complex, vectors: Complex) -> tuple[Array, Array]:
    """The invariant plane of two nearly equal eigenvalues, which needs no eigenvectors of its own."""
    from scipy.linalg import schur

    distance, size = float(abs(pair[1] - pair[0])), float(np.max(np.abs(pair)))
    if distance > DISTINCT * size:
        second = vectors[:, 0].imag if pair[0].imag != 0 else vectors[:, 1].real
        column = np.linalg.qr(np.stack([vectors[:, 0].real, second], axis=1))[0]
        return column, column.T @ state @ column
    middle, limit = pair.mean().real, _limit(schur(state, output="real")[0], pair.mean().real)
    _, every, count = schur(state, output="real", sort=lambda x, y=0.0: abs(complex(x, y) - middle) <= limit)
    if count != 2:
        raise ValueError(INSEPARABLE)
    column = np.asarray(every[:, :2])
    return column, column.T @ state @ column


def _limit(triangle: Array, middle: float) -> float:
    """The distance from ``middle`` between that of the two nearest eigenvalues of a real Schur form and the third's.

    Round-off parts a double eigenvalue by its root, in every algorithm in another way: how far the two are apart says
    little.
    """
    distance = np.sort(np.abs(np.linalg.eigvals(triangle) - middle))
    return float(np.sqrt(distance[1] * distance[2])) if len(distance) > 2 else np.inf
