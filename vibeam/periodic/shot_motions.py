"""Periodic motions at points of frequency and base amplitude by shooting, for every system that flies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibeam.flight.solver import ExactSolver, exact_solver
from vibeam.periodic.motions import Motions, OrbitKind
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import near
from vibeam.periodic.shooting import NoOrbit, Reason
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

Start = tuple[float, State, int]  # time, s, the drive's phase 0 at 0; state there; drive periods
ANOTHER = Reason.SHORTER, Reason.LEFT


def shot_motions(
    system: ImpactSystem, omega: Array, base: Array, output: str, starts: Sequence[Start | None]
) -> Motions:
    """Motions at drives ``omega`` (points,) rad/s and ``base`` amplitudes (points,) m, each near its start.

    ``starts`` (points,), all of as many periods; None: no motion is looked for. ValueError for an unknown output.
    """
    runner = exact_solver(system, float(omega.min()))
    every = [
        None if start is None else _shot(runner, Drive(float(rate), float(size)), start)
        for rate, size, start in zip(omega, base, starts, strict=True)
    ]
    known = [(at, found) for at, found in enumerate(every) if isinstance(found, Orbit)]
    periods = next((start[2] for start in starts if start is not None), 1)
    most = max((len(orbit.times) for _, orbit in known), default=0)
    codes = np.array([_kind(found).code for found in every])
    motions = Motions.without_values(omega, base, periods, codes, most, system.size)
    for at, orbit in known:
        _note(motions, at, orbit, output)
    return motions


def _shot(runner: ExactSolver, drive: Drive, start: Start) -> Orbit | NoOrbit:
    time, state, periods = start
    try:
        return near(StroboscopicMap(runner.system, drive, time, runner=runner), state, periods)
    except NoOrbit as refused:
        return refused


def _kind(found: Orbit | NoOrbit | None) -> OrbitKind:
    if isinstance(found, Orbit):
        return OrbitKind.ORBIT if found.stable else OrbitKind.UNSTABLE
    return OrbitKind.ANOTHER if found is not None and found.reason in ANOTHER else OrbitKind.NO_ORBIT


def _note(motions: Motions, at: int, orbit: Orbit, output: str) -> None:
    """Fill point ``at`` with a motion and what is read of its ``output``."""
    window, struck = orbit.watched(output), len(orbit.times)
    motions.phases[at, :struck] = np.mod(orbit.drive.omega * orbit.times, 2 * np.pi * orbit.periods)
    motions.velocities[at, :struck] = orbit.velocities
    motions.time[at], motions.displacement[at], motions.speed[at] = (
        orbit.time, orbit.state.displacement, orbit.state.velocity,
    )  # fmt: skip
    motions.maximum[at], motions.minimum[at], motions.reach[at] = (
        window.maximum[0], window.minimum[0], window.reach[0],
    )  # fmt: skip
    motions.impact_velocity[at] = orbit.velocities.mean() if struck else np.nan
    motions.uncertainty[at] = orbit.residual * window.amplitude[0]
    motions.reach_uncertainty[at] = orbit.residual * abs(window.reach[0])
    motions.first[at] = orbit.corrections[0]
