"""Self-contained HTML pages, of a results file and of studies, that ask nothing of any network."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vibeam.figures.response_curve import frc
from vibeam.report.declaration import SECTIONS
from vibeam.report.output import SheetPicture, StudySheet
from vibeam.report.page.charts import chart_data
from vibeam.report.page.parts import as_json, picture, rendered
from vibeam.report.page.standing import PAGE_BYTES, standing
from vibeam.report.run_report import run_report
from vibeam.runs.stored_result import StoredResult
from vibeam.system.response import modes_of
from vibeam_models.registry import loaded

VIEWS = ("base64", "numbers", "chart", "result", "response", "participation")


def sections_of(stored: StoredResult, live: bool) -> dict[str, Any]:
    """Sections that extensions have for a result by their names, those that are ``live`` or the sheets."""
    made = ((each.name, loaded(each.home)(stored)) for each in SECTIONS.values() if each.live == live)
    return {name: section for name, section in made if section is not None}


def page(stored: StoredResult, engine: bool = False) -> str:
    """The page as HTML, with what is live in it where the ``engine`` is asked for.

    CaseError where a model of the case cannot be built any more, errors of the live part.
    """
    result = stored.result
    sections = sections_of(stored, live=False)
    if result.case.record is not None:
        from vibeam.report.page.record_page import record_page

        return record_page(stored, sections)
    live = sections_of(stored, live=True) if engine else {}
    response = picture("response", "Amplitude against frequency of all fidelities", lambda: frc(result))
    data = as_json(chart_data(stored))
    modes = max((modes_of(each) for each in result.values()), default=0)
    report = run_report(result)
    decisive = [picture(each.name, each.words, each.draw) for each in report.pictures]
    room = PAGE_BYTES - len(data) - len(response.data) - sum(len(each.data) + len(each.numbers) for each in decisive)
    return rendered(
        "results.html",
        ("state", "saving", *VIEWS, "start"),
        next(iter(live.values()), None),
        **standing(result, modes, result.overview, stored.provenance, stored.left_out, room),
        missing=stored.missing,
        verdict=report,
        decisive=decisive,
        response=response,
        data=data,
        sections=list(sections.items()),
    )


def study_page(
    title: str, overview: str, sheets: Sequence[tuple[str, StudySheet]], pictures: Sequence[SheetPicture] = (),
    notes: Sequence[str] | None = None,
) -> str:  # fmt: skip
    """The page of studies: ``title``, the sentence (or lines) ``overview``, a section for each (heading, sheet).

    With ``notes`` that for a reader who decides: sentence, ``pictures`` and notes, the sheets folded below.
    """
    given: dict[str, Any] = {"title": title, "overview": overview, "sheets": sheets, "pictures": pictures}
    template = "study.html" if notes is None else "verdict.html"
    return rendered(template, ("state", "saving", "start"), notes=notes, **given)
