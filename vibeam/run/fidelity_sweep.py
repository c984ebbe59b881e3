"""Sweep of one fidelity of a run: its branches, resumed from the results file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from threading import Event
from typing import TYPE_CHECKING

import numpy as np

from vibeam.flight.pause import Stopped
from vibeam.run.recorder import Count, Recorder
from vibeam.run.store.branch import Branch, StoredBranch
from vibeam.run.sweep import march_blocks
from vibeam.solvers import solver
from vibeam.system.response import Branches, FrequencyResponse
from vibeam.system.state import StatesAfter

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.run.store.store import Store
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.motion_curves import MotionCurves
    from vibeam.system.state import State


@dataclass(frozen=True)
class Job:
    """Branches of one fidelity in the order swept, each with its stored points."""

    name: str
    systems: Mapping[str, ImpactSystem]
    fidelity: Fidelity
    branches: tuple[tuple[Branch, StoredBranch], ...]

    @property
    def system(self) -> ImpactSystem:
        """System of the fidelity, built where something is missing."""
        return self.systems[self.name]

    @property
    def missing(self) -> bool:
        """True where points are missing."""
        return any(kept.done < len(kept.response) for _, kept in self.branches)

    @property
    def after(self) -> dict[str, StatesAfter]:
        """States after the points of each branch, as far as they are known."""
        return {branch.direction: kept.after for branch, kept in self.branches}

    def gathered(self, curves: MotionCurves | None) -> Branches:
        """Responses of all branches."""
        return Branches(**{branch.direction: kept.response for branch, kept in self.branches}, curves=curves)


def job_of(
    case: Case, name: str, systems: Mapping[str, ImpactSystem], branches: tuple[Branch, ...], store: Store | None
) -> Job:
    """Job of the fidelity ``name``, with the stored points of its branches."""
    kept = tuple((branch, store.restore(branch) if store else _nothing(branch)) for branch in branches)
    return Job(name, systems, case.fidelities[name], kept)


def _nothing(branch: Branch) -> StoredBranch:
    points, modes = len(branch.frequency), branch.modes
    return StoredBranch(FrequencyResponse.empty(branch.frequency, modes), 0, None, StatesAfter.unknown(points, modes))


def sweep_branches(case: Case, job: Job, store: Store | None, count: Count, stop: Event) -> None:
    """Sweep all branches of one fidelity, the state carried from each to the next."""
    carried: State | None = None
    struck = 0
    for branch, kept in job.branches:
        recorder = Recorder(branch, kept, store)
        start = kept.state if kept.done else carried
        carried = start
        try:
            for block, states in _march(case, job, kept, start, struck):
                carried = states[-1]
                recorder.add(block, states)
                count.add(len(block))
                if stop.is_set():
                    raise Stopped
        finally:
            recorder.write()
        struck += int(kept.response.impacts.sum())


def _march(
    case: Case, job: Job, kept: StoredBranch, state: State | None, struck: int
) -> Iterator[tuple[FrequencyResponse, list[State]]]:
    """Sweep the missing points; ``struck``: number of impacts in the branches before this one."""
    from vibeam.case.fidelity import gap_drift, gap_wear

    scene = case.scene_of(job.name)
    plan, omega = case.sweep, kept.response.omega[kept.done :]
    if not len(omega):
        return iter(())
    return march_blocks(
        job.system,
        omega,
        case.amplitude_of(job.name, omega),
        settle=plan.settle,
        hold=plan.hold,
        solver=job.fidelity.solver,
        options=job.fidelity.options,
        output=plan.output,
        state=state,
        slowest=float(kept.response.omega.min()),
        drift=gap_drift(scene, omega),
        wear=gap_wear(scene),
        harmonics=scene.harmonics,
        struck=struck + int(kept.response.impacts[: kept.done].sum()),
    )


def _curves_key(case: Case, name: str) -> str:
    return sha256(case.own[name].encode() + np.sort(case.sweep.frequency).tobytes()).hexdigest()


def known_curves(case: Case, job: Job, store: Store | None) -> MotionCurves:
    """All motions known to the fidelity's solver at the sweep's frequencies, from the file where stored."""
    key = _curves_key(case, job.name)
    stored = store.curves(job.name, key) if store else None
    if stored is not None:
        return stored
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    made = solver(job.fidelity.solver, job.system, float(omega[0]), 0.0, **job.fidelity.options)
    found: MotionCurves = made.curves(omega, case.amplitude_of(job.name, omega), case.sweep.output)
    if store:
        store.write_curves(job.name, key, found)
    return found
