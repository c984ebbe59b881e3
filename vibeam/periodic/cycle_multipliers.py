"""Floquet multipliers of a periodic motion from its tangent maps, the weakest with as many digits as the strongest.

The eigenvalues of the product M of all maps are good to a share ε of the largest. Where some are weaker than that by
far (a mode that dies within the period), they are taken from M's factors one by one: an orthonormal frame is carried
round and round (orthogonal iteration, Q_{k+1} R_{k+1} = M Q_k factor by factor) until it returns to itself up to
rotations within groups of about equal size; on each group the eigenvalues of (Q_kᵀ Q_{k+1}) R_{k+1} are then M's
(Bojanczyk, Golub & Van Dooren 1992, the periodic Schur form). Where directions are lost (rests, R = 0) the frame spans
what is left of them, and the others are 0.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam_models.arrays import Array, Complex

DECAY = 8.0  # nepers within one factor, beyond which the weakest direction would drown in round-off
WEAK = 1e-6  # share of the largest multiplier below which the product's eigenvalues are not good enough
ROUNDS = 100  # of the frame
CONVERGED = 40.0  # nepers by which two directions must have parted in all rounds to be told apart


def cycle_multipliers(maps: TangentMaps, units: Array) -> Complex:
    """Multipliers (2n,), largest first, of a periodic motion; exactly 0 for directions that it loses.

    ``units`` (2n,): factors that give displacements and velocities one unit.
    """
    count, lost = len(maps), [maps.lost(i) for i in range(len(maps))]
    first = int(np.argmax(lost)) if max(lost) else count - 1
    factors = [
        matrix * (units[:, None] / units)
        for k in range(count)
        for matrix in maps.steps((first + 1 + k) % count, maps.fastest, DECAY)
    ]
    frame = np.linalg.qr(units[:, None] * maps.kept(first))[0]
    found = np.zeros(2 * maps.system.size, dtype=complex)
    if frame.shape[1]:
        found[: frame.shape[1]] = _eigenvalues(factors, frame)
    return np.asarray(found[np.argsort(-np.abs(found), kind="stable")])


def _eigenvalues(factors: list[Array], frame: Array) -> Complex:
    """Eigenvalues of the factors' product (the last one leftmost) on the space that the frame spans."""
    carried = frame
    for matrix in factors:
        carried = matrix @ carried
    values = np.linalg.eigvals(frame.T @ carried).astype(complex)
    if np.abs(values).min() >= WEAK * np.abs(values).max():
        return values
    return _by_frames(factors, frame @ np.linalg.qr(_shuffled(frame.shape[1]))[0])


def _shuffled(size: int) -> Array:
    """A matrix without any direction of its own."""
    return np.random.default_rng(0).standard_normal((size, size))


def _by_frames(factors: list[Array], frame: Array) -> Complex:
    logs = np.zeros(frame.shape[1])
    for _ in range(ROUNDS):
        begin, total = frame, np.eye(len(logs))
        for matrix in factors:
            frame, upper = np.linalg.qr(matrix @ frame)
            total = upper @ total
        with np.errstate(divide="ignore"):
            logs += np.log(np.abs(np.diag(total)))
    turned = begin.T @ frame
    cuts = [0, *(np.flatnonzero(-np.diff(logs) > CONVERGED) + 1), len(logs)]
    groups = [slice(a, b) for a, b in pairwise(cuts)]
    return np.concatenate([np.linalg.eigvals(turned[g, g] @ total[g, g]).astype(complex) for g in groups])
