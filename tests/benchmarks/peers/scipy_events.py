"""scipy's solve_ivp, started again behind every terminal event."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from peers.job import Answer, Array, Entry, Job, march, timed


def prepare(job: Job, method: str, rtol: float, longest: float) -> Callable[[], Answer]:
    """``longest``: step, as a share of the drive period, since events are looked for at the ends of steps only."""
    stiffness, damping, c, n = job.omega**2, 2 * job.zeta * job.omega, job.contact, job.size
    jacobian = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(stiffness), -np.diag(damping)]])
    own: dict[str, Any] = {"jac": jacobian} if method == "Radau" else {}

    def excess(_: float, y: Array, *__: Any) -> float:
        return float(c @ y[:n]) - job.gap

    excess.terminal, excess.direction = True, 1.0  # type: ignore[attr-defined]
    rate = one_mode(job) if n == 1 else many_modes(job)

    def leg(omega: float, t: float, y: Array, end: float) -> tuple[float, Array, bool]:
        found = solve_ivp(
            rate, (t, end), y, method=method, args=(omega,), events=excess, rtol=rtol, atol=1e-2 * rtol,
            max_step=longest * 2 * np.pi / omega, **own,
        )  # fmt: skip
        return float(found.t[-1]), found.y[:, -1], bool(found.status == 1)

    return timed(lambda: march(job, leg))


def one_mode(job: Job) -> Callable[[float, Array, float], Any]:
    """In plain numbers, the fastest that scipy takes."""
    stiffness, damping = float(job.omega[0] ** 2), float(2 * job.zeta[0] * job.omega[0])
    push = float(job.load[0]) * job.amplitude

    def rate(t: float, y: Array, omega: float) -> tuple[float, float]:
        q, v = y.tolist()
        return v, push * omega**2 * math.sin(omega * t) - damping * v - stiffness * q

    return rate


def many_modes(job: Job) -> Callable[[float, Array, float], Any]:
    """In arrays."""
    n, stiffness, damping, push = job.size, job.omega**2, 2 * job.zeta * job.omega, job.load * job.amplitude

    def rate(t: float, y: Array, omega: float) -> Array:
        slope = np.empty(2 * n)
        slope[:n] = y[n:]
        slope[n:] = push * (omega**2 * math.sin(omega * t)) - damping * y[n:] - stiffness * y[:n]
        return slope

    return rate


def entry(setting: str, method: str, rtol: float, longest: float = np.inf, **limits: int) -> Entry:
    return Entry("scipy", setting, partial(prepare, method=method, rtol=rtol, longest=longest), "scipy", **limits)


ENTRIES = [
    entry("RK23 1e-4, as the paper", "RK23", 1e-4),
    entry("DOP853 1e-10", "DOP853", 1e-10, 0.1),
    entry("Radau 1e-5", "Radau", 1e-5, 0.1, fewest_modes=4),
]
