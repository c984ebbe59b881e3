"""Run a case: every fidelity through the same frequencies, kept on disk as it goes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, fields
from pathlib import Path
from threading import Event, Lock
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from vibeam.faults import CaseError, Fault
from vibeam.response import Branches, FrequencyResponse
from vibeam.solvers import knows_curves, solver
from vibeam.spread import Stopped, spread
from vibeam.store.branch import Branch, Kept
from vibeam.store.file import opened
from vibeam.store.store import Store
from vibeam.sweep import march

if TYPE_CHECKING:
    from vibeam.accuracy.study import Study
    from vibeam.case import Case
    from vibeam.fidelity import Fidelity
    from vibeam.motions import MotionCurves
    from vibeam.plans import AccuracyPlan
    from vibeam.show.plan import Sheet
    from vibeam.state import State
    from vibeam.system import ImpactSystem

WRITE_EVERY = 0.2  # seconds: a write costs as much as many points, and a killed run loses no more than this
Progress = Callable[[int, int], None]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C: the message says what is kept and how to go on."""


class Result(Mapping[str, Branches]):
    """What a run gives: ``result[fidelity].up.amplitude``; ``found`` points of ``total`` were in the file already.

    ``shown``: the numbers of the case's [show.NAME] tables, by name. ``accuracy``: where the case asks for one, what
    was chosen and whether it holds; the one entry is then ``result["accuracy"]``.
    """

    def __init__(
        self,
        case: Case,
        branches: Mapping[str, Branches],
        path: Path | None = None,
        found: int = 0,
        shown: Mapping[str, tuple[Sheet, ...]] | None = None,
        accuracy: Study | None = None,
    ) -> None:
        self.case = case
        self.path = path
        self.found = found
        self.shown = dict(shown or {})
        self.accuracy = accuracy
        self._branches = dict(branches)

    @property
    def total(self) -> int:
        """Points of all branches."""
        return sum(len(response) for branches in self.values() for _, response in branches.items())

    @property
    def curves(self) -> dict[str, MotionCurves]:
        """All motions, unstable ones too, of each fidelity whose solver knows them."""
        return {name: branches.curves for name, branches in self._branches.items() if branches.curves is not None}

    def __getitem__(self, fidelity: str) -> Branches:
        return self._branches[fidelity]

    def __iter__(self) -> Iterator[str]:
        return iter(self._branches)

    def __len__(self) -> int:
        return len(self._branches)


@dataclass(frozen=True)
class _Job:
    """One fidelity: its branches in the order in which they are swept, each with what is there of it."""

    name: str
    system: ImpactSystem
    fidelity: Fidelity
    branches: tuple[tuple[Branch, Kept], ...]


def run(case: Case, out: str | Path | None = None, progress: Progress | None = None, show: bool = True) -> Result:
    """Sweep every fidelity of ``case``; what the results file ``out`` already holds is not computed again.

    Where the case asks for an accuracy it is one curve, ``result["accuracy"]``, in place of one for each fidelity.
    ``out=None`` keeps nothing on disk. ``progress(done, total)`` is called with the points that are there at the start
    and after each further one, from any thread. ``show``: whether to make what the case shows beside its curves.
    CaseError for a fidelity that cannot be built, StoreError where ``out`` cannot be used, Interrupted on Ctrl-C.
    """
    systems = _systems(case)
    plan = {name: _branches(case, name, system.size) for name, system in systems.items()}
    path = None if out is None else Path(out)
    if case.accuracy is not None:
        return _accurate(case, case.accuracy, systems, plan, path, progress or _silent, show)
    with _place(case, path, plan) as store:
        jobs = [_job(case, name, systems[name], branches, store) for name, branches in plan.items()]
        count = _Count(jobs, progress)
        found = count.done
        try:
            costly_first = sorted(jobs, key=lambda job: -job.system.size)
            spread(lambda job, stop: _sweep(case, job, store, count, stop), costly_first)
            curves = {job.name: _curves(case, job, store) for job in jobs if knows_curves(job.fidelity.solver)}
            shown = _shown(case, store) if show else {}
        except KeyboardInterrupt:
            raise Interrupted(_how_to_go_on(count, path)) from None
    return Result(case, {job.name: _gathered(job, curves.get(job.name)) for job in jobs}, path, found, shown)


