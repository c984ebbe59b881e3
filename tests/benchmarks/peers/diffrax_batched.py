"""diffrax: all drive frequencies at once, compiled; flights one after the other in a scan, each ended by an event."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import diffrax as dx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx

from peers.job import Answer, Entry, Impacts, Job, timed

jax.config.update("jax_enable_x64", True)
SPARE = 1.06  # flights allowed for, over one a period


def prepare(job: Job, solver: Any, rtol: float, refine: float) -> Callable[[], Answer]:
    """``refine``: tolerance of the event's root."""
    n, c = job.size, jnp.asarray(job.contact)
    stiffness, damping = jnp.asarray(job.omega**2), jnp.asarray(2 * job.zeta * job.omega)
    push = jnp.asarray(job.load * job.amplitude)
    longest = int(job.periods * SPARE) + 8

    def rate(t: Any, y: Any, omega: Any) -> Any:
        force = push * (omega**2 * jnp.sin(omega * t))
        return jnp.concatenate([y[n:], force - damping * y[n:] - stiffness * y[:n]])

    def excess(t: Any, y: Any, args: Any, **_: Any) -> Any:
        return c @ y[:n] - job.gap

    event = dx.Event(excess, optx.Newton(refine, refine), direction=True)
    control = dx.PIDController(rtol=rtol, atol=1e-2 * rtol)

    def flight(carry: Any, _: Any, omega: Any, end: Any) -> Any:
        t, y = carry
        found = dx.diffeqsolve(
            dx.ODETerm(rate), solver, t, end, None, y, args=omega, stepsize_controller=control, event=event,
            max_steps=None, throw=False, adjoint=dx.ForwardMode(),
        )  # fmt: skip
        t, y = found.ts[-1], found.ys[-1]
        struck, speed = found.result == dx.RESULTS.event_occurred, c @ y[n:]
        beyond = jnp.where(struck, c @ y[:n] - job.gap, 0.0)
        kick = jnp.where(struck, (1 + job.restitution) * speed, 0.0)
        y = jnp.concatenate([y[:n] - c * beyond, y[n:] - c * kick])
        return (t, y), (jnp.where(struck, t, jnp.nan), speed)

    def point(omega: Any, start: Any) -> Any:
        end = job.periods * 2 * jnp.pi / omega
        return jax.lax.scan(partial(flight, omega=omega, end=end), (0.0, start), None, length=longest)[1]

    batched = jax.jit(jax.vmap(point))
    grid, starts = jnp.asarray(job.grid), jnp.asarray(job.starts.reshape(len(job.grid), -1))
    compiled = batched.lower(grid, starts).compile()

    def work() -> list[Impacts]:
        times, speeds = (np.asarray(x) for x in compiled(grid, starts))
        struck = np.isfinite(times)
        return [Impacts(t[s], v[s]) for t, v, s in zip(times, speeds, struck, strict=True)]

    return timed(work)


def entry(setting: str, solver: Any, rtol: float, refine: float, **limits: int) -> Entry:
    setup = partial(prepare, solver=solver, rtol=rtol, refine=refine)
    return Entry("diffrax", setting, setup, "diffrax", wide=True, **limits)


ENTRIES = [
    entry("Tsit5 1e-4, batch", dx.Tsit5(), 1e-4, 1e-6),
    entry("Dopri8 1e-10, batch", dx.Dopri8(), 1e-10, 1e-12),
    entry("Kvaerno5 1e-5, batch", dx.Kvaerno5(), 1e-5, 1e-7, fewest_modes=4),
]
