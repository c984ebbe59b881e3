"""Periodic motions with one impact per n drive periods at one drive, in closed form and certified.

The flight solver, which isolates every root, certifies that nothing is struck between the impacts.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.readout import rests, struck
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.between_impacts import phasors, state_after
from vibeam.periodic.modal_sums import Roots, Sums, balance, checked, resonant, sums
from vibeam.periodic.multipliers import multipliers
from vibeam.periodic.orbit import Orbit
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

CLOSE = 1e-9  # share of the motion's size by which the contact may miss the gap at the end of the span


def admits(flight: FlightSolver, drive: Drive, start: State, time: float, periods: int, velocity: float) -> bool:
    """Test whether the flight from ``start``, just after an impact at ``time``, strikes next one span later."""
    span = 2 * np.pi * periods / drive.omega
    slack = _slack(flight.system, drive, velocity, span)
    trace = flight.simulate(drive, start, time, time + span + slack, 3)[3].trace
    hit = trace[struck(trace) & (trace[:, layout.BEFORE] > CLOSE * velocity)]
    sound = len(hit) and not rests(trace).any()
    return bool(sound and hit[0, layout.START] + hit[0, layout.DURATION] - time >= span - slack)


def _slack(system: ImpactSystem, drive: Drive, velocity: float, span: float) -> float:
    """Bound on the shift of an impact at ``velocity`` by round-off, s, with a wide margin."""
    size = float(np.abs(system.contact) @ np.abs(phasors(system, drive))) + abs(system.gap)
    return min(CLOSE * (size / velocity + span), span / 4)


def closed_orbits(
    system: ImpactSystem, drive: Drive, periods: int = 1, flight: FlightSolver | None = None
) -> tuple[Orbit, ...]:
    """Find all motions with one impact per ``periods`` drive periods, harder impact first: none, one or two.

    Exact for any number of modes of any damping, with static forces; not admissible ones are among them. ``flight``:
    a solver for the certificate, to be reused for many drives. Empty where the impact equations have no real
    root that pushes away from the stop (also without a drive). ValueError for an undamped mode at a resonance (driven
    at its own frequency, or a whole number of its turns in the span, so that impacts make it grow), and for modes
    without stiffness that no static force brings back to the stop.
    """
    omega = checked(system, drive.omega, periods)
    reason = resonant(system, drive.omega, periods)
    if reason:
        raise ValueError(reason)
    if drive.amplitude == 0:
        return ()
    total = sums(system, omega, periods)
    found = balance(system, total, drive.amplitude, system.gap)
    own = FlightSolver(system, drive.omega) if flight is None else flight
    return tuple(
        _orbit(own, drive, int(periods), total, found, k)
        for k in (0, 1)
        if found.impulse[0, k] < 0 and np.isfinite(found.phase[0, k])
    )


def _orbit(flight: FlightSolver, drive: Drive, periods: int, total: Sums, found: Roots, k: int) -> Orbit:
    phase, impulse, velocity = (float(row[0, k]) for row in (found.phase, found.impulse, found.velocity))
    system, time = flight.system, phase / drive.omega
    state = state_after(system, drive, periods, phase, impulse)
    values = multipliers(system, total.span, found.relative_acceleration[:, k])[0]
    admissible = admits(flight, drive, state, time, periods, velocity)
    return Orbit(
        system, drive, periods, time, state, np.array([time]), np.array([velocity]), np.zeros(1, dtype=np.int64), 0,
        bool(abs(values[0]) < 1), admissible, 0.0, (), np.zeros((0, 0)), partial(np.array, values), flight,
    )  # fmt: skip
