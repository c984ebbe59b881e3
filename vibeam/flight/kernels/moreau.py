"""Steps of Moreau–Jean time stepping (formulas: ``vibeam.solvers.integration.moreau``)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import moreau_layout
from vibeam.flight.kernels.compiler import entry

Array = NDArray[np.float64]


@entry
def march(
    rows: Array, scheme: Array, sines: Array, pose: Array, samples: Array, pushed: Array, strikes: Array,
    totals: NDArray[np.int64],
) -> None:  # fmt: skip
    """Advance ``pose`` (2, n) by len(sines) − 1 steps; ``sines``: sin Ωt at their ends.

    ``samples`` (steps + 1, 2, n) and ``pushed`` (steps,) receive the states and the impulses, unless empty.
    """
    n, h, theta = rows.shape[1], scheme[moreau_layout.STEP], scheme[moreau_layout.THETA]
    mobility = 0.0
    for k in range(n):
        mobility += rows[moreau_layout.CONTACT, k] * rows[moreau_layout.CONTACT, k] * rows[moreau_layout.INVERSE, k]
    watched = samples.shape[0] > 0
    totals[moreau_layout.IMPACTS] = totals[moreau_layout.HELD] = 0
    for i in range(sines.shape[0] - 1):
        force = theta * sines[i + 1] + (1.0 - theta) * sines[i]
        excess, before, free = -scheme[moreau_layout.GAP], 0.0, 0.0
        for k in range(n):
            x, v = pose[0, k], pose[1, k]
            pull = rows[moreau_layout.DAMPING, k] * v + rows[moreau_layout.STIFFNESS, k] * (x + h * theta * v)
            rows[moreau_layout.FREE, k] = (
                v
                + h
                * (rows[moreau_layout.LOAD, k] * force + rows[moreau_layout.STATIC, k] - pull)
                * rows[moreau_layout.INVERSE, k]
            )
            excess += rows[moreau_layout.CONTACT, k] * x
            before += rows[moreau_layout.CONTACT, k] * v
            free += rows[moreau_layout.CONTACT, k] * rows[moreau_layout.FREE, k]
        impulse = 0.0
        if excess + 0.5 * h * before >= 0.0 and free + scheme[moreau_layout.RESTITUTION] * before > 0.0:
            impulse = -(free + scheme[moreau_layout.RESTITUTION] * before) / mobility
            if before > max(0.0, free - before):
                strikes[totals[moreau_layout.IMPACTS], 0], strikes[totals[moreau_layout.IMPACTS], 1] = i, before
                totals[moreau_layout.IMPACTS] += 1
            else:
                totals[moreau_layout.HELD] += 1
        for k in range(n):
            after = (
                rows[moreau_layout.FREE, k] + rows[moreau_layout.CONTACT, k] * rows[moreau_layout.INVERSE, k] * impulse
            )
            pose[0, k] += h * (theta * after + (1.0 - theta) * pose[1, k])
            pose[1, k] = after
            if watched:
                samples[i + 1, 0, k], samples[i + 1, 1, k] = pose[0, k], after
        if watched:
            pushed[i] = impulse
