"""Mapping solver: stable fixed points of the impact map, as in the paper's pointwise mapping (eq. 28–37).

Orbits follow in closed form, their stability from trace and determinant; the map is not iterated, for that is the
work of the flight solver. So all motions with one impact every n periods are found, and none with more impacts,
chatter or chaos: such a point is NaN.
"""

from __future__ import annotations

import numpy as np

from vibeam.solvers.mapping.impact_map import ImpactMap, Orbit, flight_solver
from vibeam.solvers.mapping.stability import Form, admissible_orbits, check_form, orbit_invariants
from vibeam.solvers.one_mode.oscillator import Oscillator
from vibeam.solvers.one_mode.stationary import Motion, StationarySolver
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arguments import count, refuse

HIGHEST = 16  # longest period in a response


class MappingSolver(StationarySolver):
    """Stable motions of one mode with one impact every n = 1 … ``periods`` drive periods, exact.

    At each frequency the nearest to the carried state, motions without impacts included. ``form``: of the trace and
    determinant that decide stability, so that the printed formulas' mistakes can be swept beside the corrected ones.
    """

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float = 0.0,
        span: float = 0.0,
        *,
        periods: int = 1,
        form: Form = "derived",
        strikes_only: bool = False,
    ) -> None:
        """``periods``: 1 … 16; ``slowest``: the lowest drive frequency, rad/s (0: the mode's own frequency).

        ValueError for more than one mode, no stiffness, a mode that is not underdamped, an unknown form.
        """
        super().__init__(system, strikes_only)
        check_form(form)
        faults: list[str] = []
        periods = count("periods", periods, faults, least=1, most=HIGHEST)
        refuse("", faults)
        self.periods, self.form, self.slowest = periods, form, slowest / self.mode.omega or 1.0
        self._flights = flight_solver(self.mode.oscillator(0.0), self.slowest)

    def striking(self, model: Oscillator, omega: float) -> list[Motion]:
        """Motions of the admissible orbits that are stable by this solver's form."""
        orbits = admissible_orbits(ImpactMap(model, omega, self._flights), self.periods)
        return [orbit_motion(orbit) for orbit in orbits if orbit_invariants(orbit, self.form).stable]


def orbit_motion(orbit: Orbit) -> Motion:
    """Stationary motion of an orbit."""
    n, period = orbit.periods, 2 * np.pi / orbit.omega
    since = (np.arange(n) + 1) * period - orbit.time
    mean, square = orbit.means()
    return Motion(orbit.oscillator.gap, orbit.lowest(), orbit.place(since), mean, square, n, 1 / n, orbit.velocity)
