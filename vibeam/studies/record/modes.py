"""Number of modes that a case needs under a record: motions of 1, 2, 3 … modes beside twice those of its fidelity."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from vibeam.case.case import plan_of_record
from vibeam.runs.comparison.beyond import is_whole
from vibeam.runs.comparison.errors import GIVEN, Asked, ComparedFidelity
from vibeam.studies.changes import changes, limits_of_record
from vibeam.studies.modes_needed import FIRST, STEPS, ModesNeeded, ModesTried
from vibeam.studies.variants import Told, ensembles, plain_finest, usual_numbers, within

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.study_plans import ModesNeededPlan

MORE = "no more than twice those of {} are computed under a record"
BEYOND = 2  # the reference has so many times the modes of the fidelity


def record_modes(case: Case, plan: ModesNeededPlan, told: Told | None = None, budget: float = inf) -> ModesNeeded:
    """Number of modes that suffice under a record, of the finest fidelity that changes nothing of the rig.

    ``budget``: CPU seconds, about, by which realisations are left out. ValueError where its number of modes is no key
    of it, or where it has one alone.
    """
    name, asked = plain_finest(case), Asked.of(plan.accuracy, plan.frequency_accuracy)
    own, whole, numbers = case.fidelities[name], case.alone(name), usual_numbers(case)
    if own.modes is None:
        raise ValueError(f'fidelity {name}: reduction = "{own.reduction}" says its modes itself: take one with modes')
    wanted = max(BEYOND * own.modes, FIRST)
    most = whole.model(name).most_modes
    top = min(most or wanted, wanted)
    counts = [*(count for count in STEPS if count < top), top]
    if len(counts) < 2:
        raise ValueError(f"fidelity {name}: its rig has {top} mode: there are no fewer to compare with")
    of = f"fidelity.{name}.modes"
    chosen = within(whole.with_keys({of: top}), name, budget, sum(counts) / top)
    *fewer, reference = ensembles([(chosen.with_keys({of: count}), name) for count in counts], numbers, told)
    allowed = limits_of_record(asked, numbers)
    rows = tuple(
        ModesTried(changes(reference, each, limits=allowed), modes=each.modes, seconds=float(each.seconds.mean()))
        for each in fewer
    )
    scene: Any = case.scene_of(name)
    every = is_whole(whole, name, top)
    why = "" if every else MORE.format(name) if scene.all_modes else GIVEN
    beyond = ComparedFidelity(name, "", None, top, whole=every, why=why)
    left_out = len(plan_of_record(case).seeds) - len(plan_of_record(chosen).seeds)
    return ModesNeeded(
        case, plan, asked, rows, None, beyond, top, most or wanted + 1, 0, seconds=float(reference.seconds.mean()),
        realisations=reference.seconds.size, left_out=left_out,
    )  # fmt: skip
