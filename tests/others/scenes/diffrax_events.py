"""diffrax: a flight is one ``diffeqsolve`` ended by an event; flights and rests in turn, in one compiled loop."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import diffrax as dx
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx

from tests.others.scenes.restarts import longest_step
from tests.others.scenes.told import RESTING, Answer, Peer, Told

jax.config.update("jax_enable_x64", True)
RTOL, ROOT, MOST = 1e-10, 1e-12, 4000  # MOST: flights and rests
SETTING = (
    "`diffeqsolve`, Dopri8, PID control with rtol 1e-10, atol 1e-12 of the scales, no step over 1/50 of the drive's "
    "period or 1/100 of the motion; an event for each gap that closes, its root by optimistix' Newton to 1e-12; all "
    "flights in one compiled loop"
)


def prepare(told: Told) -> Callable[[], Answer]:
    """The loop, compiled."""
    begin, start = jnp.asarray(told.begin), jnp.asarray(told.start)
    compiled = jax.jit(loop(told)).lower(begin, start).compile()

    def run() -> Answer:
        t, y, _, _, times, speeds = (np.asarray(each) for each in compiled(begin, start))
        struck = np.isfinite(times)
        impacts = np.stack([times[struck], speeds[struck]], axis=1)
        y = y.reshape(2, told.size)
        return Answer(impacts, np.array([told.stops[0].row @ y[0]]), y, "" if t >= told.end else "hangs")

    return run


def loop(told: Told) -> Callable[..., Any]:
    """The motion from (t, y): time, y, stop on which it rests or −1, rounds, times and velocities of impacts."""
    n, slow = told.size, RESTING * told.speed
    rows, gaps = jnp.asarray([stop.row for stop in told.stops]), jnp.asarray([stop.gap for stop in told.stops])
    kicks = jnp.asarray([stop.kick for stop in told.stops])
    back = jnp.asarray([stop.restitution for stop in told.stops])
    norms = jnp.sum(rows**2, axis=1)
    stiffness, damping = jnp.asarray(told.omega**2), jnp.asarray(2 * told.zeta * told.omega)
    force, static = jnp.asarray(told.force), jnp.asarray(told.static)

    def free(t: Any, y: Any) -> Any:
        return force * jnp.sin(told.drive * t) + static - damping * y[n:] - stiffness * y[:n]

    def rate(t: Any, y: Any, held: Any) -> Any:
        pull, row = free(t, y), rows[held]
        pull = jnp.where(held < 0, pull, pull - row * ((row @ pull) / norms[held]))
        return jnp.concatenate([y[n:], pull])

    def closes(number: int) -> Callable[..., Any]:
        def beyond(t: Any, y: Any, args: Any, **_: Any) -> Any:
            press = -(rows[args] @ free(t, y))
            return jnp.where(args < 0, rows[number] @ y[:n] - gaps[number], press if number == 0 else -1.0)

        return beyond

    event = dx.Event([closes(k) for k in range(len(told.stops))], optx.Newton(ROOT, ROOT), direction=True)
    control = dx.PIDController(
        rtol=RTOL, atol=jnp.asarray(told.tolerances(RTOL)), dtmax=longest_step(told), pcoeff=0.2, icoeff=0.4
    )

    def fly(carry: Any) -> Any:
        t, y, held, soon, count, times, speeds = carry
        done = dx.diffeqsolve(
            dx.ODETerm(rate), dx.Dopri8(), t, told.end, soon, y, args=held, stepsize_controller=control, event=event,
            max_steps=None, throw=False, adjoint=dx.ForwardMode(),
        )  # fmt: skip
        t, y = done.ts[-1], done.ys[-1]
        met = jnp.stack(done.event_mask)
        k, struck = jnp.argmax(met), jnp.any(met) & (held < 0)
        row, speed, press = rows[k], rows[k] @ y[n:], rows[k] @ free(t, y)
        times = times.at[count].set(jnp.where(struck, t, jnp.nan))
        speeds = speeds.at[count].set(speed)
        x = y[:n] - jnp.where(struck, (row @ y[:n] - gaps[k]) / norms[k], 0.0) * row
        v = y[n:] + jnp.where(struck, speed, 0.0) * kicks[k]
        rests = struck & (back[k] * speed < slow) & (press > 0)
        v = v - jnp.where(rests, (row @ v) / norms[k], 0.0) * row
        flight = jnp.where(struck & ~rests & (press > 0), 2 * back[k] * speed / press, told.end - told.begin)
        first = jnp.clip(flight / 10, 1e-300, longest_step(told))
        return t, jnp.concatenate([x, v]), jnp.where(rests, k, -1), first, count + 1, times, speeds

    def whole(t: Any, y: Any) -> Any:
        held = jnp.asarray(-1 if told.held is None else told.held)
        blank = jnp.full(MOST, jnp.nan)
        carry = t, y, held, jnp.asarray(longest_step(told)), jnp.asarray(0), blank, blank
        t, y, held, _, count, times, speeds = jax.lax.while_loop(
            lambda carry: (carry[0] < told.end) & (carry[4] < MOST), fly, carry
        )
        return t, y, held, count, times, speeds

    return whole


PEERS = [Peer("diffrax", "diffrax", SETTING, prepare)]
