"""Periodic motions with m impacts in n drive periods, refined to round-off from settled flights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.periodic.closed_orbits import AdmissibilityCheck
from vibeam.periodic.modal_sums import resonant
from vibeam.periodic.multipliers import multipliers
from vibeam.periodic.orbit_curve import checked
from vibeam.periodic.trains import (
    Train,
    accelerations,
    contact_phasor,
    green_sums,
    in_time,
    newton,
    states_before,
)
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array, Complex, ValueRecord

SETTLED = 1e-3  # tolerance, as a share of the impact velocities, between the flight and the motion it settles on
MOST = 4  # largest number of impacts a span


@dataclass(frozen=True, eq=False, repr=False)
class TrainOrbit(ValueRecord):
    """Motion with m impacts every ``periods`` drive periods; SI units, the drive's phase 0 at time 0."""

    system: ImpactSystem
    drive: Drive
    periods: int
    times: Array  #: of the impacts (m,), s, ascending
    impulses: Array  #: (m,) impulses, negative: away from the stop
    velocities: Array  #: (m,) contact velocities just before, toward the stop, m/s
    state: State  #: state just after the first impact
    multipliers: Complex  #: the 2n Floquet multipliers, largest first
    stable: bool
    admissible: bool  #: the flight solver finds exactly these impacts, in order


def train_orbit(
    system: ImpactSystem, drive: Drive, periods: int, times: ArrayLike, velocities: ArrayLike
) -> TrainOrbit | None:
    """Refine the motion whose impacts lie near ``times`` (m,) s with ``velocities`` before, m/s; None without one.

    ValueError for more than four impacts, for modes without stiffness, and as in ``orbits``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> one = vibeam.orbits(system, vibeam.Drive(2.0, 0.1))[0]
    >>> again = vibeam.train_orbit(system, one.drive, 1, [one.time], [one.velocity])
    >>> bool(abs(again.velocities[0] - one.velocity) < 1e-12)
    True
    """
    checked(system, drive.omega, periods)
    guess, speeds = np.atleast_1d(np.asarray(times, dtype=float)), np.atleast_1d(np.asarray(velocities, dtype=float))
    if not 1 <= len(guess) <= MOST or guess.shape != speeds.shape:
        raise ValueError(f"times, velocities: must be 1 to {MOST} impacts each, and as many of one as of the other")
    reason = resonant(system, drive.omega, periods)
    if np.any(system.omega == 0):
        reason = "omega: several impacts a span need modes with stiffness only"
    if reason:
        raise ValueError(reason)
    impulses = -(1 + system.restitution) * speeds / system.mobility
    span = 2 * np.pi * periods / drive.omega
    train = newton(system, drive, periods, Train(guess - span * np.floor(guess.min() / span), impulses))
    return None if train is None else _orbit(system, drive, periods, train)


def settled_orbit(
    system: ImpactSystem, drive: Drive, periods: int = 1, *, state: State | None = None, settle: int = 300
) -> TrainOrbit | None:
    """Find the motion with period ``periods`` T that the flight solver reaches in ``settle`` periods from ``state``.

    None where that has no or more than four impacts in ``periods`` periods, or does not repeat. ValueError as in
    ``train_orbit``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> orbit = vibeam.settled_orbit(system, vibeam.Drive(2.0, 0.1))
    >>> len(orbit.times), orbit.stable
    (1, True)
    """
    witness, period = AdmissibilityCheck(system, drive.omega), 2 * np.pi / drive.omega
    begin, end = settle * period, (settle + periods) * period
    start = witness.flight.simulate(drive, state, 0.0, begin, 10**7)[2] if settle else state
    times, velocities = witness.strikes(drive, start, begin, end, MOST + 1)
    if not 1 <= len(times) <= MOST:
        return None
    found = train_orbit(system, drive, periods, times, velocities)
    return found if found is not None and _agree(found.velocities, velocities) else None


def _agree(found: Array, observed: Array) -> bool:
    """Test whether two sets of impacts agree up to a cyclic shift."""
    turns = [np.abs(np.roll(found, k) - observed).max() for k in range(len(observed))]
    return len(found) == len(observed) and bool(min(turns) < SETTLED * observed.max())


def _orbit(system: ImpactSystem, drive: Drive, periods: int, train: Train) -> TrainOrbit:
    span = 2 * np.pi * periods / drive.omega
    velocities = system.impact_velocity(train.impulses)
    displacement, before = (each[0] for each in states_before(system, train.under(drive, span)))
    values = multipliers_of(system, drive, span, train)
    state = State(displacement[0], before[0] + system.contact * train.impulses[0])
    witness = AdmissibilityCheck(system, drive.omega)
    expected = np.append(train.times[1:], train.times[0] + span)
    slack = witness.slack(drive, float(velocities.min()), span)
    end = train.times[0] + span + slack
    observed, _ = witness.strikes(drive, state, float(train.times[0]), float(end), len(expected) + 1)
    admissible = len(observed) == len(expected) and bool(np.abs(observed - expected).max() <= slack)
    return TrainOrbit(
        system, drive, periods, train.times, train.impulses, velocities, state, values,
        bool(abs(values[0]) < 1), admissible,
    )  # fmt: skip


def multipliers_of(system: ImpactSystem, drive: Drive, span: float, train: Train) -> Complex:
    """Multipliers, largest first, from the flights and impacts of one span, from just after the first impact."""
    trains = train.under(drive, span)
    response = contact_phasor(system, trains.omega, trains.amplitude)
    toward = accelerations(trains, response, green_sums(system, trains))
    flights, ends = in_time(trains, toward / system.impact_velocity(trains.impulses))
    return np.asarray(multipliers(system, flights, ends)[0])
