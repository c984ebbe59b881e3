"""Sheet of a verdict: one sentence, one table with the answer of each stage, the page with all that they found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from vibeam.case.case import Case
from vibeam.case.study_plans import FURTHER_STAGES, USUAL_STAGES, VerdictPlan
from vibeam.report import cost, effects, modes_needed
from vibeam.report.maps import verdict as fidelity_map
from vibeam.report.maps.page import map_figure
from vibeam.report.output import SheetPicture, StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.report.transient import by_value
from vibeam.studies.verdict import Stage, Verdict, plan_of_modes, require_plane
from vibeam_models.registry import loaded

QUESTIONS = {
    "modes": "How many modes?",
    "effects": "Which effects?",
    "solvers": "Which solver?",
    "map": "Where on the plane?",
    **{name: each.question for name, each in FURTHER_STAGES.items()},
}
FILES = {"modes": "modes_needed", "effects": "influence", "solvers": "cost", "map": "fidelity_map"}
FILES |= {name: each.file for name, each in FURTHER_STAGES.items()}


@dataclass(frozen=True)
class StageRow:
    """Answer of one stage, as CSV and JSON; CPU time in s."""

    stage: str
    question: str
    answer: str
    cpu_seconds: float


def sheet(found: Verdict) -> StudySheet:
    """Sheet of a verdict; of a single stage that of its study."""
    sheets = [(stage, stage_sheet(stage, found.case, found.plan.accuracy)) for stage in found.stages]
    if len(sheets) == 1:
        stage, made = sheets[0]
        return replace(made, study=FILES[stage.name])
    asked = QUESTIONS if found.case.record is None else QUESTIONS | {"map": "Which fidelity?"}
    rows = [StageRow(stage.name, asked[stage.name], made.answer, stage.cpu_seconds) for stage, made in sheets]
    answered = [row for row, (stage, _) in zip(rows, sheets, strict=True) if not stage.why]
    notes = [note for _, made in sheets for note in made.notes[:1]]
    without = [f"{stage.name} ({stage.why})" for stage, _ in sheets if stage.why]
    unanswered = [f"Not answered: {', '.join(without)}."] * bool(without)
    answer = answered[0].answer if answered else rows[0].answer
    return StudySheet(
        answer,
        [_answers(answered, answer)] if answered else [],
        [*notes, *unanswered],
        [note for _, made in sheets for note in [*made.notes[1:], *made.details]],
        [table for _, made in sheets for table in [*made.tables, *made.more]],
        data={"stages": {stage.name: {"answer": made.answer, **made.data} for stage, made in sheets}},
        rows=rows,
        page=lambda: _page(found, answer, sheets, asked, [*notes, *unanswered]),
    )


def _page(
    found: Verdict, answer: str, sheets: Sequence[tuple[Stage, StudySheet]], asked: Mapping[str, str],
    notes: Sequence[str],
) -> str:  # fmt: skip
    """Page of a verdict: what decides above, each stage with all that is not there folded below."""
    from vibeam.report.page.page import study_page

    folded = [
        (asked[stage.name], replace(made, draw=None, pictures=()) if stage.name in ("modes", "solvers") else made)
        for stage, made in sheets if not stage.why
    ]  # fmt: skip
    rest = ", ".join(name for name in USUAL_STAGES if name not in found.plan.only)
    left_out = [f"Not asked for: {rest}; without --only all stages are computed."] * bool(rest)
    return study_page(found.case.title, answer, folded, list(pictures(found)), [*notes, *left_out])


def pictures(found: Verdict) -> Iterator[SheetPicture]:
    """Pictures that decide: models over each other, error against CPU time of models and solvers, the plane."""
    swept = found.case.record is None  # a study under a record has tables alone
    stages = {stage.name: stage.record for stage in found.stages if swept and not stage.why}
    decided = modes_needed.decision(stages["modes"]) if "modes" in stages else None
    if "solvers" in stages:
        by_solvers = cost.decision(stages["solvers"], found.case, found.plan.accuracy)
        decided = by_solvers if decided is None else replace(
            decided, errors=(*decided.errors, *by_solvers.errors), left_out=(*decided.left_out, *by_solvers.left_out),
            against=f"{decided.reference}, of solvers against {by_solvers.reference}",
        )  # fmt: skip
    yield from decided.pictures if decided else ()
    if "map" in stages:
        words = "The cheapest model that suffices, over the plane"
        yield SheetPicture("Where on the plane", words, lambda: fidelity_map.regions_figure(stages["map"]))


def stage_sheet(stage: Stage, case: Case, accuracy: float) -> StudySheet:
    """Sheet of one stage: of its study, or why it has no answer."""
    if stage.why:
        return StudySheet(f"Not answered: {stage.why}", data={"why": stage.why})
    if stage.name in FURTHER_STAGES:
        made: StudySheet = loaded(FURTHER_STAGES[stage.name].sheet)(stage.record)
        return made
    if stage.name == "effects":
        return effects.sheet(stage.record)
    if stage.name == "modes":
        return modes_needed.sheet(stage.record)
    if case.record is not None:
        return by_value(stage.record, accuracy)
    if stage.name == "solvers":
        return cost.sheet(stage.record, case, accuracy)
    return replace(fidelity_map.sheet(stage.record), draw=lambda: map_figure(stage.record))


def first_answer(case: Case) -> str:
    """Answer of the first stage where it is known before anything is flown; else empty."""
    plan: VerdictPlan = case.asked["verdict"]
    if case.record is not None:
        return ""
    require_plane(case, plan)
    return modes_needed.first_answer(case, plan_of_modes(case, plan)) if "modes" in plan.only else ""


def _answers(rows: Sequence[StageRow], answer: str) -> ReportTable:
    table = blank("How much model", "question", "answer", "CPU|")
    for row in rows:
        said = "the first sentence says it" if row.answer == answer else row.answer
        table.add_row(row.question, said, f"{float(f'{row.cpu_seconds:.2g}'):g} s")
    return table