def _silent(done: int, total: int) -> None:
    """No progress."""


def _accurate(
    case: Case, wanted: AccuracyPlan, systems: Mapping[str, ImpactSystem], plan: Mapping[str, tuple[Branch, ...]],
    path: Path | None, progress: Progress, show: bool,
) -> Result:  # fmt: skip
    """One curve within an accuracy instead of one for each fidelity."""
    from vibeam.accuracy import run as accuracy
    from vibeam.accuracy.keep import HOME

    accuracy.refuse_beyond(case, systems)
    branches = accuracy.branches_of(case, plan)
    total = sum(len(branch.frequency) for branch in branches)
    with _place(case, path, {HOME: branches}) as store:
        try:
            kept = [store.restore(branch).done for branch in branches] if store else [0]
            progress(total if sum(kept) == total else 0, total)
            study, found = accuracy.found_or_made(case, wanted, systems, branches, store)
            progress(total, total)
            shown = _shown(case, store) if show else {}
        except KeyboardInterrupt:
            raise Interrupted(f"stopped: nothing is kept of its {total} points") from None
    up, down = (study.curves[way].response if way in study.curves else None for way in ("up", "down"))
    return Result(case, {HOME: Branches(up, down)}, path, found, shown, study)


def _shown(case: Case, store: Store | None) -> dict[str, tuple[Sheet, ...]]:
    """What the case shows beside its curves, from the file where it is there."""
    found: dict[str, tuple[Sheet, ...]] = {}
    for name, plan in case.shows.items():
        from vibeam.show.plan import sheets

        kept = store.shown(plan) if store else None
        found[name] = sheets(case, plan) if kept is None else kept
        if store and kept is None:
            store.show(plan, found[name], output_unit(case))
    return found


def _systems(case: Case) -> dict[str, ImpactSystem]:
    """The system of every fidelity; CaseError names all that cannot be built or that their solver cannot take."""
    systems, faults = {}, []
    slowest = 2 * np.pi * float(np.min(case.sweep.frequency))
    for name, fidelity in case.fidelities.items():
        try:
            systems[name] = case.system(name)
            solver(fidelity.solver, systems[name], slowest, 0.0, **fidelity.options)
        except ValueError as error:
            faults.append(Fault(str(case.path), None, f"fidelity.{name}", str(error)))
    for name in case.fidelities:
        try:
            case.amplitude_of(name, 2 * np.pi * case.sweep.frequency)
        except ValueError as error:
            faults.append(Fault(str(case.path), None, "platform", str(error)))
    if faults:
        raise CaseError(faults)
    return systems


class _Count:
    """Points done of all fidelities, told as they come."""

    def __init__(self, jobs: list[_Job], progress: Progress | None) -> None:
        kept = [kept for job in jobs for _, kept in job.branches]
        self._lock = Lock()
        self._progress = progress or _silent
        self.done = sum(part.done for part in kept)
        self.total = sum(len(part.response) for part in kept)
        self._progress(self.done, self.total)

    def add(self, points: int) -> None:
        with self._lock:
            self.done += points
            self._progress(self.done, self.total)


def _branches(case: Case, name: str, modes: int) -> tuple[Branch, ...]:
    up = np.sort(case.sweep.frequency)
    grids = {"up": up, "down": up[::-1].copy()}
    wanted = ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,)
    return tuple(Branch(name, direction, grids[direction], modes) for direction in wanted)


def _place(
    case: Case, path: Path | None, plan: Mapping[str, tuple[Branch, ...]]
) -> AbstractContextManager[Store | None]:
    if path is None:
        return nullcontext()
    branches = [branch for several in plan.values() for branch in several]
    return opened(path, text=case.numbers, key=case.key, branches=branches, unit=output_unit(case))


