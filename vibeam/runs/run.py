"""Run of a case: every fidelity through the same frequencies, stored on disk during the run."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import units_of_output
from vibeam.exchange.faults import CaseError
from vibeam.runs.accuracy import AccuracyChoice, accuracy_choice, by_cost
from vibeam.runs.fidelity_sweep import Job, PointCount, Progress, job_of, known_curves, sweep_branches
from vibeam.runs.keys import branch_key, comparison_key, model_key
from vibeam.runs.overview import Overview, overview_of
from vibeam.runs.parallel import run_parallel
from vibeam.runs.result import Result, output_units
from vibeam.runs.store.adaptation import Requirements
from vibeam.runs.store.branches import BranchPlan
from vibeam.runs.store.figures import sheets_of
from vibeam.runs.store.file import Store, Tell, opened
from vibeam.runs.store.records import COMPARISONS, ESTIMATED, Keyed
from vibeam.runs.systems import ModelProperties, Systems, properties_of
from vibeam.solvers import SOLVERS
from vibeam.solvers.steady import warm_up
from vibeam.system.response import Branches

if TYPE_CHECKING:
    from vibeam.case.case import Case
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

    Where the case asks for an accuracy, fidelities are swept from the cheapest on until one is within it
    (``result.accuracy``); the others are not in the result.
    ``out=None`` keeps nothing on disk. ``progress(done, total)`` is called with the points that are there at the start
    and after each further block of them, from any thread. ``show``: compute the data of the case's further figures.
    ``compare``: compare the fidelities with the finest under both choices of the restitution held, and that with its
    own limit (``result.comparisons``), and estimate the error of each against the full model of its scene
    (``result.estimates``); the file gets both too.
    CaseError for a fidelity that cannot be built, or where none is within the accuracy; StoreError where ``out`` cannot
    be used, Interrupted on Ctrl-C.
    """
    systems, storage = Systems(case), _Storage(None if out is None else Path(out), fresh, tell)
    with storage.opened(case, systems) as (store, plan):
        names = list(plan.branches) if case.accuracy is None else by_cost(case, plan.modes)
        jobs = [job_of(case, name, systems, plan.branches[name], store) for name in names]
        known = _known_estimates(case, jobs, store)
        jobs = jobs[: len(known) or None]
        models = plan.models or _properties(case, systems)
        if before and any(job.missing for job in jobs):
            before(overview_of(case, models))
        count = PointCount((kept for job in jobs for _, kept in job.branches), progress or _no_progress)
        try:
            if case.accuracy is None:
                _sweep(case, jobs, store, count)
            else:
                known = known or _until_within(case, jobs, systems, store, count)
                jobs = jobs[: len(known)]
            curves = {job.name: known_curves(case, job, store) for job in jobs if SOLVERS[job.fidelity.solver].curves}
            shown = _shown(case, store) if show else {}
            branches = {job.name: job.gathered(curves.get(job.name)) for job in jobs}
            _keep_models(case, models, store)
            result = Result(case, branches, storage.path, sum(job.found for job in jobs), shown, models=models)
            if case.accuracy is not None:
                result.estimates, result.accuracy = known, _required(case, accuracy_choice(case, names, known))
            if not compare:
                return result
            result.estimates = known or _estimated(result, systems, {job.name: job.after for job in jobs}, store)
            return _compared(result, systems, store)
        except KeyboardInterrupt:
            raise Interrupted(_how_to_go_on(count, storage.path)) from None


def _sweep(case: Case, jobs: Sequence[Job], store: Store | None, count: PointCount) -> None:
    """Sweep the missing points of ``jobs``, several at once."""
    missing = [job for job in jobs if job.missing]
    for job in missing:
        _warm_up(case, job)
    if missing:
        costly_first = sorted(missing, key=lambda job: -job.system.size)
        run_parallel(lambda job, stop: sweep_branches(case, job, store, count, stop), costly_first)


