"""Pages that fly: that of a results file, and that of a case without any sweep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vibeam import __version__
from vibeam.figures.units import units_for
from vibeam.report.explore.payload import payload
from vibeam.report.page.drawing import drawing
from vibeam.report.page.parts import LivePart, Picture, as_json, rendered

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.units import DisplayUnits
    from vibeam.runs.stored_result import StoredResult


def live_part(case: Case, units: DisplayUnits | None = None) -> LivePart:
    """Part of a page that flies a case, and why it does not fly some fidelities; errors as ``payload``."""
    made = payload(case, units)
    refusals = tuple(f"{each['label']}: {each['refusal']}" for each in made["models"] if each["refusal"])
    return LivePart(as_json(made) if made["libraries"] else "", refusals)


def results_page(stored: StoredResult) -> str:
    """Page of a results file with its engine, in the units of its curves; errors as ``page`` and ``payload``.

    Of a record case without an engine: its flights are of a sine.
    """
    from vibeam.report.page.page import page

    if stored.result.case.record is not None:
        return page(stored)
    return page(stored, live_part(stored.result.case, units_for(stored.result)))


def explore_page(case: Case, made: Mapping[str, Any]) -> str:
    """Page of a case that can be run, with the payload that was ``made`` of it: its rig, its models, the engine."""
    from vibeam.report.views import sheet_of

    drawn = drawing(case.scene)
    return rendered(
        "exploration.html",
        ("state", "saving", "start"),
        LivePart(as_json(made)),
        title=case.title,
        case=case,
        sheet=sheet_of(case),
        drawings=[Picture("Side view", "Side view to scale; what has no known shape is a box.", drawn)]
        if drawn
        else [],
        no_beam=case.scene.no_beam,
        version=__version__,
    )
