"""Run of a case: every fidelity through the same frequencies, stored on disk during the run."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.faults import CaseError, Fault
from vibeam.run.fidelity_sweep import Job, job_of, known_curves, sweep_branches
from vibeam.run.parallel import run_parallel
from vibeam.run.recorder import Count, Progress
from vibeam.run.result import Result, output_unit
from vibeam.run.store.branch import Branch
from vibeam.run.store.file import Tell, opened
from vibeam.run.store.reuse import Wanted
from vibeam.run.store.store import Store
from vibeam.solvers import SOLVERS, solver
from vibeam.solvers.warm_up import warm_up
from vibeam.system.response import Branches

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import AccuracyPlan
    from vibeam.figures.sheet import Sheet
    from vibeam.system.impact_system import ImpactSystem


class Interrupted(KeyboardInterrupt):
    """Run stopped by Ctrl-C: the message says what is kept and how to continue."""


def run(
    case: Case,
    out: str | Path | None = None,
    progress: Progress | None = None,
    show: bool = True,
    *,
    fresh: bool = False,
    tell: Tell | None = None,
    compare: bool = False,
) -> Result:
    """Sweep every fidelity of ``case``; points already in the results file ``out`` are not computed again.

    Branches whose numbers the case does not change are kept, the others are swept anew, unless that would leave fewer
    points: ``tell`` gets one line that names them, a warning does without it. ``fresh``: keep nothing of the file.

    Where the case asks for an accuracy it is one curve, ``result["accuracy"]``, in place of one for each fidelity.
    ``out=None`` keeps nothing on disk. ``progress(done, total)`` is called with the points that are there at the start
    and after each further block of them, from any thread. ``show``: compute the data of the case's further figures.
    ``compare``: compare the fidelities with the finest under both choices of the restitution held, and that with its
    own limit (``result.comparisons``); the file gets it too.
    CaseError for a fidelity that cannot be built, StoreError where ``out`` cannot be used, Interrupted on Ctrl-C.
    """
    systems = _systems(case)
    plan = {name: _branches(case, name, system.size) for name, system in systems.items()}
    path = None if out is None else Path(out)
    if case.accuracy is not None:
        return _accurate(
            case, case.accuracy, systems, plan, _Storage(path, fresh, tell), progress or _no_progress, show, compare
        )
    with _Storage(path, fresh, tell).opened(case, plan) as store:
        jobs = [job_of(case, name, systems[name], branches, store) for name, branches in plan.items()]
        count = Count((kept for job in jobs for _, kept in job.branches), progress or _no_progress)
        found = count.done
        try:
            for job in jobs:
                _warm_up(case, job)
            costly_first = sorted(jobs, key=lambda job: -job.system.size)
            run_parallel(lambda job, stop: sweep_branches(case, job, store, count, stop), costly_first)
            curves = {job.name: known_curves(case, job, store) for job in jobs if SOLVERS[job.fidelity.solver].curves}
            shown = _shown(case, store) if show else {}
            branches = {job.name: job.gathered(curves.get(job.name)) for job in jobs}
            result = Result(case, branches, path, found, shown)
            return _compared(result, result.finest, systems, store) if compare else result
        except KeyboardInterrupt:
            raise Interrupted(_how_to_go_on(count, path)) from None


def _compared(
    result: Result, finest: Mapping[str, str], systems: Mapping[str, ImpactSystem], store: Store | None
) -> Result:
    """The result with its comparisons, which the file keeps."""
    from vibeam.run.comparison.of_case import comparisons

    branches = {} if result.accuracy is not None else result
    result.comparisons = comparisons(result.case, finest, systems, branches)
    if store:
        store.write_comparisons(result.comparisons)
    return result


def _warm_up(case: Case, job: Job) -> None:
    """Run the solver of a fidelity with missing points once, unmeasured: here Ctrl-C can stop a compilation."""
    if all(kept.done == len(kept.response) for _, kept in job.branches):
        return
    omega = job.branches[0][1].response.omega[:1]
    base = float(np.ravel(case.amplitude_of(job.name, omega))[0])
    fidelity = job.fidelity
    warm_up(fidelity.solver, job.system, float(omega[0]), base, case.sweep.output, fidelity.options)


def _no_progress(done: int, total: int) -> None:
    """Progress callback that does nothing."""


def _accurate(
    case: Case, wanted: AccuracyPlan, systems: Mapping[str, ImpactSystem], plan: Mapping[str, tuple[Branch, ...]],
    storage: _Storage, progress: Progress, show: bool, compare: bool,
) -> Result:  # fmt: skip
    """One curve within an accuracy instead of one for each fidelity."""
    from vibeam.run import within_accuracy as accuracy
    from vibeam.run.store.accuracy import HOME

    accuracy.refuse_beyond(case, systems)
    branches = accuracy.branches_of(case, plan)
    total = sum(len(branch.frequency) for branch in branches)
    with storage.opened(case, {HOME: branches}) as store:
        try:
            kept = [store.restore(branch).done for branch in branches] if store else [0]
            progress(total if sum(kept) == total else 0, total)
            study, found = accuracy.found_or_made(case, wanted, systems, branches, store)
            progress(total, total)
            shown = _shown(case, store) if show else {}
            up, down = (study.curves[way].response if way in study.curves else None for way in ("up", "down"))
            result = Result(case, {HOME: Branches(up, down)}, storage.path, found, shown, study)
            return _compared(result, _references(case, study.finest), systems, store) if compare else result
        except KeyboardInterrupt:
            raise Interrupted(f"stopped: nothing is kept of its {total} points") from None


def _references(case: Case, finest: str) -> dict[str, str]:
    """Reference of each fidelity: the finest where it has the same physics, else itself."""
    own = case.fidelities
    return {name: finest if own[name].changes == own[finest].changes else name for name in own}


def _shown(case: Case, store: Store | None) -> dict[str, tuple[Sheet, ...]]:
    """Data of the case's further figures, from the file where stored."""
    found: dict[str, tuple[Sheet, ...]] = {}
    for name, plan in case.shows.items():
        from vibeam.figures.sheet import sheets

        kept = store.shown(plan) if store else None
        found[name] = sheets(case, plan) if kept is None else kept
        if store and kept is None:
            store.show(plan, found[name])
    return found


