"""Declaration of the stage of a verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vibeam.case.study_plans import StageDeclaration

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.study_plans import VerdictPlan

STAGES = (
    StageDeclaration(
        "solid",
        "Is the beam enough?",
        "solid",
        "vibeam.extensions.solid.stages:of_verdict",
        "vibeam.extensions.solid.sheet:sheet",
        spatial=True,
    ),
)


def of_verdict(case: Case, plan: VerdictPlan, progress: Any) -> Any:
    """Record of the stage by the plan of a verdict."""
    from vibeam.extensions.solid.verdict.study import solid_verdict

    return solid_verdict(
        case,
        accuracy=plan.accuracy,
        frequency_accuracy=plan.frequency_accuracy,
        progress=progress,
        budget=plan.allowed,
    )
