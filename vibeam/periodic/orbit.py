"""Periodic motion of a driven system: one record for closed forms and for motions found by shooting."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.solver import ExactSolver
from vibeam.flight.trajectory import Trajectory
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.labelled import Viewed
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex, Index, ValueRecord

IMPACTS = 10**7  # at most, in one call


@dataclass(frozen=True, eq=False, repr=False)
class Orbit(ValueRecord, Viewed):
    """Motion that repeats every ``periods`` drive periods. SI units, the drive's phase 0 at time 0.

    ``admissible``: it is flown as it stands. A closed form that is not satisfies the equations at its impact but passes
    through the stop between, and is no motion: its ``reach`` is NaN. ``state`` lies just after the impact in closed
    form, else in the middle of the longest flight.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> orbit = vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0]
    >>> bool(abs(orbit.velocity * 1.5 + orbit.impulse) < 1e-12), round(orbit.span, 6)  # p = −(1 + R) v, 2π/Ω
    (True, 3.141593)
    """

    system: ImpactSystem
    drive: Drive
    periods: int
    time: float  #: of ``state``, s
    state: State
    times: Array  #: of the impacts (m,), s, or first touches of a stop that yields, in one span from ``time`` on
    velocities: Array  #: of the contact just before them, toward the stop (m,), m/s
    contacts: Index  #: struck (m,): 0 the first stop, then as in ``Trajectory.gaps``
    rests: int  #: in one span
    stable: bool  #: all multipliers within the unit circle
    admissible: bool
    residual: float  #: |P(x) − x| over the motion's size; 0 in closed form
    corrections: tuple[float, ...]  #: Newton's, as shares of the motion's size; none in closed form
    monodromy: Array = field(repr=False)  #: derivative of the state after a span by that before, units of velocity
    _multipliers: Callable[[], Complex] = field(compare=False, repr=False)
    _runner: ExactSolver = field(compare=False, repr=False)

    @cached_property
    def multipliers(self) -> Complex:
        """The 2n Floquet multipliers, largest first; none is trivial, because time is not a state."""
        return self._multipliers()

    @property
    def span(self) -> float:
        """Time after which it repeats, s."""
        return 2 * np.pi * self.periods / self.drive.omega

    @property
    def velocity(self) -> float:
        """Velocity of the hardest impact, just before it, m/s; NaN without impacts."""
        return float(self.velocities[self._hardest]) if len(self.velocities) else np.nan

    @property
    def phase(self) -> float:
        """Drive phase Ωt of the hardest impact, 0 … 2π; NaN without impacts."""
        return float(self.drive.omega * self.times[self._hardest] % (2 * np.pi)) if len(self.times) else np.nan

    @property
    def impulse(self) -> float:
        """Impulse of the hardest impact, N s per unit modal mass, negative: away from the stop.

        NaN without impacts, and of a stop that yields.
        """
        if not len(self.velocities):
            return np.nan
        contacts, struck = Contacts.of(self.system), int(self.contacts[self._hardest])
        row, law, speed = contacts.rows[struck], contacts.laws[struck], np.array([self.velocity])
        return np.nan if law.yields else float(-(speed + law.rebound(speed))[0] / (row @ row))

    @property
    def _hardest(self) -> int:
        return int(np.argmax(self.velocities))

    @cached_property
    def reach(self) -> float:
        """Gap of the first stop less the least displacement of its contact, m."""
        return float(self.watched().reach[0]) if self.admissible else np.nan

    def watched(self, output: str = "contact") -> FrequencyResponse:
        """Steady point with extremes and modal energies over the motion; ValueError where it is not admissible.

        KeyError for an unknown output.
        """
        return self.window(output)[0]

    def window(self, output: str = "contact") -> tuple[FrequencyResponse, State]:
        """The same from the drive's next phase 0 on, and the state there; errors as in ``watched``."""
        if not self.admissible:
            raise ValueError("orbit: it passes through the stop, so there is no motion to watch")
        period = self.span / self.periods
        next_, state = period * np.ceil(self.time / period), self.state
        if next_ > self.time:
            state = self._runner.simulate(self.drive, state, self.time, next_, IMPACTS)[2]
        drive = self.drive
        return self._runner.steady([drive.omega], drive.amplitude, state, 0, self.periods, output)

    def amplitude(self, output: str = "contact") -> float:
        """½(max − min) of an output over the motion, m; errors as in ``watched``."""
        return float(self.watched(output).amplitude[0])

    def path(self) -> Trajectory:
        """The motion over one span from ``time`` on; ValueError where it is not admissible."""
        if not self.admissible:
            raise ValueError("orbit: it passes through the stop, so there is no motion to fly")
        end = self.time + self.span
        found = self._runner.simulate(self.drive, self.state, self.time, end, IMPACTS)
        ended, last, state, segments, stats = found
        assert ended is Ended.COMPLETE
        return Trajectory(self.system, self.drive, self.time, last, state, ended, stats, self._runner, segments)
