"""Settled motion of a fidelity: exact where its solver's is, else sampled by the solver itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift
from vibeam.case.plans import ShowPlan
from vibeam.figures.sheet import Column, Columns, NoMotion
from vibeam.flight.trajectory import Trajectory, simulate
from vibeam.observe.measuring_chain import Chain, MeasuredRecord, measure
from vibeam.observe.motion import impacts_within, last_periods
from vibeam.observe.phase_plane import phase_portrait
from vibeam.solvers import SOLVERS
from vibeam.solvers import solver as solver_named
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array

SAMPLES = 1000  # samples a drive period, of a motion that is exact between its events


@dataclass(frozen=True)
class Settled:
    """Fidelity after its transient at one drive: ``state`` at the drive's phase 0 (None: ``fault`` says why).

    Under several harmonics ``system`` has the modes of ``SeveralHarmonics``: its outputs are the motion's, modes not.
    """

    system: ImpactSystem
    drive: Drive
    solver: Any
    state: State | None
    fault: str = ""
    samples: bool = False  # motion of the solver that consists of samples

    @property
    def reached(self) -> State:
        """State at the drive's phase 0; NoMotion, with the reason, without one."""
        if self.state is None:
            raise NoMotion(self.fault)
        return self.state

    @property
    def period(self) -> float:
        """Drive period, s."""
        return 2 * np.pi / self.drive.omega


@lru_cache(maxsize=16)
def _system(case: Case, name: str) -> ImpactSystem:
    """System of a fidelity, built once for all frequencies of a figure: assembling takes longer than settling."""
    return case.system(name)


def settled(
    case: Case, name: str, frequency: float, plan: ShowPlan, *, system: ImpactSystem | None = None,
    before: Sequence[float] = (),
) -> Settled:  # fmt: skip
    """Settle the fidelity for the plan's periods at ``frequency`` Hz, from static equilibrium.

    ``before``: frequencies (Hz) at which it settles first, the state carried on, as along a branch of a sweep.
    ``system``: one that moves alike, in place of the case's.
    """
    model, state = _system(case, name) if system is None else system, None
    for each in (*before, frequency):
        begin = _settled(case, name, each, plan, model, state)
        state = begin.state
    return begin


def _settled(
    case: Case, name: str, frequency: float, plan: ShowPlan, model: ImpactSystem, start: State | None
) -> Settled:
    omega, fidelity = np.array([2 * np.pi * frequency]), case.fidelities[name]
    drift = gap_drift(case.scene_of(name), omega)
    system = model if drift is None else replace(model, gap=model.gap + float(drift[0]))
    drive = Drive(float(omega[0]), float(np.ravel(case.amplitude_of(name, omega))[0]))
    harmonics = case.scene_of(name).harmonics
    if harmonics:
        from vibeam.solvers.harmonic_point import started

        system, start = started(system, drive, harmonics, fidelity.solver)
    made = solver_named(fidelity.solver, system, drive.omega, 0.0, **fidelity.options)
    if plan.output not in ("contact", *system.outputs, *system.derivatives):
        return Settled(system, drive, made, None, f"there is no {plan.output} in this model")
    response, state = made.steady(omega, drive.amplitude, start, max(plan.settle - 1, 0), 1, plan.output)
    ended = Ended.of_code(int(response.ended[0]))
    if ended is not Ended.COMPLETE:
        return Settled(system, drive, made, None, ended.value)
    return Settled(system, drive, made, state, samples=SOLVERS[fidelity.solver].samples)


def exact_motion(begin: Settled, periods: float) -> Trajectory:
    """Compute ``periods`` drive periods of the settled motion by flight, which is exact; NoMotion where there is none.

    A motion found in closed form continues by itself.
    """
    path = simulate(begin.system, begin.drive, periods * begin.period, begin.reached)
    if path.ended is not Ended.COMPLETE:
        raise NoMotion(path.ended.value)
    return path


