"""Run of a case: every fidelity through the same frequencies, stored on disk during the run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.case import Case
from vibeam.case.source import of_source
from vibeam.runs.fidelity_sweep import Job, Progress, job_of, known_curves, sweep_branches
from vibeam.runs.keys import comparison_key, kept_or_made, model_key
from vibeam.runs.parallel import PointCount, heartbeat, run_parallel
from vibeam.runs.result import Result
from vibeam.runs.run_plan import planned, restricted
from vibeam.runs.store.figures import shown_of
from vibeam.runs.store.file import Store
from vibeam.runs.store.records import COMPARED, COMPARISONS
from vibeam.runs.systems import ModelProperties, Overview, Systems, overview_of, properties_of
from vibeam.solvers import SOLVERS
from vibeam.solvers.steady import warm_up
from vibeam.store.place import Tell, warn
from vibeam.system.progress import telling

if TYPE_CHECKING:
    from vibeam.runs.comparison.differences import HeldComparison
    from vibeam.runs.comparison.errors import ComparedFidelity
    from vibeam.runs.transient.result import TransientResult


@of_source
def run(
    case: Case,
    out: str | Path | None = None,
    progress: Progress | bool | None = None,
    show: bool = True,
    *,
    fresh: bool = False,
    tell: Tell | None = None,
    before: Callable[[Overview], None] | None = None,
    compare: bool = False,
    fidelities: Collection[str] = (),
) -> Result | TransientResult:
    """Sweep every fidelity of ``case``; points already in the results file ``out`` are not computed again.

    A case with [record] gives a ``TransientResult``: every fidelity flies under the same loads, motions take the place
    of points, and the fidelities are compared in any case. Another one gives a ``Result``.

    Branches whose numbers the case does not change are kept, the others are swept anew; where that would lose points,
    the file as it was is kept aside, ``OUT.1.h5``. ``tell`` gets one line on that, a warning does without it.
    ``fresh``: keep nothing of the file.
    ``before`` gets the overview of rig and sweep where there is something to sweep.

    ``out=None`` keeps nothing on disk. ``progress``: True shows a bar; a function is called with the points that are
    there, at the start and after each further block of them, and their total, from any thread. ``show``: compute the
    data of the case's further figures.
    ``fidelities``: these alone; the others can be added to the same file later.
    ``compare``: make ``result.compare()`` and the peaks under both choices of the restitution held
    (``result.comparisons``) at once; the file gets both too.
    CaseError for a fidelity that cannot be built; ValueError for one that there is not; StoreError where ``out`` cannot
    be used, Interrupted on Ctrl-C.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3})
    >>> result = vibeam.run(case)
    >>> {name: round(1e3 * branches.peak.amplitude, 2) for name, branches in result.items()}  # mm, at 15.5 Hz
    {'sdof': 0.39, 'two_modes': 0.42, 'beam': 0.42}
    """
    case = restricted(case, fidelities)
    systems, path = Systems(case), None if out is None else Path(out)
    if case.record is not None:
        from vibeam.runs.transient.run import run_record

        with telling(progress, "flying") as told:
            return run_record(case, path, told, fresh, tell or warn, before, show)
    with planned(case, systems, path, fresh, tell) as (store, plan), telling(progress, "sweeping") as told:
        jobs = [job_of(case, name, systems, branches, store) for name, branches in plan.branches.items()]
        records = None if store and store.has(set(case.own) - set(case.fidelities)) else store  # theirs
        models = plan.models or {name: properties_of(case, name, system) for name, system in systems.items()}
        if before and any(job.missing for job in jobs):
            before(overview_of(case, models))
        parts = [kept for job in jobs for _, kept in job.branches]
        count = PointCount(sum(each.done for each in parts), sum(len(each.response) for each in parts), told)
        try:
            _sweep(case, jobs, store, count)
            curves = {job.name: known_curves(case, job, store) for job in jobs if SOLVERS[job.fidelity.solver].curves}
            shown = shown_of(case, partial(kept_or_made, records)) if show else {}
            branches = {job.name: job.gathered(curves.get(job.name)) for job in jobs}
            _keep_models(case, models, records)
            after = {job.name: job.after for job in jobs}
            result = Result(case, branches, path, sum(job.found for job in jobs), shown, models=models, after=after)
            if not compare:
                return result
            with heartbeat(tell, lambda: "comparing the fidelities"):
                result.compared = _compared(result, records)
                return _held(result, records)
        except KeyboardInterrupt:
            raise count.stopped(path) from None


def _sweep(case: Case, jobs: Sequence[Job], store: Store | None, count: PointCount) -> None:
    """Sweep the missing points of ``jobs``, several at once."""
    missing = [job for job in jobs if job.missing]
    for job in missing:
        _warm_up(case, job)
    if missing:
        costly_first = sorted(missing, key=lambda job: -job.system.size)
        run_parallel(lambda job, stop: sweep_branches(case, job, store, count, stop), costly_first)


def _keep_models(case: Case, models: Mapping[str, ModelProperties], store: Store | None) -> None:
    """Keep the properties of all models in the file."""
    keys = {name: model_key(case, name) for name in models}
    if store and all(keys.values()):
        store.keep_models({name: (keys[name], properties) for name, properties in models.items()})


def _compared(result: Result, store: Store | None) -> tuple[ComparedFidelity, ...]:
    """Comparisons of all fidelities, which the file keeps."""
    key = comparison_key(result.case, result.finest, result, repr(result.asked)) if store else ""
    return kept_or_made(store, COMPARED, key, result.compare)


def _held(result: Result, store: Store | None) -> Result:
    """The result with its peaks under both choices of the restitution held, which the file keeps."""
    finest = result.finest
    if all(name == top for name, top in finest.items()):
        return result

    def made() -> tuple[HeldComparison, ...]:
        from vibeam.runs.comparison.held_comparison import comparisons

        return comparisons(result.case, finest, result)

    key = comparison_key(result.case, finest, result) if store else ""
    result.comparisons = kept_or_made(store, COMPARISONS, key, made)
    return result


def _warm_up(case: Case, job: Job) -> None:
    """Run the solver of a fidelity with missing points once, unmeasured: here Ctrl-C can stop a compilation."""
    omega = job.branches[0][1].response.omega[:1]
    base = float(np.ravel(case.amplitude_of(job.name, omega))[0])
    fidelity = job.fidelity
    warm_up(fidelity.solver, job.system, float(omega[0]), base, case.sweep.output, fidelity.options)
