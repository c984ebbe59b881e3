"""Coordinates of equal stiffness and damping that a stop couples: deflation to one that carries all of the contact.

Two equal modes with contact values a, b are one mode with √(a² + b²) and another that never feels the contact (Cuppen
1981; Golub & Van Loan, § 8.4.2). Left as they are, the secular equation has poles that coincide and the state matrix
eigenvalues of which no method tells the planes: rigid bodies' Jordan blocks, critical twins. Each set is turned by a
Householder reflection; what it leaves beside the carrier stands alone, exactly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.linear.eigenpairs import Linear
from vibeam_models.arrays import Array

Indices = NDArray[np.int64]
EQUAL = 16 * np.finfo(float).eps  # relative: what rounding may leave between equal rates


def deflated(system: Linear) -> tuple[Linear, Array] | None:
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


def _equal_sets(system: Linear) -> list[Indices]:
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
