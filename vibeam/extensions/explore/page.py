"""Parts of pages that fly: of that of a results file, and that of a case without any sweep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from vibeam import __version__
from vibeam.extensions.explore.payload import payload
from vibeam.figures.units import units_for
from vibeam.report.page.drawing import drawing
from vibeam.report.page.parts import LivePart, Picture, as_json, rendered

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.figures.units import DisplayUnits
    from vibeam.runs.stored_result import StoredResult

HOMES = tuple(f"vibeam.extensions.explore:{folder}" for folder in ("", "engine", "views"))


def live_part(case: Case, units: DisplayUnits | None = None) -> LivePart:
    """Part of a page that flies a case, and why it does not fly some fidelities; errors as ``payload``."""
    made = payload(case, units)
    refusals = tuple(f"{each['label']}: {each['refusal']}" for each in made["models"] if each["refusal"])
    return of_payload(as_json(made) if made["libraries"] else "", refusals)


def of_payload(text: str, refusals: tuple[str, ...] = ()) -> LivePart:
    """Part of a page that flies what the ``text`` of a payload says."""
    return LivePart(text, refusals, "flying.html", "explore.css", "explore", ("engine", "worker"), HOMES)


def results_section(stored: StoredResult) -> LivePart | None:
    """Engine on the page of a results file, in the units of its curves; errors as ``payload``.

    None of a record case: its flights are of a sine.
    """
    case = stored.result.case
    return live_part(case, units_for(stored.result)) if case.record is None else None


def explore_page(case: Case, made: Mapping[str, Any]) -> str:
    """Page of a case that can be run, with the payload that was ``made`` of it: its rig, its models, the engine."""
    from vibeam.report.views import sheet_of

    drawn = drawing(case.scene)
    return rendered(
        "exploration.html",
        ("state", "saving", "start"),
        of_payload(as_json(made)),
        title=case.title,
        case=case,
        sheet=sheet_of(case),
        drawings=[Picture("Side view", "Side view to scale; what has no known shape is a box.", drawn)]
        if drawn
        else [],
        no_beam=case.scene.no_beam,
        version=__version__,
    )
