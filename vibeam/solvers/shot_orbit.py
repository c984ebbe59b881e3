"""Orbit solver of systems without closed forms: steady motions by shooting, frequency by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from vibeam.flight.solver import exact_solver
from vibeam.periodic.motion_at import shot
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import every
from vibeam.periodic.shooting import NoOrbit
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.solvers.orbit import copy_point
from vibeam.solvers.steady import SteadySolver
from vibeam.system.curves import BRANCHES, MotionCurves
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arguments import count, refuse
from vibeam_models.arrays import Array


class ShotOrbitSolver(SteadySolver):
    """Stable motions that repeat after ``periods`` drive periods, or one without contact; NaN where none is found.

    From point to point the motion is followed by shooting from the last one's state; where that leads to no stable
    motion, the hardest stable one of all that are found. ``settle`` and ``hold`` do not change the result.
    """

    def __init__(self, system: ImpactSystem, slowest: float, span: float = 0.0, periods: int = 1) -> None:
        faults: list[str] = []
        self.periods = count("periods", periods, faults, least=1)
        refuse("solver", faults)
        self.system, self.runner = system, exact_solver(system, slowest, span)

    def point(
        self, response: FrequencyResponse, index: int, drive: Drive, carried: State, settle: int, hold: int, output: str
    ) -> State:
        """As ``SteadySolver.point``: the state at the drive's phase 0."""
        orbit = self._orbit(StroboscopicMap(self.system, drive, runner=self.runner), carried)
        if orbit is None:
            blank = FrequencyResponse.empty(np.array([drive.omega / (2 * np.pi)]), self.system.size)
            copy_point(replace(blank, ended=np.array([Ended.NO_ORBIT.code])), response, index)
            return carried
        window, last = orbit.window(output)
        touched = len(orbit.times) > 0 or orbit.rests > 0
        copy_point(replace(window, period=np.array([orbit.periods if touched else -1])), response, index)
        return last

    def curves(self, omegas: Sequence[float] | Array, amplitude: float | Array, output: str) -> MotionCurves:
        """Motions with contact at ``omegas``, rad/s: those followed from the point before, else all that are found.

        ``amplitude``: of the base, m, one for all or one each.
        """
        grid = np.asarray(omegas, dtype=float)
        found, last = MotionCurves.empty(grid / (2 * np.pi), self.periods), list[Orbit]()
        for index, (omega, base) in enumerate(zip(grid, np.broadcast_to(amplitude, grid.shape), strict=True)):
            section = StroboscopicMap(self.system, Drive(float(omega), float(base)), runner=self.runner)
            last = self._followed(section, last) or [each for each in every(section, self.periods) if len(each.times)]
            for branch, orbit in enumerate(sorted(last, key=lambda each: -each.velocity)[:BRANCHES]):
                at = index, branch
                found.velocity[at], found.reach[at], found.amplitude[at] = (
                    orbit.velocity, orbit.reach, orbit.amplitude(output),
                )  # fmt: skip
                found.stable[at], found.admissible[at] = orbit.stable, True
        return found

    def _orbit(self, section: StroboscopicMap, carried: State) -> Orbit | None:
        with suppress(NoOrbit):
            found = shot(section, carried, self.periods)
            if found.stable:
                return found
        searched = [each for periods in dict.fromkeys((self.periods, 1)) for each in every(section, periods)]
        return next((each for each in searched if each.stable and self._meant(each)), None)

    def _meant(self, orbit: Orbit) -> bool:
        """Test whether a motion repeats as asked, or is one without contact."""
        return orbit.periods == self.periods or not len(orbit.times)

    def _followed(self, section: StroboscopicMap, last: list[Orbit]) -> list[Orbit]:
        """Motions near those of the last point; none where one of them is lost."""
        try:
            found = [shot(section, orbit, self.periods) for orbit in last]
        except NoOrbit:
            return []
        apart = {round(orbit.velocity / found[0].velocity, 6) for orbit in found}
        return found if len(apart) == len(found) else []
