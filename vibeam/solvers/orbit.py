"""Orbit solver: steady motions with one impact per n drive periods in closed form, frequency by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from vibeam.flight.equilibrium import equilibrium
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.between_impacts import phasors
from vibeam.periodic.closed_orbits import closed_orbits
from vibeam.periodic.modal_sums import checked, offsets, resonant
from vibeam.periodic.orbit import Orbit
from vibeam.solvers.steady import SteadySolver
from vibeam.system.curves import MotionCurves
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import VELOCITIES_KEPT, Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array


class OrbitSolver(SteadySolver):
    """Stable, admissible motions with one impact per ``periods`` drive periods; where there is none but the motion
    under the drive alone stays clear of the stop, that one. Every other point is NaN with its reason.

    Points are independent: the carried state, ``settle`` and ``hold`` do not change the result.
    """

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, periods: int = 1) -> None:
        checked(system, slowest, periods)
        self.system, self.periods, self.flight = system, int(periods), FlightSolver(system, slowest)

    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: State, settle: int, hold: int, output: str
    ) -> State:
        """As ``SteadySolver.point``: the state at the drive's phase 0."""
        found, last = self._point(drive, hold, output)
        copy_point(found, response, index)
        return last

    def curves(self, omegas: Sequence[float] | Array, amplitude: float | Array, output: str) -> MotionCurves:
        """Both motions at ``omegas``, rad/s: the roots of the quadratic, certified one by one.

        ``amplitude``: of the base, m, one for all or one each.
        """
        grid = np.asarray(omegas, dtype=float)
        base = np.broadcast_to(amplitude, grid.shape)
        self.system.derivative(output)
        found = MotionCurves.empty(grid / (2 * np.pi), self.periods)
        for index, omega in enumerate(grid):
            for branch, orbit in enumerate(self._orbits(Drive(float(omega), float(base[index])))):
                at = index, branch
                found.velocity[at], found.reach[at] = orbit.velocity, orbit.reach
                found.stable[at], found.admissible[at] = orbit.stable, orbit.admissible
                if orbit.admissible:
                    found.amplitude[at] = orbit.amplitude(output)
        return found

    def _point(self, drive: Drive, hold: int, output: str) -> tuple[FrequencyResponse, State]:
        orbit = self._orbit(drive)
        if orbit is not None:
            window, last = orbit.window(output)
            return _with_one_impact(window, orbit, hold), last
        linear = self._linear(drive)
        if linear is not None:
            return self.flight.steady([drive.omega], drive.amplitude, linear, 0, 1, output)
        blank = FrequencyResponse.empty(np.array([drive.omega / (2 * np.pi)]), self.system.size)
        return replace(blank, ended=np.array([Ended.NO_ORBIT.code])), equilibrium(self.system)

    def _orbit(self, drive: Drive) -> Orbit | None:
        """Stable admissible motion, with the harder impact where there are two."""
        return next((orbit for orbit in self._orbits(drive) if orbit.stable and orbit.admissible), None)

    def _orbits(self, drive: Drive) -> tuple[Orbit, ...]:
        """All motions, harder impact first; none at the resonance of an undamped mode."""
        if resonant(self.system, drive.omega, self.periods):
            return ()
        return closed_orbits(self.system, drive, self.periods, self.flight)

    def _linear(self, drive: Drive) -> State | None:
        """Motion under the drive alone at its phase 0, where it exists and never reaches the stop."""
        h, rest = phasors(self.system, drive), offsets(self.system)
        loose = np.any((self.system.omega == 0) & (self.system.static != 0))
        high = float(abs(self.system.contact @ h) + self.system.contact @ rest)
        if loose or not np.all(np.isfinite(h)) or not high < self.system.gap:
            return None
        return State(h.imag + rest, drive.omega * h.real)


def _with_one_impact(window: FrequencyResponse, orbit: Orbit, hold: int) -> FrequencyResponse:
    """Window over one span with the impact counted exactly once, wherever in the drive's period it falls."""
    count = min(VELOCITIES_KEPT, max(1, hold // orbit.periods))
    velocities = np.full((1, VELOCITIES_KEPT), np.nan)
    velocities[0, VELOCITIES_KEPT - count :] = orbit.velocity
    return replace(
        window,
        impacts_per_period=np.array([1 / orbit.periods]),
        impact_velocity=np.array([orbit.velocity]),
        impact_velocities=velocities,
        period=np.array([orbit.periods]),
        rest=np.zeros(1),
    )


def copy_point(point: FrequencyResponse, response: FrequencyResponse, index: int) -> None:
    """Write a point of length 1 into a response."""
    for each in fields(FrequencyResponse):
        if each.name != "frequency":
            getattr(response, each.name)[index] = getattr(point, each.name)[0]
