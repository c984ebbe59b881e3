"""Verdict on a case: how much model it needs, in stages, the cheap ones first.

``modes``: how many suffice, from closed forms as far as they go; ``effects``: which ones the scene needs; ``solvers``:
error against time; ``map``: where on the plane of the drive frequency and another key each fidelity suffices; further
ones of extensions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import process_time
from typing import Any

from vibeam.case.case import Case
from vibeam.case.source import of_source
from vibeam.case.study_plans import FURTHER_STAGES, STAGES, USUAL_STAGES, ModesNeededPlan, VerdictPlan
from vibeam.casefile.tables.table import plan_with
from vibeam.exchange.faults import CaseError, suggest
from vibeam.maps.axes import axes_over
from vibeam.studies.cost.study import cost
from vibeam.studies.effects import influence
from vibeam.studies.fidelity_map.study import fidelity_map
from vibeam.studies.modes_needed import modes_needed
from vibeam.studies.variants import require_usual
from vibeam.system.labelled import ViewedTable
from vibeam.system.progress import telling
from vibeam_models.registry import loaded

Tell = Callable[[str], None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Stage:
    """One stage of a verdict: the record of its study, or ``why`` there is none; its CPU time in s.

    >>> import vibeam
    >>> vibeam.studies.Stage("modes", None, 0.0, "there is no beam").why
    'there is no beam'
    """

    name: str
    record: Any
    cpu_seconds: float
    why: str = ""


@dataclass(frozen=True, eq=False)
class Verdict(ViewedTable):
    """Verdict on a case by a ``plan``: its ``stages`` in their order.

    >>> import vibeam
    >>> vibeam.Verdict(case=None, plan=None, stages=(vibeam.studies.Stage("modes", 2, 0.1),))["modes"]
    2
    """

    case: Case
    plan: VerdictPlan
    stages: tuple[Stage, ...]

    def __getitem__(self, name: str) -> Any:
        """Record of a stage; KeyError where it was not asked for, ValueError with the reason where it has none."""
        found = {stage.name: stage for stage in self.stages}
        if name not in found:
            raise KeyError(f"no stage {name!r}: there are {', '.join(found)}")
        if found[name].why:
            raise ValueError(found[name].why)
        return found[name].record


@of_source
def verdict(
    case: Case,
    /,
    plan: VerdictPlan | None = None,
    *,
    tell: Tell | None = None,
    progress: Progress | bool | None = None,
    **settings: Any,
) -> Verdict:
    """Verdict on a case: ``vibeam.verdict(case, accuracy="1 %", only=["modes", "effects"])``.

    ``plan``: None as the case has it; ``settings``: its fields, in SI or with units. ``tell`` hears what a user should
    know, ``progress`` the points done and their total, from any thread. ValueError for settings outside their range,
    and where the only stage asked for cannot be had; CaseError for values that the case may not have.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", set={"modes_needed.most": 3, "sweep.frequency.points": 9})
    >>> vibeam.verdict(case, only="modes")["modes"].enough.modes
    2
    """
    asked = plan_with(plan or case.asked["verdict"], settings)
    if case.record is None:
        require_plane(case, asked)
    return Verdict(case, asked, tuple(_stage(name, case, asked, tell, progress) for name in _names(case, asked)))


def require_plane(case: Case, plan: VerdictPlan) -> None:
    """ValueError where the second key of the plane is no key that a case has: before the stages in front of the map."""
    if "map" in plan.only and plan.over != VerdictPlan.over:
        try:
            axes_over(case, plan.over, None, None, (plan.points,), next(iter(case.fidelities)))
        except ValueError as fault:
            if not str(fault).startswith("--from"):
                raise
            cure = f"vibeam map CASE --picture verdict --over {plan.over} --from … --to …"
            raise ValueError(f"--over: {plan.over} has no usual range: {cure} takes one") from None


def _names(case: Case, plan: VerdictPlan) -> list[str]:
    unknown = [name for name in plan.only if name not in STAGES]
    if unknown:
        raise ValueError("; ".join(f"only: no stage {name!r}; {suggest(name, STAGES)}" for name in unknown))
    solid = any(case.scene_of(name).in_three_dimensions for name in case.fidelities)
    usual = solid and tuple(plan.only) == USUAL_STAGES
    joins = [name for name, each in FURTHER_STAGES.items() if usual and each.spatial]
    return [name for name in STAGES if name in (*plan.only, *joins)]


def _stage(name: str, case: Case, plan: VerdictPlan, tell: Tell | None, progress: Progress | bool | None) -> Stage:
    begun = process_time()
    try:
        record, why = _record(name, case, plan, tell, progress), ""
    except CaseError:
        raise
    except ValueError as refusal:
        if len(plan.only) == 1:
            raise
        record, why = None, str(refusal)
    return Stage(name, record, process_time() - begun, why)


def _record(name: str, case: Case, plan: VerdictPlan, tell: Tell | None, progress: Progress | bool | None) -> Any:
    if name in FURTHER_STAGES:
        return loaded(FURTHER_STAGES[name].run)(case, plan, progress)
    if case.record is not None:
        require_usual("verdict", plan, "over", "points")
    if name == "effects":
        return influence(case, progress, budget=plan.allowed)
    if case.record is not None:
        return _under_record(name, case, plan, progress)
    if name == "modes":
        with telling(progress, name) as told:
            return modes_needed(case, plan_of_modes(case, plan), budget=plan.allowed, told=told)
    if name == "solvers":
        return cost(case, tell, progress, budget=plan.budget)
    return fidelity_map(
        case, plan.over, points=plan.points, frequencies=plan.points, accuracy=plan.accuracy,
        progress=progress, budget=plan.allowed, frequency_accuracy=plan.frequency_accuracy,
    )  # fmt: skip


def _under_record(name: str, case: Case, plan: VerdictPlan, progress: Progress | bool | None) -> Any:
    """Record of a stage of a case under a record, of ``map`` its run; ValueError for the stage that it has not."""
    from vibeam.runs.transient.run import run_record
    from vibeam.studies.record.modes import record_modes

    if name == "solvers":
        raise ValueError("the solvers' errors are of steady motions; vibeam run says the CPU time of every fidelity")
    with telling(progress, name) as told:
        if name == "modes":
            return record_modes(case, ModesNeededPlan(plan.accuracy, plan.frequency_accuracy), told, plan.allowed)
        result = run_record(case, None, told, False, lambda line: None)
    if not result.comparison:
        raise ValueError("fewer than two fidelities of one rig: there is none to compare with the finest")
    return result


def plan_of_modes(case: Case, plan: VerdictPlan) -> ModesNeededPlan:
    """Plan of the stage ``modes``: that of the case, with the accuracy of the verdict."""
    own: ModesNeededPlan = case.asked["modes_needed"]
    return replace(own, accuracy=plan.accuracy, frequency_accuracy=plan.frequency_accuracy or own.frequency_accuracy)
