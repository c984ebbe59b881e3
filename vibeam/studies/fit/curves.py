"""Branches of the fitted model over frequency, for figures."""

from __future__ import annotations

import numpy as np

from vibeam.studies.fit.estimate import Minimum
from vibeam.studies.fit.problem import MOTIONS, ROUGH, Problem, value_of
from vibeam.studies.fit.surface import surface_of
from vibeam_models.arrays import Array

NEAR = 0.01  # half-width of the box of the modal data, share of the bounds


def branch(problem: Problem, minimum: Minimum, reference: str, motion: str, frequency: Array) -> tuple[Array, Array]:
    """Quantity of a reference (points,) on one motion at ``frequency`` (points,) Hz, and its standard error.

    The latter is linearised. NaN where there is no such motion.
    """
    group = next(each for each in problem.groups if each.reference == reference).at(frequency)
    forward, half = problem.forward[group.fidelity], np.full(len(minimum.x), NEAR)
    middle = np.clip(minimum.x, half, 1 - half)
    surface = surface_of(forward, group.omega, middle - half, middle + half, ROUGH)
    found = value_of(group, *surface.with_tangents(minimum.x), MOTIONS.index(motion))
    error = np.sqrt(np.einsum("kp,kl,lp->p", found.by, minimum.covariance, found.by))
    return np.where(found.beyond == 0, found.value, np.nan), error
