"""Run of a case: every fidelity through the same frequencies, stored on disk during the run."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import units_of_output
from vibeam.runs.fidelity_sweep import Count, Job, Progress, job_of, known_curves, sweep_branches
from vibeam.runs.keys import branch_key, comparison_key, model_key
from vibeam.runs.overview import Overview, overview_of
from vibeam.runs.parallel import run_parallel
from vibeam.runs.result import Result, output_units
from vibeam.runs.store.branch import Branch
from vibeam.runs.store.file import Tell, opened
from vibeam.runs.store.models import Keyed
from vibeam.runs.store.reuse import Wanted
from vibeam.runs.store.store import Store
from vibeam.runs.systems import ModelProperties, Systems, properties_of
from vibeam.solvers import SOLVERS
from vibeam.solvers.steady import warm_up
from vibeam.system.response import Branches

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import AccuracyPlan
    from vibeam.figures.sheet import Sheet
    from vibeam.runs.estimate.records import FidelityEstimate
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.state import StatesAfter


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
    before: Callable[[Overview], None] | None = None,
    compare: bool = False,
) -> Result:
    """Sweep every fidelity of ``case``; points already in the results file ``out`` are not computed again.

    Branches whose numbers the case does not change are kept, the others are swept anew, unless that would leave fewer
    points: ``tell`` gets one line that names them, a warning does without it. ``fresh``: keep nothing of the file.
    ``before`` gets the overview of rig and sweep where there is something to sweep.

    Where the case asks for an accuracy it is one curve, ``result["accuracy"]``, in place of one for each fidelity.
    ``out=None`` keeps nothing on disk. ``progress(done, total)`` is called with the points that are there at the start
    and after each further block of them, from any thread. ``show``: compute the data of the case's further figures.
    ``compare``: compare the fidelities with the finest under both choices of the restitution held, and that with its
    own limit (``result.comparisons``), and estimate the error of each against the full model of its scene
    (``result.estimates``); the file gets both too.
    CaseError for a fidelity that cannot be built, StoreError where ``out`` cannot be used, Interrupted on Ctrl-C.
    """
    systems, storage = Systems(case), _Storage(None if out is None else Path(out), fresh, tell)
    if case.accuracy is not None:
        return _accurate(case, case.accuracy, systems, storage, progress or _no_progress, show, compare, before)
    with storage.opened(case, systems, _all_branches) as (store, plan):
        jobs = [job_of(case, name, systems, branches, store) for name, branches in plan.branches.items()]
        models = plan.models or _properties(case, systems)
        if before and any(job.missing for job in jobs):
            before(overview_of(case, models))
        count = Count((kept for job in jobs for _, kept in job.branches), progress or _no_progress)
        found = count.done
        try:
            _sweep(case, [job for job in jobs if job.missing], store, count)
            curves = {job.name: known_curves(case, job, store) for job in jobs if SOLVERS[job.fidelity.solver].curves}
            shown = _shown(case, store) if show else {}
            branches = {job.name: job.gathered(curves.get(job.name)) for job in jobs}
            _keep_models(case, models, store)
            result = Result(case, branches, storage.path, found, shown, models=models)
            if not compare:
                return result
            result.estimates = _estimated(result, systems, {job.name: job.after for job in jobs}, store)
            return _compared(result, result.finest, systems, store)
        except KeyboardInterrupt:
            raise Interrupted(_how_to_go_on(count, storage.path)) from None


def _sweep(case: Case, jobs: Sequence[Job], store: Store | None, count: Count) -> None:
    """Sweep the missing points of ``jobs``, several at once."""
    for job in jobs:
        _warm_up(case, job)
    if jobs:
        costly_first = sorted(jobs, key=lambda job: -job.system.size)
        run_parallel(lambda job, stop: sweep_branches(case, job, store, count, stop), costly_first)


def _properties(case: Case, systems: Mapping[str, ImpactSystem]) -> Mapping[str, ModelProperties]:
    """Properties of all models."""
    return {name: properties_of(case, name, system) for name, system in systems.items()}


def _keep_models(case: Case, models: Mapping[str, ModelProperties], store: Store | None) -> None:
    """Keep the properties of all models in the file."""
    keys = {name: model_key(case, name) for name in models}
    if store and all(keys.values()):
        store.write_models({name: (keys[name], properties) for name, properties in models.items()})


def _compared(
    result: Result, finest: Mapping[str, str], systems: Mapping[str, ImpactSystem], store: Store | None
) -> Result:
    """The result with its comparisons, which the file keeps."""
    branches = {} if result.accuracy is not None else result
    if all(name == top for name, top in finest.items()):
        return result
    key = comparison_key(result.case, finest, branches) if store else ""
    stored = store.comparisons(key) if store else None
    if stored is not None:
        result.comparisons = stored
        return result
    from vibeam.runs.comparison.held_comparison import comparisons

    result.comparisons = comparisons(result.case, finest, systems, branches)
    if store:
        store.write_comparisons(key, result.comparisons)
    return result


def _estimated(
    result: Result, systems: Mapping[str, ImpactSystem], after: Mapping[str, Mapping[str, StatesAfter]],
    store: Store | None,
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Errors of all fidelities against the full models of their scenes, estimated, which the file keeps."""
    key = comparison_key(result.case, dict.fromkeys(result.case.fidelities, "full model"), result) if store else ""
    stored = store.estimates(key) if store else None
    if stored is not None:
        return stored
    from vibeam.runs.estimate.of_case import estimate_of_choice, estimates

    study = result.accuracy
    if study is not None:
        found = {next(iter(result)): estimate_of_choice(result.case, systems, study.curves)}
    else:
        found = estimates(result.case, systems, result, after)
    if store:
        store.write_estimates(key, found)
    return found


