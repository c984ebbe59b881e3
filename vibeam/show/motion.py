"""A fidelity's settled motion, sampled by its own solver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.response import Ended
from vibeam.show.plan import Column, Sheet
from vibeam.simulate import simulate
from vibeam.solvers import solver as solver_named
from vibeam.state import State
from vibeam.system import Drive, ImpactSystem

if TYPE_CHECKING:
    from vibeam.case import Case

Array = NDArray[np.float64]
SAMPLES = 1000  # a drive period, of a motion that is exact between its events


@dataclass(frozen=True)
class Settled:
    """A fidelity after its transient at one drive: ``state`` at the drive's phase 0 (None: ``fault`` says why)."""

    system: ImpactSystem
    drive: Drive
    solver: Any
    state: State | None
    fault: str = ""

    @property
    def period(self) -> float:
        """Of the drive, s."""
        return 2 * np.pi / self.drive.omega


def settled(case: Case, name: str, frequency: float, settle: int) -> Settled:
    """The fidelity after ``settle`` periods at ``frequency`` Hz, begun at static equilibrium."""
    system, fidelity = case.system(name), case.fidelities[name]
    omega = np.array([2 * np.pi * frequency])
    drive = Drive(float(omega[0]), float(np.ravel(case.amplitude_of(name, omega))[0]))
    made = solver_named(fidelity.solver, system, drive.omega, 0.0, **fidelity.options)
    response, state = made.steady(omega, drive.amplitude, None, max(settle - 1, 0), 1, case.sweep.output)
    ended = Ended.of_code(int(response.ended[0]))
    if ended is not Ended.COMPLETE:
        return Settled(system, drive, made, None, ended.value)
    return Settled(system, drive, made, state)


def motion_sheet(case: Case, name: str, frequency: float, settle: int, periods: int) -> Sheet:
    """``periods`` drive periods of the settled motion; at an impact one sample before, one after."""
    begin = settled(case, name, frequency, settle)
    if begin.state is None:
        return Sheet(name, frequency, fault=begin.fault)
    span = periods * begin.period
    if hasattr(begin.solver, "motion"):
        times, values, struck, speeds = _stepped(begin, begin.state, span)
    else:
        times, values, struck, speeds = _flown(begin, begin.state, span)
    row = begin.system.output(case.sweep.output)
    return Sheet(
        name,
        frequency,
        {
            "time": Column(times, "s", "time, the drive's phase 0 at 0"),
            "displacement": Column(values[:, 0] @ row, "q", "displacement of the output"),
            "velocity": Column(values[:, 1] @ row, "q/s", "velocity of the output"),
            "impact_time": Column(struck, "s", "times of the impacts"),
            "impact_velocity": Column(speeds, "q/s", "velocity of the contact just before impact, q̇₋"),
        },
    )


def _stepped(begin: Settled, state: State, span: float) -> tuple[Array, Array, Array, Array]:
    """At the solver's own samples."""
    found = begin.solver.motion(begin.drive, state, 0.0, span)
    return found.times, found.values, found.impact_times, found.impact_velocities


def _flown(begin: Settled, state: State, span: float) -> tuple[Array, Array, Array, Array]:
    """By flight, which is exact: what a solver in closed form found goes on for itself."""
    path = simulate(begin.system, begin.drive, span, state)
    struck = path.impact_times
    grid = np.linspace(0.0, span, round(span / begin.period) * SAMPLES + 1)
    times = np.sort(np.concatenate([grid, np.nextafter(struck, 0.0), struck]))
    times = times[times <= path.t_end]
    return times, path.modes_at(times), struck, path.impact_velocities
