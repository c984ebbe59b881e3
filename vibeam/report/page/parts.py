"""Parts of a page: tables as plain rows, pictures, sections of a study's sheet; the templates that set them."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.report.output import StudySheet
    from vibeam.report.tables import ReportTable


@dataclass(frozen=True)
class PageTable:
    """Title, heads and rows of texts; ``numbers``: which columns are right-aligned."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: Sequence[bool]
    caption: str = ""


def of_report(table: ReportTable) -> PageTable:
    """A terminal's table as texts, without the columns that are empty in every row."""
    columns = [each for at, each in enumerate(table.columns) if at < table.heads or any(map(str, each.cells))]
    cells = [[str(cell) for cell in column.cells] for column in columns]
    return PageTable(
        str(table.title or ""),
        [str(each.header) for each in columns],
        list(zip(*cells, strict=True)),
        [each.justify == "right" for each in columns],
        str(table.caption or ""),
    )


DOTS = 110  # dots an inch of a picture of dots
LINES_BYTES = 200_000  # largest picture of lines: a larger one is shown in dots


@dataclass(frozen=True)
class Picture:
    """A static picture as the content of a data URL, and what it shows in words."""

    name: str
    words: str
    data: str

    @property
    def of_lines(self) -> bool:
        """Test whether it is an SVG, of which any size can be made."""
        return self.data.startswith("image/svg")


def picture(name: str, words: str, make: Callable[[], Figure]) -> Picture:
    """Picture of a figure: as SVG, as PNG where that is too large."""
    import matplotlib as mpl

    from vibeam.figures.files import METADATA
    from vibeam.figures.page import PAGE, composed

    with mpl.rc_context(PAGE):
        figure = composed(make)
        figure.set_layout_engine(None)  # the layout is found: keep it for both formats
        content = _saved(figure, format="svg", metadata=METADATA[".svg"])
        kind = "image/svg+xml"
        if len(content) > LINES_BYTES:
            content, kind = _saved(figure, format="png", dpi=DOTS), "image/png"
    return Picture(name, words, f"{kind};base64,{b64encode(content).decode()}")


def _saved(figure: Figure, **options: Any) -> bytes:
    with BytesIO() as content:
        figure.savefig(content, **options)
        return content.getvalue()


@dataclass(frozen=True)
class PageSection:
    """Sheet of a study as texts: its answer, tables and notes; behind them, folded, details and further tables."""

    heading: str
    answer: str
    tables: Sequence[PageTable]
    notes: Sequence[str]
    details: Sequence[str]
    more: Sequence[PageTable]
    picture: Picture | None = None


def section(heading: str, sheet: StudySheet) -> PageSection:
    """Section of a sheet, with its figure where it draws one."""
    drawn = None if sheet.draw is None else picture(heading, f"Figure: {heading}", sheet.draw)
    tables, more = ([of_report(each) for each in several] for several in (sheet.tables, sheet.more))
    return PageSection(heading, sheet.answer, tables, sheet.notes, sheet.details, more, drawn)


def rendered(template: str, **values: object) -> str:
    """A template of this folder with its values; texts are escaped, the style is part of the page."""
    from jinja2 import Environment, FunctionLoader

    room = files(__package__)

    def text(name: str) -> str:
        return (room / name).read_text(encoding="utf-8")

    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, loader=FunctionLoader(text))
    environment.globals["text_of"] = text
    return environment.get_template(template).render(values)
