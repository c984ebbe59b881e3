"""heyoka: Taylor series compiled for the system, impacts as terminal events whose callback strikes and goes on.

The batch integrator runs as many drive frequencies at once as the processor's vectors hold numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import heyoka as hy
import numpy as np

from peers.job import Answer, Array, Entry, Impacts, Job, timed


def equations(job: Job) -> tuple[list[Any], Any]:
    """The system in heyoka's expressions, the drive frequency as its parameter; and how far it is beyond the stop."""
    n = job.size
    names = [f"q{i}" for i in range(n)] + [f"v{i}" for i in range(n)]
    state = hy.make_vars(*names)
    q, v = state[:n], state[n:]
    drive = hy.par[0] ** 2 * job.amplitude * hy.sin(hy.par[0] * hy.time)
    rates = list(v) + [
        job.load[i] * drive - 2 * job.zeta[i] * job.omega[i] * v[i] - job.omega[i] ** 2 * q[i] for i in range(n)
    ]
    return list(zip(state, rates, strict=True)), hy.sum([job.contact[i] * q[i] for i in range(n)]) - job.gap


class Strike:
    """What happens at an impact, of one integrator."""

    def __init__(self, job: Job) -> None:
        self.contact, self.kick, self.size = job.contact, job.contact * (1 + job.restitution), job.size
        self.state: Array = np.zeros(0)
        self.times: list[float] = []
        self.speeds: list[float] = []

    def __call__(self, integrator: Any, sign: int) -> bool:
        v = self.state[self.size :]
        speed = float(self.contact @ v)
        self.times.append(integrator.time)
        self.speeds.append(speed)
        v -= self.kick * speed
        return True


class StrikeOne(Strike):
    """The same for one mode, without arrays."""

    def __call__(self, integrator: Any, sign: int) -> bool:
        speed = self.state[1]
        self.times.append(integrator.time)
        self.speeds.append(speed)
        self.state[1] = speed - self.kick[0] * speed
        return True


def prepare(job: Job, tol: float | None) -> Callable[[], Answer]:
    """One point after the other; ``tol`` None is the default, double precision."""
    system, excess = equations(job)
    strike = (StrikeOne if job.size == 1 else Strike)(job)
    event = hy.t_event(excess, callback=strike, direction=hy.event_direction.positive)
    options: dict[str, Any] = {} if tol is None else {"tol": tol}
    integrator = hy.taylor_adaptive(
        system, np.zeros(2 * job.size), pars=[1.0], t_events=[event], compact_mode=job.size > 8, **options
    )
    strike = integrator.t_events[0].callback  # the integrator's own copy
    strike.state = integrator.state

    def work() -> list[Impacts]:
        found = []
        for omega, start in zip(job.grid, job.starts, strict=True):
            integrator.time, integrator.pars[0], strike.state[:] = 0.0, omega, start.ravel()
            integrator.reset_cooldowns()
            strike.times, strike.speeds = [], []
            integrator.propagate_until(job.end(float(omega)))
            found.append(Impacts(np.array(strike.times), np.array(strike.speeds)))
        return found

    return timed(work)


class StrikeLane:
    """What happens at an impact of one lane of a batch."""

    def __init__(self, job: Job, lanes: int) -> None:
        self.contact, self.kick, self.size = job.contact, job.contact * (1 + job.restitution), job.size
        self.state: Array = np.zeros((0, 0))
        self.clear(lanes)

    def clear(self, lanes: int) -> None:
        """Forget the impacts."""
        self.times: list[list[float]] = [[] for _ in range(lanes)]
        self.speeds: list[list[float]] = [[] for _ in range(lanes)]

    def __call__(self, integrator: Any, sign: int, lane: int) -> bool:
        v = self.state[self.size :, lane]
        speed = float(self.contact @ v)
        self.times[lane].append(float(integrator.time[lane]))
        self.speeds[lane].append(speed)
        v -= self.kick * speed
        return True


class StrikeOneLane(StrikeLane):
    """The same for one mode, without arrays."""

    def __call__(self, integrator: Any, sign: int, lane: int) -> bool:
        speed = self.state[1, lane]
        self.times[lane].append(integrator.time[lane])
        self.speeds[lane].append(speed)
        self.state[1, lane] = speed - self.kick[0] * speed
        return True


def prepare_batch(job: Job) -> Callable[[], Answer]:
    """As many points at once as vectors hold numbers; the last batch is filled up with its last point."""
    lanes = hy.recommended_simd_size()
    system, excess = equations(job)
    strike = (StrikeOneLane if job.size == 1 else StrikeLane)(job, lanes)
    event = hy.t_event_batch(excess, callback=strike, direction=hy.event_direction.positive)
    integrator = hy.taylor_adaptive_batch(
        system, np.zeros((2 * job.size, lanes)), pars=np.ones((1, lanes)), t_events=[event], compact_mode=job.size > 8
    )
    strike = integrator.t_events[0].callback
    strike.state = integrator.state

    def work() -> list[Impacts]:
        found: list[Impacts] = []
        for first in range(0, len(job.grid), lanes):
            which = np.minimum(np.arange(first, first + lanes), len(job.grid) - 1)
            integrator.set_time(0.0)
            integrator.pars[0] = job.grid[which]
            strike.state[:] = job.starts[which].reshape(lanes, -1).T
            integrator.reset_cooldowns()
            strike.clear(lanes)
            integrator.propagate_until(job.periods * 2 * np.pi / job.grid[which])
            found += [Impacts(np.array(t), np.array(v)) for t, v in zip(strike.times, strike.speeds, strict=True)]
        return found[: len(job.grid)]

    return timed(work)


ENTRIES = [
    Entry("heyoka", "1e-4", partial(prepare, tol=1e-4), "heyoka"),
    Entry("heyoka", "1e-9", partial(prepare, tol=1e-9), "heyoka"),
    Entry("heyoka", "double precision", partial(prepare, tol=None), "heyoka"),
    Entry("heyoka", "double precision, batch", prepare_batch, "heyoka", wide=True),
]
