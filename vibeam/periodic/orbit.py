"""Certified periodic motions with one impact per n drive periods at one drive.

The flight solver, which isolates every root, certifies that nothing is struck between the impacts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.readout import rests, struck
from vibeam.flight.solver import FlightSolver
from vibeam.periodic.modal_sums import Roots, Sums, balance, resonant, sums
from vibeam.periodic.multipliers import multipliers
from vibeam.periodic.orbit_curve import checked
from vibeam.periodic.trains import carried, phasors, state_after
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.labelled import Viewed
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex, ValueRecord

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
        if rests(trace).any():
            return np.zeros(0), np.zeros(0)
        hit = trace[struck(trace) & (trace[:, layout.BEFORE] > least)]
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


@dataclass(frozen=True, eq=False, repr=False)
class Orbit(ValueRecord, Viewed):
    """Motion with one impact every ``periods`` drive periods. SI units.

    ``admissible``: it stays clear of the stop between its impacts, proved by the flight solver's root bounds; one that
    is not satisfies the equations at the impact but is no motion, and its ``reach`` is NaN.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> orbit = vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0]
    >>> bool(abs(orbit.velocity * 1.5 + orbit.impulse) < 1e-12), round(orbit.span, 6)  # p = −(1 + R) v, 2π/Ω
    (True, 3.141593)
    """

    system: ImpactSystem
    drive: Drive
    periods: int
    phase: float  #: drive phase Ωt at the impact, 0 … 2π
    impulse: float  #: impulse on the contact, N s per unit modal mass, negative: away from the stop
    velocity: float  #: contact velocity just before, toward the stop, m/s
    reach: float  #: gap − min of the contact displacement, m
    state: State  #: state just after the impact
    multipliers: Complex  #: the 2n Floquet multipliers, largest first; none is trivial, because time is not a state
    stable: bool  #: all multipliers within the unit circle
    admissible: bool

    @property
    def time(self) -> float:
        """Impact time, s, with the drive's phase 0 at time 0."""
        return self.phase / self.drive.omega

    @property
    def span(self) -> float:
        """Time from impact to impact, s."""
        return 2 * np.pi * self.periods / self.drive.omega

    def watched(self, output: str = "contact") -> FrequencyResponse:
        """Steady point with extremes and modal energies over the motion; ValueError where it is not admissible.

        KeyError for an unknown output.
        """
        if not self.admissible:
            raise ValueError("orbit: it passes through the stop, so there is no motion to watch")
        self.system.output(output)
        witness = AdmissibilityCheck(self.system, self.drive.omega)
        return witness.watched(self.drive, self.state, self.time, self.periods, output)[0]

    def amplitude(self, output: str = "contact") -> float:
        """½(max − min) of an output over the motion, m; errors as in ``watched``."""
        return float(self.watched(output).amplitude[0])


def orbits(
    system: ImpactSystem, drive: Drive, periods: int = 1, witness: AdmissibilityCheck | None = None
) -> tuple[Orbit, ...]:
    """Find all motions with one impact per ``periods`` drive periods, harder impact first: none, one or two.

    Exact for any number of modes of any damping, with static forces; not admissible ones are among them. ``witness``:
    a flight solver for the certificate, to be reused for many drives. Empty where the impact equations have no real
    root that pushes away from the stop (also without a drive). ValueError for an undamped mode at a resonance (driven
    at its own frequency, or a whole number of its turns in the span, so that impacts make it grow), and for modes
    without stiffness that no static force brings back to the stop.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> [orbit.stable for orbit in vibeam.orbits(system, vibeam.Drive(2.0, 0.1))]
    [True]
    """
    omega = checked(system, drive.omega, periods)
    reason = resonant(system, drive.omega, periods)
    if reason:
        raise ValueError(reason)
    if drive.amplitude == 0:
        return ()
    total = sums(system, omega, periods)
    found = balance(system, total, drive.amplitude, system.gap)
    own = AdmissibilityCheck(system, drive.omega) if witness is None else witness
    return tuple(
        _orbit(own, drive, int(periods), total, found, k)
        for k in (0, 1)
        if found.impulse[0, k] < 0 and np.isfinite(found.phase[0, k])
    )


def _orbit(witness: AdmissibilityCheck, drive: Drive, periods: int, total: Sums, found: Roots, k: int) -> Orbit:
    phase, impulse, velocity = (float(row[0, k]) for row in (found.phase, found.impulse, found.velocity))
    system, time = witness.system, phase / drive.omega
    state = state_after(system, drive, periods, phase, impulse)
    values = multipliers(system, total.span, found.relative_acceleration[:, k])[0]
    admissible = witness.admits(drive, state, time, periods, velocity)
    reach = float(witness.watched(drive, state, time, periods, "contact")[0].reach[0]) if admissible else np.nan
    return Orbit(
        system, drive, periods, phase, impulse, velocity, reach, state, values, bool(abs(values[0]) < 1), admissible
    )
