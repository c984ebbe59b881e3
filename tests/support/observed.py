"""Motions that are known in closed form, for the tests of what is read off them."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np

import vibeam
from vibeam.flight.trajectory import Trajectory
from vibeam.periodic.orbit import Orbit

NEUTRAL = Path(__file__).parents[2] / "cases" / "dtu_neutral.toml"
OMEGA, SIZE = 3.0, 2e-3


def rectified_sine(periods: int = 4) -> Trajectory:
    """x = −SIZE |sin OMEGA t|: undamped, R = 1, gap 0, no force; a drive of 2 OMEGA only counts the periods.

    A second mode, which the contact does not move, swings freely: η₂ = SIZE cos 4 OMEGA t.
    """
    system = vibeam.ImpactSystem.from_modes(
        [OMEGA, 4 * OMEGA], 0.0, [1.0, 0.0], [0.0, 0.0], outputs={"sensor": [1.0, 0.0], "both": [1.0, 3.0]}
    )
    state = vibeam.State(np.array([0.0, SIZE]), np.array([-OMEGA * SIZE, 0.0]))
    return vibeam.simulate(system, vibeam.Drive(2 * OMEGA, 0.0), periods * np.pi / OMEGA, state)


@functools.cache
def settled(name: str, frequency: float, periods: float = 4.0, **keys: str) -> tuple[Orbit, Trajectory]:
    """The stable orbit of a fidelity of the DTU beam (keys with __ for dots), its motion from after an impact."""
    case = vibeam.load(NEUTRAL, set={key.replace("__", "."): value for key, value in keys.items()})
    system = case.system(name)
    drive = vibeam.Drive(2 * np.pi * frequency, case.base_amplitude)
    orbit = next(found for found in vibeam.orbits(system, drive) if found.admissible and found.stable)
    path = vibeam.simulate(system, drive, orbit.time + periods / frequency, orbit.state, t_start=orbit.time)
    return orbit, path


def resting(periods: int = 60) -> Trajectory:
    """One mode pressed on the stop and driven off it: chatter and a rest in every period."""
    system = vibeam.ImpactSystem.from_modes([1.0], 0.05, [1.0], [1.0], gap=-0.2, restitution=0.4)
    drive = vibeam.Drive(0.7, 1.0)
    return vibeam.simulate(system, drive, periods * 2 * np.pi / drive.omega)
