"""Motions that flights settle on, and the closed forms of impact trains beside them."""

from __future__ import annotations

import numpy as np
from train_equations import Trains, accelerations, contact_phasor, green_sums, in_time, residual, states_before

from vibeam.flight.trajectory import simulate
from vibeam.periodic.multipliers import multipliers
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

Array = np.ndarray


def settled(system: ImpactSystem, drive: Drive, periods: int = 1, settle: int = 300) -> Orbit:
    """The motion that shooting finds after ``settle`` drive periods from rest; NoOrbit without one."""
    end = settle * 2 * np.pi / drive.omega
    (found,) = orbits(system, drive, periods, start=simulate(system, drive, end).state)
    return found


def train_of(orbit: Orbit) -> Trains:
    """The impacts of a plain system's motion."""
    impulses = -(1 + orbit.system.restitution) * orbit.velocities / orbit.system.mobility
    return trains(orbit.drive, orbit.periods, orbit.times, impulses)


def trains(drive: Drive, periods: int, times: Array, impulses: Array) -> Trains:
    """One motion with impacts at ``times`` (m,) s."""
    omega, amplitude = np.array([drive.omega]), np.array([drive.amplitude])
    return Trains(drive.omega * times[None], impulses[None], omega, amplitude, periods)


def missed(system: ImpactSystem, train: Trains) -> Array:
    """Residuals (2m,) of the equations of impact trains: contact, m, then restitution, m/s."""
    response = contact_phasor(system, train.omega, train.amplitude)
    return np.asarray(residual(system, train, response, green_sums(system, train))[0][0])


def closed_multipliers(orbit: Orbit) -> Array:
    """Multipliers, largest first, by propagators and saltation matrices of the impacts' times alone."""
    system, train = orbit.system, train_of(orbit)
    response = contact_phasor(system, train.omega, train.amplitude)
    toward = accelerations(train, response, green_sums(system, train))
    flights, ends = in_time(train, toward / system.impact_velocity(train.impulses))
    return np.asarray(multipliers(system, flights, ends)[0])


def shot(system: ImpactSystem, drive: Drive, train: Trains) -> Orbit:
    """The motion that shooting finds from the state just after the first impact of a train."""
    displacement, velocity = (each[0, 0] for each in states_before(system, train))
    start = State(displacement, velocity + train.impulses[0, 0] * system.contact)
    (found,) = orbits(system, drive, train.periods, start=start, time=float(train.phases[0, 0] / drive.omega))
    return found