def _known_estimates(case: Case, jobs: Sequence[Job], store: Store | None) -> dict[str, FidelityEstimate]:
    """Estimates in the file by which a fidelity is chosen already, from the cheapest to that one; empty without any."""
    if case.accuracy is None or store is None:
        return {}
    names = [job.name for job in jobs]
    for count in range(1, 1 + len(list(takewhile(lambda job: not job.missing, jobs)))):
        kept = store.kept(ESTIMATED, _estimates_key(case, {job.name: job.gathered() for job in jobs[:count]}))
        choice = accuracy_choice(case, names, kept) if kept else None
        if kept and choice and (choice.chosen or not choice.spared):
            return {each.fidelity: kept[each.fidelity] for each in choice.swept}
    return {}


def _until_within(
    case: Case, jobs: Sequence[Job], systems: Mapping[str, ImpactSystem], store: Store | None, count: PointCount
) -> dict[str, FidelityEstimate]:
    """Sweep ``jobs``, from the cheapest on, until one is within the case's accuracy; the estimates of those swept."""
    from vibeam.runs.estimate.of_case import estimates, full_model

    try:
        full_model(case.scene_of(jobs[0].name), 2 * np.pi * case.sweep.frequency)
    except ValueError as refusal:
        message = f"the error cannot be estimated ({refusal}): take this key away"
        raise CaseError([case.fault("accuracy", message=message)]) from None
    names = [job.name for job in jobs]
    found: dict[str, FidelityEstimate] = {}
    for job in jobs:
        _sweep(case, [job], store, count)
        found |= estimates(case, systems, {job.name: job.gathered()}, {job.name: job.after})
        if accuracy_choice(case, names, found).chosen:
            break
    count.end()
    if store:
        swept = {job.name: job.gathered() for job in jobs[: len(found)]}
        store.keep(ESTIMATED, _estimates_key(case, swept), found)
    return found


def _required(case: Case, choice: AccuracyChoice) -> AccuracyChoice:
    """The choice itself; CaseError where no fidelity is within the accuracy."""
    if not choice.chosen:
        raise CaseError([case.fault("accuracy", message=" ".join(choice.sentences()))])
    return choice


def _properties(case: Case, systems: Mapping[str, ImpactSystem]) -> Mapping[str, ModelProperties]:
    """Properties of all models."""
    return {name: properties_of(case, name, system) for name, system in systems.items()}


def _keep_models(case: Case, models: Mapping[str, ModelProperties], store: Store | None) -> None:
    """Keep the properties of all models in the file."""
    keys = {name: model_key(case, name) for name in models}
    if store and all(keys.values()):
        store.keep_models({name: (keys[name], properties) for name, properties in models.items()})


def _compared(result: Result, systems: Mapping[str, ImpactSystem], store: Store | None) -> Result:
    """The result with its comparisons, which the file keeps."""
    finest = result.finest
    if all(name == top for name, top in finest.items()):
        return result
    key = comparison_key(result.case, finest, result) if store else ""
    stored = store.kept(COMPARISONS, key) if store else None
    if stored is not None:
        result.comparisons = stored
        return result
    from vibeam.runs.comparison.held_comparison import comparisons

    result.comparisons = comparisons(result.case, finest, systems, result)
    if store:
        store.keep(COMPARISONS, key, result.comparisons or None)
    return result


def _estimates_key(case: Case, branches: Mapping[str, Branches]) -> str:
    """Key of the estimates of fidelities by their ``branches``, in the case's order."""
    ordered = {name: branches[name] for name in case.fidelities if name in branches}
    return comparison_key(case, dict.fromkeys(ordered, "full model"), ordered)


def _estimated(
    result: Result, systems: Mapping[str, ImpactSystem], after: Mapping[str, Mapping[str, StatesAfter]],
    store: Store | None,
) -> dict[str, FidelityEstimate]:  # fmt: skip
    """Errors of all fidelities against the full models of their scenes, estimated, which the file keeps."""
    key = _estimates_key(result.case, result) if store else ""
    stored = store.kept(ESTIMATED, key) if store else None
    if stored is not None:
        return stored
    from vibeam.runs.estimate.of_case import estimates

    found = estimates(result.case, systems, result, after)
    if store:
        store.keep(ESTIMATED, key, found)
    return found


