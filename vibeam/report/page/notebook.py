"""View of a record in a notebook: its sheet as a piece of HTML, with the rig of a case."""

from __future__ import annotations

from base64 import b64encode
from re import sub
from typing import Any

from vibeam.report.page.drawing import drawing
from vibeam.report.page.parts import rendered, text_of
from vibeam.report.views import sheet_of


def html(record: Any) -> str:
    """View of a record as a piece of HTML that asks nothing of any network; its texts are escaped."""
    words = sub(r"(?<!^)([A-Z])", r" \1", type(record).__name__).capitalize()
    heading = getattr(getattr(record, "case", record), "title", "") or words
    return rendered("notebook.html", (), heading=heading, sheet=sheet_of(record), scene=_scene(record))


def _scene(record: Any) -> str:
    """Rig of a case as the content of a data URL, its style within; empty of another record."""
    if type(record).__name__ != "Case":
        return ""
    style = text_of("page.css")
    head, bracket, rest = drawing(record.scene).partition(">")
    content = f"{head}{bracket}<style>{style}</style>{rest}" if rest else ""
    return content and f"image/svg+xml;base64,{b64encode(content.encode()).decode()}"
