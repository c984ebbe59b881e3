"""SUNDIALS' CVODE through scikit-SUNDAE, started again behind every terminal event.

An object used again after a terminal event gives old events back (1.2.0), so each flight has a new one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from sksundae.cvode import CVODE

from peers.job import Answer, Array, Entry, Job, march, timed


def prepare(job: Job, method: str, rtol: float) -> Callable[[], Answer]:
    """``method``: "BDF" with its Jacobian, or "Adams" with functional iteration's own."""
    n, c = job.size, job.contact
    stiffness, damping, push = job.omega**2, 2 * job.zeta * job.omega, job.load * job.amplitude
    jacobian = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(stiffness), -np.diag(damping)]])
    one = tuple(float(x[0]) for x in (stiffness, damping, push))

    def leg(omega: float, t: float, y: Array, end: float) -> tuple[float, Array, bool]:
        def rate(now: float, state: Array, slope: Array) -> None:
            force = omega**2 * math.sin(omega * now)
            if n == 1:
                slope[0] = state[1]
                slope[1] = one[2] * force - one[1] * state[1] - one[0] * state[0]
                return
            slope[:n] = state[n:]
            slope[n:] = push * force - damping * state[n:] - stiffness * state[:n]

        def excess(_: float, state: Array, events: Array) -> None:
            events[0] = c @ state[:n] - job.gap

        def slopes(_: float, state: Array, slope: Array, matrix: Array) -> None:
            matrix[:] = jacobian

        excess.terminal, excess.direction = [True], [1]  # type: ignore[attr-defined]
        solver = CVODE(
            rate, method=method, rtol=rtol, atol=1e-2 * rtol, eventsfn=excess, num_events=1, jacfn=slopes,
            max_num_steps=100_000,
        )  # fmt: skip
        found: Any = solver.solve(np.array([t, end]), y)
        struck = found.t_events is not None and len(found.t_events) > 0
        return float(found.t[-1]), np.array(found.y[-1]), struck

    return timed(lambda: march(job, leg))


def entry(setting: str, method: str, rtol: float) -> Entry:
    return Entry("SUNDAE CVODE", setting, partial(prepare, method=method, rtol=rtol), "scikit-sundae")


ENTRIES = [
    entry("BDF 1e-4", "BDF", 1e-4),
    entry("BDF 1e-9", "BDF", 1e-9),
    entry("Adams 1e-9", "Adams", 1e-9),
]