def _warm_up(case: Case, job: Job) -> None:
    """Run the solver of a fidelity with missing points once, unmeasured: here Ctrl-C can stop a compilation."""
    omega = job.branches[0][1].response.omega[:1]
    base = float(np.ravel(case.amplitude_of(job.name, omega))[0])
    fidelity = job.fidelity
    warm_up(fidelity.solver, job.system, float(omega[0]), base, case.sweep.output, fidelity.options)


def _no_progress(done: int, total: int) -> None:
    """Progress callback that does nothing."""


def _shown(case: Case, store: Store | None) -> dict[str, tuple[Sheet, ...]]:
    """Data of the case's further figures, from the file where stored."""
    found: dict[str, tuple[Sheet, ...]] = {}
    for name, plan in case.shows.items():
        from vibeam.figures.sheet import sheets

        record = sheets_of(plan, units_of_output(case, plan.output))
        kept = store.kept(record, plan.key) if store else None
        found[name] = sheets(case, plan) if kept is None else kept
        if store and kept is None:
            store.keep(record, plan.key, found[name])
    return found


@dataclass(frozen=True)
class RunPlan:
    """Branches of every fidelity; properties of their ``models`` where the file has them of this case and code."""

    branches: Mapping[str, tuple[BranchPlan, ...]]
    models: Mapping[str, ModelProperties]

    @property
    def modes(self) -> dict[str, int]:
        """Number of modes of every fidelity."""
        return {name: several[0].modes for name, several in self.branches.items()}


def _plan(case: Case, systems: Mapping[str, ImpactSystem], stored: Keyed) -> RunPlan:
    """Plan of a run by what the file has ``stored`` of its models, else by their systems."""
    keys = {name: model_key(case, name) for name in case.fidelities}
    fit = all(key and stored.get(name, ("", None))[0] == key for name, key in keys.items())
    models = {name: stored[name][1] for name in keys} if fit else {}
    sizes = {name: models[name].modes if fit else systems[name].size for name in keys}
    return RunPlan({name: _branches(case, name, modes) for name, modes in sizes.items()}, models)


def _branches(case: Case, name: str, modes: int) -> tuple[BranchPlan, ...]:
    up = np.sort(case.sweep.frequency)
    grids = {"up": up, "down": up[::-1].copy()}
    wanted = ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,)
    keys = {direction: branch_key(case.own[name], direction, up, after_up=len(wanted) > 1) for direction in wanted}
    return tuple(BranchPlan(name, direction, grids[direction], modes, keys[direction]) for direction in wanted)


@dataclass(frozen=True)
class _Storage:
    """Storage of a run: the results file (None: nowhere), and how it is opened."""

    path: Path | None
    fresh: bool
    tell: Tell | None

    @contextmanager
    def opened(self, case: Case, systems: Mapping[str, ImpactSystem]) -> Iterator[tuple[Store | None, RunPlan]]:
        """Open the file for all branches of the case, and make the plan."""
        if self.path is None:
            yield None, _plan(case, systems, {})
            return

        def wanted(stored: Keyed) -> Requirements:
            branches = [each for several in _plan(case, systems, stored).branches.values() for each in several]
            return Requirements(case.numbers, case.key, case.shared, branches, output_units(case), case.text)

        with opened(self.path, wanted, fresh=self.fresh, tell=self.tell or _warn) as store:
            yield store, _plan(case, systems, store.models)


def _warn(line: str) -> None:
    warnings.warn(line, stacklevel=2)


def _how_to_go_on(count: PointCount, path: Path | None) -> str:
    if path is None or not count.done:
        return f"stopped after {count.done} of {count.total} points: nothing is kept"
    return f"stopped: {count.done} of {count.total} points are kept in {path}: the same command goes on from there"
