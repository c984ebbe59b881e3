"""Contact motions by scipy's DOP853, phase by phase with events: slow, plain, and nothing shared with the engine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from bounded import Bound
from scipy.integrate import solve_ivp

import vibeam
from vibeam_models.laws.compliant import LinearStop


@dataclass
class Found:
    times: np.ndarray
    velocities: np.ndarray
    durations: np.ndarray
    last: np.ndarray  # (2, n)


def matrices(system: vibeam.ImpactSystem) -> tuple[np.ndarray, np.ndarray]:
    damper = np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling
    return np.diag(system.omega**2), damper


def height(row, gap, n, direction):
    """The event of crossing a stop."""

    def event(t, y):
        return row @ y[:n] - gap

    event.terminal, event.direction = True, direction
    return event


def integrated(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, state: vibeam.State, t_end: float, rtol: float = 1e-12
) -> Found:
    """Impacts (begins of contact) up to ``t_end``; no chatter and no rest on a hard stop."""
    spring, damper = matrices(system)
    n, law = system.size, system.law
    stops = [(system.contact, system.gap)]
    stops += [] if system.second_gap is None else [(-system.contact, system.second_gap)]
    compliant = hasattr(law, "stiffness")

    def push(y, row, gap):
        depth, speed = row @ y[:n] - gap, row @ y[n:]
        if isinstance(law, LinearStop):
            return law.stiffness * depth + law.damping * speed
        return law.stiffness * max(depth, 0.0) ** law.exponent * (1 + law.damping * speed)

    def rate(t, y, touched):
        force = system.load * drive.omega**2 * drive.amplitude * np.sin(drive.omega * t) + system.static
        force = force - damper @ y[n:] - spring @ y[:n]
        if touched is not None:
            force = force - touched[0] * max(push(y, *touched), 0.0)
        return np.concatenate([y[n:], force])

    t, y, times, velocities, durations = 0.0, np.concatenate([state.displacement, state.velocity]), [], [], []
    size = np.array([np.max(np.abs(state.displacement)) + 1e-6] * n + [np.max(np.abs(state.velocity)) + 1e-3] * n)
    touched = None
    within = Bound()
    while within(t < t_end):
        direction = 1.0 if touched is None else -1.0
        events = [height(*stop, n, direction) for stop in (stops if touched is None else [touched])]
        if touched is not None and isinstance(law, LinearStop) and law.damping > 0:

            def force(t, y, stop=touched):
                return push(y, *stop)

            force.terminal, force.direction = True, -1.0
            events.append(force)
        longest = (t_end - t) / 50 if touched is None else np.inf
        found = solve_ivp(
            lambda t, y, stop=touched: rate(t, y, stop), (t, t_end), y, method="DOP853", rtol=rtol,
            atol=rtol * size * 1e-2, events=events, max_step=longest,
        )  # fmt: skip
        t, y = found.t[-1], found.y[:, -1]
        if found.status != 1:
            break
        if touched is not None:
            durations.append(t - times[-1])
            touched = None
            continue
        which = next(i for i, hits in enumerate(found.t_events) if len(hits))
        row = stops[which][0]
        speed = row @ y[n:]
        times.append(t)
        velocities.append(speed)
        if compliant:
            touched = stops[which]
        else:
            restitution = system.restitution if law is None else law.at(speed)
            y = np.concatenate([y[:n], y[n:] - row * (1 + restitution) * speed / (row @ row)])
    return Found(np.array(times), np.array(velocities), np.array(durations), y.reshape(2, n))