def _warm_up(case: Case, job: Job) -> None:
    """Run the solver of a fidelity with missing points once, unmeasured: here Ctrl-C can stop a compilation."""
    omega = job.branches[0][1].response.omega[:1]
    base = float(np.ravel(case.amplitude_of(job.name, omega))[0])
    fidelity = job.fidelity
    warm_up(fidelity.solver, job.system, float(omega[0]), base, case.sweep.output, fidelity.options)


def _no_progress(done: int, total: int) -> None:
    """Progress callback that does nothing."""


def _accurate(
    case: Case, wanted: AccuracyPlan, systems: Mapping[str, ImpactSystem], storage: _Storage, progress: Progress,
    show: bool, compare: bool, before: Callable[[Overview], None] | None,
) -> Result:  # fmt: skip
    """One curve within an accuracy instead of one for each fidelity."""
    from vibeam.runs import within_accuracy as accuracy
    from vibeam.runs.store.accuracy import HOME

    with storage.opened(case, systems, accuracy.branches_of) as (store, plan):
        branches = accuracy.branches_of(case, plan.branches)
        total = sum(len(branch.frequency) for branch in branches)
        try:
            kept = [store.restore(branch).done for branch in branches] if store else [0]
            models = plan.models or _properties(case, systems)
            if before and sum(kept) < total:
                before(overview_of(case, models))
            progress(total if sum(kept) == total else 0, total)
            study, found = accuracy.found_or_made(case, wanted, systems, branches, store)
            progress(total, total)
            shown = _shown(case, store) if show else {}
            up, down = (study.curves[way].response if way in study.curves else None for way in ("up", "down"))
            _keep_models(case, models, store)
            result = Result(case, {HOME: Branches(up, down)}, storage.path, found, shown, study, models=models)
            if not compare:
                return result
            result.estimates = _estimated(result, systems, {}, store)
            return _compared(result, _references(case, study.finest), systems, store)
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
            store.show(plan, found[name], units_of_output(case, plan.output))
    return found


@dataclass(frozen=True)
class _Plan:
    """Branches of every fidelity; properties of their ``models`` where the file has them of this case and code."""

    branches: Mapping[str, tuple[Branch, ...]]
    models: Mapping[str, ModelProperties]


def _plan(case: Case, systems: Mapping[str, ImpactSystem], stored: Keyed) -> _Plan:
    """Plan of a run by what the file has ``stored`` of its models, else by their systems."""
    keys = {name: model_key(case, name) for name in case.fidelities}
    fit = all(key and stored.get(name, ("", None))[0] == key for name, key in keys.items())
    models = {name: stored[name][1] for name in keys} if fit else {}
    sizes = {name: models[name].modes if fit else systems[name].size for name in keys}
    return _Plan({name: _branches(case, name, modes) for name, modes in sizes.items()}, models)


def _branches(case: Case, name: str, modes: int) -> tuple[Branch, ...]:
    up = np.sort(case.sweep.frequency)
    grids = {"up": up, "down": up[::-1].copy()}
    wanted = ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,)
    keys = {direction: branch_key(case.own[name], direction, up, after_up=len(wanted) > 1) for direction in wanted}
    return tuple(Branch(name, direction, grids[direction], modes, keys[direction]) for direction in wanted)


def _all_branches(case: Case, branches: Mapping[str, tuple[Branch, ...]]) -> tuple[Branch, ...]:
    return tuple(branch for several in branches.values() for branch in several)


Select = Callable[["Case", Mapping[str, tuple[Branch, ...]]], tuple[Branch, ...]]


@dataclass(frozen=True)
class _Storage:
    """Storage of a run: the results file (None: nowhere), and how it is opened."""

    path: Path | None
    fresh: bool
    tell: Tell | None

    @contextmanager
    def opened(
        self, case: Case, systems: Mapping[str, ImpactSystem], select: Select
    ) -> Iterator[tuple[Store | None, _Plan]]:
        """Open the file for the branches that ``select`` takes of the plan, and make the plan."""
        if self.path is None:
            yield None, _plan(case, systems, {})
            return

        def wanted(stored: Keyed) -> Wanted:
            branches = select(case, _plan(case, systems, stored).branches)
            return Wanted(case.numbers, case.key, case.shared, branches, output_units(case), case.text)

        with opened(self.path, wanted, fresh=self.fresh, tell=self.tell or _warn) as store:
            yield store, _plan(case, systems, store.models)


def _warn(line: str) -> None:
    warnings.warn(line, stacklevel=2)


def _how_to_go_on(count: Count, path: Path | None) -> str:
    if path is None or not count.done:
        return f"stopped after {count.done} of {count.total} points: nothing is kept"
    return f"stopped: {count.done} of {count.total} points are kept in {path}: the same command goes on from there"
