"""Which of the closed-form motions at measured points are motions: clear of the stop in between, and stable."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.orbits.admissibility import AdmissibilityCheck
from vibeam.orbits.orbit import orbits
from vibeam.studies.fit.points import Points
from vibeam.studies.fit.problem import NO_CONTACT, Problem
from vibeam.system.impact_system import Drive

Array = NDArray[np.float64]

Flags = NDArray[np.bool_]

SAME = 1e-6  # relative difference of impulses that are one


def actual(problem: Problem, x: Array, beyond: Array) -> Flags:
    """Whether each motion (3, points) is one; ``beyond`` of ``Problem.motions``."""
    return np.concatenate(
        [
            _of_group(problem, group, x, part)
            for group, part in zip(problem.groups, _parts(problem, beyond), strict=True)
        ],
        axis=1,
    )


def _parts(problem: Problem, whole: Array) -> list[Array]:
    ends = np.cumsum([len(each) for each in problem.groups])[:-1]
    return np.split(whole, ends, axis=1)


def _of_group(problem: Problem, group: Points, x: Array, beyond: Array) -> Flags:
    forward = problem.forward[group.fidelity]
    values = problem.values(x)
    system, data = forward.system(values), forward.data(values, group.omega)
    witness = AdmissibilityCheck(system, float(group.omega.min()))
    found = np.zeros(beyond.shape, dtype=bool)
    found[NO_CONTACT] = beyond[NO_CONTACT] == 0
    for j, (omega, drive) in enumerate(zip(group.omega.tolist(), data.drive.tolist(), strict=True)):
        both = orbits(system, Drive(omega=omega, amplitude=drive), group.periods, witness)
        exists = [k for k in (0, 1) if beyond[k, j] == 0]
        for k, orbit in zip(exists, both, strict=False):
            found[k, j] = orbit.admissible and (orbit.stable or group.unstable)
    return found
