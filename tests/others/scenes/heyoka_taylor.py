"""heyoka: Taylor series compiled for the system; impacts are terminal events whose callback strikes and goes on.

A second integrator, with the contact's acceleration taken out, carries the motion while a contact rests.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import heyoka as hy
import numpy as np

from tests.others.scenes.told import RESTING, Answer, Array, Peer, Told

MOST = 20_000  # impacts
SETTING = (
    "`taylor_adaptive` at its default tolerance (double precision), compact mode from 9 modes on; a terminal event for "
    "each gap that closes, its callback strikes, cooldown as heyoka finds it"
)


class Model:
    """A scene in heyoka's expressions."""

    def __init__(self, told: Told) -> None:
        n = told.size
        names = [f"q{i}" for i in range(n)] + [f"v{i}" for i in range(n)]
        self.told, self.state = told, hy.make_vars(*names)
        self.q, self.v = self.state[:n], self.state[n:]
        wave = hy.sin(told.drive * hy.time)
        self.free = [
            told.force[i] * wave + told.static[i] - 2 * told.zeta[i] * told.omega[i] * self.v[i]
            - told.omega[i] ** 2 * self.q[i] for i in range(n)
        ]  # fmt: skip

    def on(self, row: Array, values: list[Any]) -> Any:
        """A row times expressions."""
        return hy.sum([float(c) * value for c, value in zip(row, values, strict=True)])

    def integrator(self, accelerations: list[Any], events: list[Any]) -> Any:
        """Compiled, at rest at zero."""
        rates = list(zip(self.state, [*self.v, *accelerations], strict=True))
        compact = self.told.size > 8
        return hy.taylor_adaptive(rates, np.zeros(2 * self.told.size), t_events=events, compact_mode=compact)

    def flight(self) -> Any:
        """Free of stops, up to an impact after which a contact rests."""
        up = hy.event_direction.positive
        events = [
            hy.t_event(self.on(stop.row, self.q) - stop.gap, callback=Strike(self.told, k), direction=up)
            for k, stop in enumerate(self.told.stops)
        ]
        return self.integrator(self.free, events)

    def held(self, number: int) -> Any:
        """Held on a stop, up to its release."""
        row = self.told.stops[number].row
        press = self.on(row, self.free)
        rates = [free - float(c / (row @ row)) * press for c, free in zip(row, self.free, strict=True)]
        constant = not (self.told.amplitude or self.told.omega.any())  # no event, as heyoka has it
        return self.integrator(rates, [] if constant else [hy.t_event(press, direction=hy.event_direction.negative)])


class Strike:
    """Callback of an impact."""

    def __init__(self, told: Told, number: int) -> None:
        self.told, self.number, self.stop = told, number, told.stops[number]
        self.slow, self.kick, self.size = RESTING * told.speed, told.stops[number].kick, told.size
        self.stiffness, self.damping = told.omega**2, 2 * told.zeta * told.omega
        self.impacts: list[tuple[float, float]] = []
        self.rests = False

    def __call__(self, integrator: Any, sign: int) -> bool:
        n, row, state = self.size, self.stop.row, integrator.state
        speed = float(row @ state[n:])
        self.impacts.append((integrator.time, speed))
        state[n:] += self.kick * speed
        self.rests = self.stop.restitution * speed < self.slow and self.press(integrator.time, state) > 0
        if self.rests:
            state[:n] -= row * ((row @ state[:n] - self.stop.gap) / (row @ row))
            state[n:] -= row * ((row @ state[n:]) / (row @ row))
        return not self.rests and len(self.impacts) < MOST

    def press(self, t: float, state: Array) -> float:
        """Acceleration into the stop."""
        n, told = self.size, self.told
        wave = np.sin(told.drive * t)
        return float(
            self.stop.row @ (told.force * wave + told.static - self.damping * state[n:] - self.stiffness * state[:n])
        )


def prepare(told: Told) -> Callable[[], Answer]:
    """Integrators for the flight and for rest on each stop."""
    model = Model(told)
    flight = model.flight()
    strikes = [event.callback for event in flight.t_events]  # the integrator's own copies
    resting = {k: model.held(k) for k in range(len(told.stops)) if told.held == k or told.stops[k].restitution < 1}
    n, row = told.size, told.stops[0].row

    def run() -> Answer:
        held, state, t = told.held, told.start, told.begin
        for strike in strikes:
            strike.impacts, strike.rests = [], False
        complaint = ""
        while t < told.end and not complaint:
            mover = flight if held is None else resting[held]
            mover.time, mover.state[:] = t, state
            if mover.with_events:
                mover.reset_cooldowns()
            outcome = mover.propagate_until(told.end)[0]
            t, state = mover.time, mover.state.copy()
            if outcome == hy.taylor_outcome.err_nf_state:
                complaint = "gives up"
            elif len(strikes[0].impacts) >= MOST:
                complaint = "hangs"
            held = next((k for k, strike in enumerate(strikes) if strike.rests), None) if held is None else None
            for strike in strikes:
                strike.rests = False
        impacts = np.array(sorted(hit for strike in strikes for hit in strike.impacts)).reshape(-1, 2)
        return Answer(impacts, np.array([row @ state[:n]]), state.reshape(2, n), complaint)

    return run


PEERS = [Peer("heyoka", "heyoka", SETTING, prepare)]
