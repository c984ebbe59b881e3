"""Sweep of one fidelity of a run: its branches, resumed from the results file, recorded point by point."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.runs.keys import kept_or_made
from vibeam.runs.parallel import PointCount, Stopped
from vibeam.runs.store.branches import BranchPlan, StoredBranch
from vibeam.runs.store.records import curves_of
from vibeam.runs.sweep import SweepPoints, SweepSettings, march_blocks
from vibeam.solvers import solver
from vibeam.system.quantities import METRES
from vibeam.system.response import Branches, FrequencyResponse
from vibeam.system.state import State, StatesAfter

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam.runs.store.file import Store
    from vibeam.system.curves import MotionCurves
    from vibeam.system.impact_system import ImpactSystem


WRITE_EVERY = 0.2  # seconds: a write costs as much as many points, and a killed run loses no more than this
Progress = Callable[[int, int], None]


class Recorder:
    """Adds points to a branch's response, and writes them to the file every ``WRITE_EVERY`` seconds."""

    def __init__(self, branch: BranchPlan, kept: StoredBranch, store: Store | None) -> None:
        self._branch, self._response, self._store = branch, kept.response, store
        self._after = kept.after
        self._done = self._written = kept.done
        self._states: list[State] = []
        self._due = monotonic() + WRITE_EVERY

    def add(self, block: FrequencyResponse, states: Sequence[State]) -> None:
        """Add the points of ``block``, and the states after the last of them."""
        points = slice(self._done, self._done + len(block))
        for name, values in block.quantities.items():  # the grid's own frequencies stay, to the last bit
            getattr(self._response, name)[points] = values
        self._done = points.stop
        for point, state in enumerate(states, points.stop - len(states)):
            self._after.displacement[point], self._after.velocity[point] = state.displacement, state.velocity
        if len(states) < len(block):
            self._states.clear()  # states in between are unknown
        self._states += states
        if monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        """Write all points not written yet."""
        if self._store and self._done > self._written:
            points = slice(self._written, self._done)
            columns: dict[str, Any] = {name: values[points] for name, values in self._response.quantities.items()}
            block = FrequencyResponse(self._response.frequency[points], **columns)
            self._store.write(self._branch, self._written, block, self._states)
        self._states.clear()
        self._written, self._due = self._done, monotonic() + WRITE_EVERY


@dataclass(frozen=True)
class Job:
    """Branches of one fidelity in the order swept, each with its stored points."""

    name: str
    systems: Mapping[str, ImpactSystem]
    fidelity: Fidelity
    branches: tuple[tuple[BranchPlan, StoredBranch], ...]

    @property
    def system(self) -> ImpactSystem:
        """System of the fidelity, built where something is missing."""
        return self.systems[self.name]

    @property
    def missing(self) -> bool:
        """True where points are missing."""
        return any(kept.done < len(kept.response) for _, kept in self.branches)

    @property
    def found(self) -> int:
        """Number of points that were stored already."""
        return sum(kept.done for _, kept in self.branches)

    @property
    def after(self) -> dict[str, StatesAfter]:
        """States after the points of each branch, as far as they are known."""
        return {branch.direction: kept.after for branch, kept in self.branches}

    def gathered(self, curves: MotionCurves | None = None) -> Branches:
        """Responses of all branches."""
        return Branches(**{branch.direction: kept.response for branch, kept in self.branches}, curves=curves)


def job_of(
    case: Case, name: str, systems: Mapping[str, ImpactSystem], branches: tuple[BranchPlan, ...], store: Store | None
) -> Job:
    """Job of the fidelity ``name``, with the stored points of its branches."""
    kept = tuple((branch, store.restore(branch) if store else _nothing(branch)) for branch in branches)
    return Job(name, systems, case.fidelities[name], kept)


def _nothing(branch: BranchPlan) -> StoredBranch:
    points, modes = len(branch.frequency), branch.modes
    return StoredBranch(FrequencyResponse.empty(branch.frequency, modes), 0, None, StatesAfter.unknown(points, modes))


def sweep_branches(case: Case, job: Job, store: Store | None, count: PointCount, stop: Event) -> None:
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

    omega = kept.response.omega[kept.done :]
    if not len(omega):
        return iter(())
    plan, own, scene = case.sweep, job.fidelity, case.scene_of(job.name)
    slowest = float(kept.response.omega.min())
    points = SweepPoints.of(omega, case.amplitude_of(job.name, omega), slowest, gap_drift(scene, omega))
    settings = SweepSettings(
        plan.settle, plan.hold, own.solver, plan.output, own.options, gap_wear(scene), scene.harmonics
    )  # fmt: skip
    struck += int(kept.response.impacts[: kept.done].sum())
    return march_blocks(job.system, points, settings.checked(job.system), state, struck=struck)


def known_curves(case: Case, job: Job, store: Store | None) -> MotionCurves:
    """All motions known to the fidelity's solver at the sweep's frequencies, from the file where stored."""
    omega = 2 * np.pi * np.sort(case.sweep.frequency)

    def made() -> MotionCurves:
        runner = solver(job.fidelity.solver, job.system, float(omega[0]), 0.0, **job.fidelity.options)
        found: MotionCurves = runner.curves(omega, case.amplitude_of(job.name, omega), case.sweep.output)
        return found

    key = sha256(case.own[job.name].encode() + np.sort(case.sweep.frequency).tobytes()).hexdigest()
    return kept_or_made(store, curves_of(job.name, store.units if store else METRES), key, made)
