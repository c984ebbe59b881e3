"""Work of estimating an error by orbits, counted and not timed, so that it ends at the same point on every machine.

The unit is an evaluation of the contact displacement by one mode of a model, about 0.1 µs of CPU time. Flights count
their evaluations and segments, tangent maps their segments, Newton's method its matrices.
"""

from __future__ import annotations

from vibeam.flight.solver import ExactSolver
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.stroboscopic import Flown, MotionEnded, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Branches
from vibeam.system.state import State
from vibeam_models.arrays import Array

LEAST, SHARE = 6e6, 0.9  # work that a run's estimates may take at least, half a second; share of its sweeps'
CALL = 3e3  # of any flight or matrix
SEGMENT, INTEGRATED = 20.0, 2000.0  # evaluations that a segment takes beside those counted, of an integrated contact
MAP, MATRIX = 8.0, 2.0  # of a segment's tangent map, × modes²; of a matrix of all, × modes³
LIFTED = 2e3  # values of a contact's force that lasts, × modes: see ``lift``
TRIED, STEPS = 1 / 16, 3.0  # part of a period flown to see what all takes; steps of Newton's method that it has
BESIDE = 8  # modes that cost as much as an evaluation itself


class TooDear(Exception):
    """Flights at a point take more than their part of the work."""


class CountedWork:
    """Work done so far, of ``most``; a point may take half of what was left at its ``begin``, the first one all."""

    def __init__(self, most: float = float("inf")) -> None:
        self.most, self.spent = most, 0.0
        self._part = most

    @property
    def done(self) -> bool:
        """Test whether nothing is left that a point could be had for."""
        return self.most - self.spent < CALL * STEPS

    def begin(self) -> None:
        """Begin a point."""
        self._part = self.spent + (self.most - self.spent) / (2 if self.spent else 1)

    def add(self, work: float) -> None:
        """Count work that was done; TooDear where that was more than the point's part."""
        self.spent += work
        self.expect(0.0)

    def expect(self, work: float) -> None:
        """Test whether so much more work is within the point's part; else TooDear."""
        if self.spent + work > self._part:
            raise TooDear

    def matrices(self, system: ImpactSystem) -> None:
        """Expect the matrices of Newton's method."""
        self.expect(STEPS * MATRIX * system.size**3)

    def flight(self, system: ImpactSystem, evaluations: int, segments: int) -> float:
        """Count a flight; its work."""
        beside = INTEGRATED if system.contact_law.integrated else SEGMENT
        work = CALL + (evaluations + beside * segments) * (system.size + BESIDE)
        self.add(work)
        return work

    def lift(self, orbit: Orbit, system: ImpactSystem) -> None:
        """Count the lift of an orbit to another system, before it is done."""
        law = orbit.system.contact_law
        lasts = 10 * LIFTED if law.integrated else LIFTED if law.yields else 1.0
        self.add(CALL + lasts * max(len(orbit.times), 1) * (orbit.system.size + system.size + BESIDE))


def work_of(system: ImpactSystem, branches: Branches) -> float:
    """Work that the sweeps of a model took."""
    evaluations = sum(int(response.evaluations.sum()) for _, response in branches.items())
    return float(evaluations * (system.size + BESIDE))


class CountedMap(StroboscopicMap):
    """Stroboscopic map whose flights and Jacobians count as ``work``."""

    def __init__(self, system: ImpactSystem, drive: Drive, runner: ExactSolver, work: CountedWork) -> None:
        super().__init__(system, drive, runner=runner)
        self._work = work

    def tried(self, state: State, periods: int, begin: float) -> None:
        """Fly a part of a period; TooDear where all that Newton's method needs is more than the point's part."""
        try:
            flown = super().flown(state, TRIED, begin)
        except MotionEnded:
            return
        work = self._work.flight(self.system, flown.evaluations, len(flown.segments.trace))
        self._work.expect(STEPS * ((work - CALL) * periods / TRIED + self._matrix(0)))

    def flown(self, state: State | None, periods: float, begin: float | None = None) -> Flown:
        """See the base class."""
        found = super().flown(state, periods, begin)
        self._work.flight(self.system, found.evaluations, len(found.segments.trace))
        return found

    def jacobian(self, state: State, periods: float, flown: Flown) -> Array:
        """See the base class."""
        self._work.add(self._matrix(len(flown.segments.trace)))
        return super().jacobian(state, periods, flown)

    def _matrix(self, segments: int) -> float:
        n = self.system.size
        return CALL + MAP * segments * n**2 + MATRIX * n**3
