"""Steps of Moreau–Jean time stepping (formulas: ``vibeam.solvers.integration.moreau``)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import entry
from vibeam.flight.kernels.moreau_layout import (
    CONTACT,
    DAMPING,
    FREE,
    GAP,
    HELD,
    IMPACTS,
    INVERSE,
    LOAD,
    RESTITUTION,
    STATIC,
    STEP,
    STIFFNESS,
    THETA,
)

Array = NDArray[np.float64]


@entry
def march(
    rows: Array, scheme: Array, sines: Array, pose: Array, samples: Array, pushed: Array, strikes: Array,
    totals: NDArray[np.int64],
) -> None:  # fmt: skip
    """Advance ``pose`` (2, n) by len(sines) − 1 steps; ``sines``: sin Ωt at their ends.

    ``samples`` (steps + 1, 2, n) and ``pushed`` (steps,) receive the states and the impulses, unless empty.
    """
    n, h, theta = rows.shape[1], scheme[STEP], scheme[THETA]
    mobility = 0.0
    for k in range(n):
        mobility += rows[CONTACT, k] * rows[CONTACT, k] * rows[INVERSE, k]
    watched = samples.shape[0] > 0
    totals[IMPACTS] = totals[HELD] = 0
    for i in range(sines.shape[0] - 1):
        force = theta * sines[i + 1] + (1.0 - theta) * sines[i]
        excess, before, free = -scheme[GAP], 0.0, 0.0
        for k in range(n):
            x, v = pose[0, k], pose[1, k]
            pull = rows[DAMPING, k] * v + rows[STIFFNESS, k] * (x + h * theta * v)
            rows[FREE, k] = v + h * (rows[LOAD, k] * force + rows[STATIC, k] - pull) * rows[INVERSE, k]
            excess += rows[CONTACT, k] * x
            before += rows[CONTACT, k] * v
            free += rows[CONTACT, k] * rows[FREE, k]
        impulse = 0.0
        if excess + 0.5 * h * before >= 0.0 and free + scheme[RESTITUTION] * before > 0.0:
            impulse = -(free + scheme[RESTITUTION] * before) / mobility
            if before > max(0.0, free - before):
                strikes[totals[IMPACTS], 0], strikes[totals[IMPACTS], 1] = i, before
                totals[IMPACTS] += 1
            else:
                totals[HELD] += 1
        for k in range(n):
            after = rows[FREE, k] + rows[CONTACT, k] * rows[INVERSE, k] * impulse
            pose[0, k] += h * (theta * after + (1.0 - theta) * pose[1, k])
            pose[1, k] = after
            if watched:
                samples[i + 1, 0, k], samples[i + 1, 1, k] = pose[0, k], after
        if watched:
            pushed[i] = impulse
