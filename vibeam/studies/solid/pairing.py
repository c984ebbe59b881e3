"""Pairing of the modes of two models of one rig by their shapes along the mean line.

Two shapes a and b, deflections at the same places, are alike by the modal assurance criterion
MAC = (a·b)²/((a·a)(b·b)) (R. J. Allemang, Sound and Vibration 37, 2003): 1 where one is a multiple of the other. Both
are mass-normalised, so that the mean line of partners moves alike: where it moves less than the beam's, as in a strip
that waves across its width, the MAC counts by the ratio of b·b to a·a. The pairs are those whose sum is largest. A mode
that leaves the mean line at rest (lateral bending, stretching, twist) has no partner.
"""

from __future__ import annotations

import numpy as np

from vibeam_models.arrays import Array, Flags, Index

ALIKE = 0.5  # from which two modes are one
STILL = 0.02  # rms deflection of the mean line times √(moving mass) below which a mode does not bend it


def likeness(ours: Array, theirs: Array) -> Array:
    """(a·b)²/((a·a) max(a·a, b·b)) of every pair (a, b) of mass-normalised shapes (k, a) and (k, b), none zero."""
    own, other = (np.sum(shapes**2, axis=0) for shapes in (ours, theirs))
    return np.asarray((ours.T @ theirs) ** 2 / (own[:, None] * np.maximum(own[:, None], other)))


def bending(shapes: Array, mass: float) -> Flags:
    """Mask (n,) of the mass-normalised modes whose ``shapes`` (k, n) bend the mean line of a rig of so much mass."""
    return np.asarray(np.sqrt(np.mean(shapes**2, axis=0) * mass) > STILL)


def partners(ours: Array, theirs: Array) -> tuple[Index, Array]:
    """Place (a,) of the partner among ``theirs`` (k, b) of each of ``ours`` (k, a), −1 without; likeness (a,), NaN."""
    from scipy.optimize import linear_sum_assignment

    alike = likeness(ours, theirs)
    found, known = np.full(len(alike), -1), np.full(len(alike), np.nan)
    for one, other in zip(*linear_sum_assignment(-alike), strict=True):
        if alike[one, other] >= ALIKE:
            found[one], known[one] = other, alike[one, other]
    return found, known
