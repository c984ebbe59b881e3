"""Steps of Moreau–Jean time stepping (formulas: ``vibeam.solvers.integration.moreau``)."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import entry
from vibeam_models.arrays import Array, Index


@entry
def march(
    rows: Array, scheme: Array, sines: Array, pose: Array, samples: Array, pushed: Array, strikes: Array,
    totals: Index,
) -> None:  # fmt: skip
    """Advance ``pose`` (2, n) by len(sines) − 1 steps; ``sines``: sin Ωt at their ends.

    ``samples`` (steps + 1, 2, n) and ``pushed`` (steps,) receive the states and the impulses, unless empty.
    """
    n, h, theta = rows.shape[1], scheme[layout.MOREAU_STEP], scheme[layout.MOREAU_THETA]
    restitution = scheme[layout.MOREAU_RESTITUTION]
    contact, inverse, moved = rows[layout.MOREAU_CONTACT], rows[layout.MOREAU_INVERSE], rows[layout.MOREAU_FREE]
    mobility = 0.0
    for k in range(n):
        mobility += contact[k] * contact[k] * inverse[k]
    watched = samples.shape[0] > 0
    totals[layout.MOREAU_IMPACTS] = totals[layout.MOREAU_HELD] = 0
    for i in range(sines.shape[0] - 1):
        force = theta * sines[i + 1] + (1.0 - theta) * sines[i]
        excess, before, free = -scheme[layout.MOREAU_GAP], 0.0, 0.0
        for k in range(n):
            x, v = pose[0, k], pose[1, k]
            pull = rows[layout.MOREAU_DAMPING, k] * v + rows[layout.MOREAU_STIFFNESS, k] * (x + h * theta * v)
            moved[k] = v + h * (rows[layout.MOREAU_LOAD, k] * force + rows[layout.MOREAU_STATIC, k] - pull) * inverse[k]
            excess += contact[k] * x
            before += contact[k] * v
            free += contact[k] * moved[k]
        impulse = 0.0
        if excess + 0.5 * h * before >= 0.0 and free + restitution * before > 0.0:
            impulse = -(free + restitution * before) / mobility
            if before > max(0.0, free - before):
                strikes[totals[layout.MOREAU_IMPACTS], 0], strikes[totals[layout.MOREAU_IMPACTS], 1] = i, before
                totals[layout.MOREAU_IMPACTS] += 1
            else:
                totals[layout.MOREAU_HELD] += 1
        for k in range(n):
            after = moved[k] + contact[k] * inverse[k] * impulse
            pose[0, k] += h * (theta * after + (1.0 - theta) * pose[1, k])
            pose[1, k] = after
            if watched:
                samples[i + 1, 0, k], samples[i + 1, 1, k] = pose[0, k], after
        if watched:
            pushed[i] = impulse