def _job(case: Case, name: str, system: ImpactSystem, branches: tuple[Branch, ...], store: Store | None) -> _Job:
    kept = tuple((branch, store.restore(branch) if store else _nothing(branch)) for branch in branches)
    return _Job(name, system, case.fidelities[name], kept)


def _nothing(branch: Branch) -> Kept:
    return Kept(FrequencyResponse.empty(branch.frequency, branch.modes), 0, None)


def _sweep(case: Case, job: _Job, store: Store | None, count: _Count, stop: Event) -> None:
    """All branches of one fidelity, the state carried from each to the next."""
    carried: State | None = None
    struck = 0
    for branch, kept in job.branches:
        recorder = _Recorder(branch, kept, store)
        start = kept.state if kept.done else carried
        carried = start
        try:
            for block, carried in _march(case, job, kept, start, struck):
                recorder.add(block, carried)
                count.add(len(block))
                if stop.is_set():
                    raise Stopped
        finally:
            recorder.write()
        struck += int(kept.response.impacts.sum())


def _march(
    case: Case, job: _Job, kept: Kept, state: State | None, struck: int
) -> Iterator[tuple[FrequencyResponse, State]]:
    """The points that are missing; ``struck`` impacts were in the branches before this one."""
    from vibeam.fidelity import gap_drift, gap_wear

    scene = case.scene_of(job.name)
    plan, omega = case.sweep, kept.response.omega[kept.done :]
    if not len(omega):
        return iter(())
    return march(
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
        struck=struck + int(kept.response.impacts[: kept.done].sum()),
    )


class _Recorder:
    """Puts points into a branch's response as they come, and into the file every ``WRITE_EVERY`` seconds."""

    def __init__(self, branch: Branch, kept: Kept, store: Store | None) -> None:
        self._branch, self._response, self._store = branch, kept.response, store
        self._done = self._written = kept.done
        self._state = kept.state
        self._due = monotonic() + WRITE_EVERY

    def add(self, block: FrequencyResponse, state: State) -> None:
        points = slice(self._done, self._done + len(block))
        for field in fields(FrequencyResponse):
            if field.name != "frequency":  # the grid's own value stays, to the last bit
                getattr(self._response, field.name)[points] = getattr(block, field.name)
        self._done, self._state = points.stop, state
        if monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        if self._store and self._state is not None and self._done > self._written:
            block = _part(self._response, slice(self._written, self._done))
            self._store.write(self._branch, self._written, block, self._state)
        self._written, self._due = self._done, monotonic() + WRITE_EVERY


def _part(response: FrequencyResponse, points: slice) -> FrequencyResponse:
    return FrequencyResponse(**{field.name: getattr(response, field.name)[points] for field in fields(response)})


def _curves(case: Case, job: _Job, store: Store | None) -> MotionCurves:
    """All motions that the fidelity's solver knows at the sweep's frequencies: from the file where it has them."""
    there = store.curves(job.name) if store else None
    if there is not None:
        return there
    omega = 2 * np.pi * np.sort(case.sweep.frequency)
    made = solver(job.fidelity.solver, job.system, float(omega[0]), 0.0, **job.fidelity.options)
    found: MotionCurves = made.curves(omega, case.amplitude_of(job.name, omega), case.sweep.output)
    if store:
        store.write_curves(job.name, found, output_unit(case))
    return found


def _gathered(job: _Job, curves: MotionCurves | None) -> Branches:
    return Branches(**{branch.direction: kept.response for branch, kept in job.branches}, curves=curves)


def _how_to_go_on(count: _Count, path: Path | None) -> str:
    if path is None or not count.done:
        return f"stopped after {count.done} of {count.total} points: nothing is kept"
    return f"stopped: {count.done} of {count.total} points are kept in {path}: the same command goes on from there"


def output_unit(case: Case) -> str:
    """Unit of the outputs: metres, or none where the model is nondimensional."""
    from vibeam_models.scene import SdofScene

    return "1" if isinstance(case.scene, SdofScene) else "m"