def motion_columns(case: Case, name: str, frequency: float, plan: ShowPlan, periods: int) -> Columns:
    """Compute ``periods`` drive periods of the settled motion; at an impact one sample before, one after.

    Through the fidelity's measuring chain, where it has one: its samples, and when they show the impacts.
    """
    chain = case.chain_of(name)
    if chain is not None:
        return _measured(measured_window(case, name, frequency, plan, periods, chain))
    return exact_columns(settled(case, name, frequency, plan), periods, plan.output)


def exact_columns(begin: Settled, periods: int, output: str) -> Columns:
    """Compute ``periods`` drive periods of the settled motion itself, at its solver's samples where it has them."""
    if begin.samples:
        found = begin.solver.motion(begin.drive, begin.reached, 0.0, periods * begin.period)
        values = found.values @ begin.system.output(output)
        return _columns(found.times, values[:, 0], values[:, 1], found.impact_times, found.impact_velocities, None)
    path = exact_motion(begin, periods)
    curve = phase_portrait(path, output, periods=periods, points=SAMPLES)
    hits = impacts_within(path, *last_periods(path, periods))
    jumps = curve.velocity[curve.jumps + 1] - curve.velocity[curve.jumps]
    return _columns(curve.time, curve.displacement, curve.velocity, hits[:, 0], hits[:, 1], jumps)


def _measured(found: MeasuredWindow) -> Columns:
    record, hits = found.window, found.hits
    shown = hits[:, 0] + found.delay - found.begin
    return _columns(record.time - found.begin, record.displacement, record.velocity, shown, hits[:, 1], None)


def _columns(
    time: Array, displacement: Array, velocity: Array, struck: Array, velocities: Array, jumps: Array | None
) -> Columns:
    columns = {
        "time": Column(time, "s", "time, the drive's phase 0 at 0"),
        "displacement": Column(displacement, "q", "displacement of the output"),
        "velocity": Column(velocity, "q/s", "velocity of the output"),
        "impact_time": Column(struck, "s", "times of the impacts"),
        "impact_velocity": Column(velocities, "c/s", "velocity of the contact just before impact, q̇₋"),
    }
    if jumps is not None:
        columns["jump"] = Column(jumps, "q/s", "by how much the impacts change the output's velocity")
    return columns


@dataclass(frozen=True)
class MeasuredWindow:
    """Motion from before its window [``begin``, ``end``] s (after which a drive period more) and its ``record``.

    The drive's phase is 0 at ``begin``; a filter has settled one drive period before.
    """

    path: Trajectory
    record: MeasuredRecord
    begin: float
    end: float
    chain: Chain

    @property
    def delay(self) -> float:
        """Delay of the record, s."""
        return self.chain.low_pass.delay() if self.chain.low_pass else 0.0

    @property
    def window(self) -> MeasuredRecord:
        """Samples of the window alone."""
        inside = (self.record.time >= self.begin) & (self.record.time <= self.end)
        return MeasuredRecord(
            *(rows[inside] for rows in (self.record.time, self.record.displacement, self.record.velocity))
        )

    @property
    def hits(self) -> Array:
        """Times and contact velocities just before (m, 2) of the impacts in the window."""
        return impacts_within(self.path, self.begin, self.end)

    @property
    def exact(self) -> bool:
        """True where the samples are the motion itself."""
        return self.chain.velocity == "exact"


def measured_window(
    case: Case, name: str, frequency: float, plan: ShowPlan, periods: int, chain: Chain
) -> MeasuredWindow:
    """Measured window of ``periods`` drive periods of the settled motion at ``frequency`` Hz; NoMotion without one."""
    begin = settled(case, name, frequency, plan)
    fading = chain.low_pass.settling() if chain.low_pass else 0.0
    lead = 1 + ceil(fading / begin.period)
    path = exact_motion(begin, lead + periods + 1)
    first, last = lead * begin.period, (lead + periods) * begin.period
    record = measure(path, chain, plan.output).after(first - begin.period)
    return MeasuredWindow(path, record, first, last, chain)


def chain_or_exact(case: Case, name: str, rate: float) -> Chain:
    """Measuring chain of a fidelity; without one, exact samples at ``rate`` a second."""
    return case.chain_of(name) or Chain(rate, velocity="exact")