def _systems(case: Case) -> dict[str, ImpactSystem]:
    """System of every fidelity; CaseError names all that cannot be built or that their solver cannot take."""
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


def _branches(case: Case, name: str, modes: int) -> tuple[Branch, ...]:
    up = np.sort(case.sweep.frequency)
    grids = {"up": up, "down": up[::-1].copy()}
    wanted = ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,)
    keys = {direction: _key(case.own[name], direction, up, after_up=len(wanted) > 1) for direction in wanted}
    return tuple(Branch(name, direction, grids[direction], modes, keys[direction]) for direction in wanted)


def _key(own: str, direction: str, up: NDArray[np.float64], after_up: bool) -> str:
    """Key of all numbers of a branch beside the frequencies, the sweep's lowest frequency included."""
    start = up.tobytes() if direction == "down" and after_up else b"equilibrium"
    return sha256(b"\n".join((own.encode(), direction.encode(), up[:1].tobytes(), start))).hexdigest()


@dataclass(frozen=True)
class _Storage:
    """Storage of a run: the results file (None: nowhere), and how it is opened."""

    path: Path | None
    fresh: bool
    tell: Tell | None

    def opened(self, case: Case, plan: Mapping[str, tuple[Branch, ...]]) -> AbstractContextManager[Store | None]:
        if self.path is None:
            return nullcontext()
        branches = [branch for several in plan.values() for branch in several]
        wanted = Wanted(case.numbers, case.key, case.shared, branches, output_unit(case))
        return opened(self.path, wanted, fresh=self.fresh, tell=self.tell or _warn)


def _warn(line: str) -> None:
    warnings.warn(line, stacklevel=2)


def _how_to_go_on(count: Count, path: Path | None) -> str:
    if path is None or not count.done:
        return f"stopped after {count.done} of {count.total} points: nothing is kept"
    return f"stopped: {count.done} of {count.total} points are kept in {path}: the same command goes on from there"
