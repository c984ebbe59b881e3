"""The two sweeps, and what is true in them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import vibeam
from peers.job import Array, Impacts, Job
from vibeam.case.fidelity import Fidelity
from vibeam.case.fidelity import system as system_of
from vibeam.flight.solver import FlightSolver
from vibeam.system.state import State
from vibeam_models.base_motion import base_amplitude

RIG = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
PERIODS, SETTLE = 250, 1000


def nominal(points: int = 201) -> Job:
    """β = 0.015, B = 0.5e-3, R = 0.9, Δ = 0, Ω = 1.5 … 2.5, in units of 0.01, the state carried from point to point.

    The states carried are flight's, so that every solver starts every point alike, in whatever order.
    """
    grid, one = np.linspace(1.5, 2.5, points), np.ones(1)
    starts = np.tile(np.array([[-0.1], [0.0]]), (points, 1, 1))
    job = Job(one, np.array([0.015]), one, one, 0.0, 0.9, 0.5e-3 / 0.01, grid, starts, PERIODS)
    starts[1:] = carried(job, PERIODS)[:-1]
    return job


def rig(modes: int, points: int = 31) -> Job:
    """The DTU rig's first modes, 14 … 17 Hz in units of its first frequency and 0.1 mm: from its settled motions."""
    case = vibeam.load(RIG)
    system = system_of(case.scene, Fidelity("rig", "modal", modes))
    first, size, norm = system.omega[0], 1e-4, float(np.linalg.norm(system.contact))
    job = Job(
        system.omega / first, system.zeta, system.contact / norm, system.load * norm, system.gap / size,
        system.restitution, base_amplitude(case.scene) / size, 2 * np.pi * np.linspace(14, 17, points) / first,
        np.zeros((points, 2, modes)), PERIODS,
    )  # fmt: skip
    return replace(job, starts=carried(job, SETTLE))


def system(job: Job) -> vibeam.ImpactSystem:
    """The job's, for vibeam."""
    return vibeam.ImpactSystem.from_modes(
        job.omega, job.zeta, job.contact, job.load, gap=job.gap, restitution=job.restitution
    )


def carried(job: Job, periods: int) -> Array:
    """States (points, 2, n) after ``periods`` at each drive frequency in turn, from ``starts[0]``."""
    solver, found = FlightSolver(system(job), float(job.grid.min())), []
    state = State(job.starts[0, 0], job.starts[0, 1])
    for omega in job.grid:
        _, state = solver.steady([float(omega)], job.amplitude, state, periods - 1, 1, "contact")
        found.append([state.displacement, state.velocity])
    return np.array(found)


def exact_velocities(job: Job) -> Array:
    """Impact velocity (points,) of the stable one-impact orbit by its closed form; NaN where there is not just one."""
    whole, found = system(job), []
    for omega in job.grid:
        stable = [
            each
            for each in vibeam.orbits(whole, vibeam.Drive(float(omega), job.amplitude))
            if each.stable and each.admissible
        ]
        found.append(stable[0].velocity if len(stable) == 1 else np.nan)
    return np.array(found)


def true_impacts(job: Job) -> list[Impacts]:
    """All impacts of every point, by flight."""
    whole, found = system(job), []
    for omega, (displacement, velocity) in zip(job.grid, job.starts, strict=True):
        drive = vibeam.Drive(float(omega), job.amplitude)
        path = vibeam.simulate(whole, drive, job.end(float(omega)), State(displacement, velocity))
        found.append(Impacts(path.impact_times, path.impact_velocities))
    return found
