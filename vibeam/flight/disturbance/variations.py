"""Variational equations along a contact that is integrated, Hertz' or Hunt and Crossley's law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.disturbance.derivatives import stop_of
from vibeam.flight.kernels import layout
from vibeam.flight.linear.regimes import damper_of
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.system.impact_system import Drive, ImpactSystem

TOLERANCE = 1e-12  # of a step, relative and of the map in units of velocity


def variations(system: ImpactSystem, drive: Drive, row: Array, pose: Array, side: int, parts: int) -> list[Array]:
    """Maps (2n, 2n) over ``parts`` equal parts of a contact, the segment ``row`` of a trace, from ``pose`` (2, n)."""
    from scipy.integrate import solve_ivp

    n, at, duration = system.size, row[layout.AT_CLOCK], row[layout.DURATION]
    units = np.concatenate([np.where(system.omega > 0, system.omega, drive.omega), np.ones(n)])
    contact, gap = stop_of(system, side)
    numbers = system.contact_law.kernel_numbers().values
    damper, k, a, p = damper_of(system), numbers["stiffness"], numbers["damping"], numbers["exponent"]

    def rates(time: float, whole: Array) -> Array:
        both = whole.reshape(2 * n, -1) / units[:, None]
        place, speed, out = both[:n], both[n:], np.empty((2 * n, whole.size // (2 * n)))
        deep, rate = max(float(contact @ place[:, 0]) - gap, 0.0), float(contact @ speed[:, 0])
        pushes = 1 + a * rate > 0
        by_depth = p * k * deep ** (p - 1) * (1 + a * rate) if pushes and deep > 0 else 0.0
        by_rate = a * k * deep**p if pushes else 0.0
        force = by_depth * (contact @ place) + by_rate * (contact @ speed)
        force[0] = k * deep**p * max(1 + a * rate, 0.0)
        out[:n], out[n:] = speed, -damper @ speed - system.omega[:, None] ** 2 * place - np.outer(contact, force)
        base = drive.omega**2 * drive.amplitude * np.sin(drive.omega * time)
        out[n:, 0] += system.load * base + system.static
        return np.asarray(out * units[:, None]).ravel()

    found, state = [], units * pose.ravel()
    for begin in at + duration / parts * np.arange(parts):
        start = np.column_stack([state, np.eye(2 * n)])
        size = TOLERANCE * np.concatenate([np.full((2 * n, 1), np.linalg.norm(state)), np.ones((2 * n, 2 * n))], axis=1)
        span = (begin, begin + duration / parts)
        end = solve_ivp(rates, span, start.ravel(), "DOP853", rtol=TOLERANCE, atol=size.ravel()).y[:, -1]
        state, matrix = np.split(end.reshape(2 * n, -1), [1], axis=1)
        state = state[:, 0]
        found.append(matrix * (units / units[:, None]))
    return found
