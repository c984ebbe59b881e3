"""Certified admissibility: the flight solver, which isolates every root, must find the next impact one span later."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.states import carried, phasors
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array

CLOSE = 1e-9  # share of the motion's size by which the contact may miss the gap at the end of the span


class AdmissibilityCheck:
    """Flight solver for admissibility checks of one system's motions, at drives of ``slowest`` rad/s and more."""

    def __init__(self, system: ImpactSystem, slowest: float) -> None:
        self.system, self.flight = system, FlightSolver(system, slowest)

    def admits(self, drive: Drive, start: State, time: float, periods: int, velocity: float) -> bool:
        """Test whether the flight from ``start``, just after an impact at ``time``, strikes next one span later."""
        span = 2 * np.pi * periods / drive.omega
        slack = self.slack(drive, velocity, span)
        times, _ = self.strikes(drive, start, time, time + span + slack, 3, CLOSE * velocity)
        return bool(len(times) and times[0] - time >= span - slack)

    def strikes(
        self, drive: Drive, start: State | None, begin: float, end: float, limit: int, least: float = 0.0
    ) -> tuple[Array, Array]:
        """Times (m,), s, and velocities of the impacts harder than ``least``; empty where the motion comes to rest."""
        trace = self.flight.simulate(drive, start, begin, end, limit)[3].trace
        if ((trace[:, layout.WHAT] == layout.RESTING) & (trace[:, layout.DURATION] > 0)).any():
            return np.zeros(0), np.zeros(0)
        last = trace[:, layout.END]
        hit = trace[
            ((last == layout.IMPACT) | (last == layout.CHATTER) | (last == layout.STUCK))
            & (trace[:, layout.BEFORE] > least)
        ]
        return hit[:, layout.START] + hit[:, layout.DURATION], hit[:, layout.BEFORE]

    def slack(self, drive: Drive, velocity: float, span: float) -> float:
        """Bound on the shift of an impact at ``velocity`` by round-off, s, with a wide margin."""
        size = float(np.abs(self.system.contact) @ np.abs(phasors(self.system, drive))) + abs(self.system.gap)
        return min(CLOSE * (size / velocity + span), span / 4)

    def watched(
        self, drive: Drive, start: State, time: float, periods: int, output: str
    ) -> tuple[FrequencyResponse, State]:
        """Measured window over ``periods`` periods from the drive's next phase 0 on, by flight; the state there."""
        period = 2 * np.pi / drive.omega
        next_ = period * np.ceil(time / period) if time > 0 else 0.0
        displacement, velocity = carried(self.system, drive, start, time, np.array([next_]))
        state = State(displacement[0], velocity[0])
        return self.flight.steady([drive.omega], drive.amplitude, state, 0, periods, output)
