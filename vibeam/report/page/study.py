"""One self-contained HTML page of studies: a first sentence, then a section for each sheet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vibeam.report.page.parts import rendered, section

if TYPE_CHECKING:
    from vibeam.report.output import StudySheet


def study_page(title: str, overview: str, sheets: Sequence[tuple[str, StudySheet]]) -> str:
    """The page as HTML: ``title``, the sentence (or lines) ``overview``, a section for each (heading, sheet).

    Figures are drawn now, as SVG or PNG within the page; it asks nothing of any network.
    """
    return rendered("study.html", title=title, overview=overview, sections=[section(*each) for each in sheets])
