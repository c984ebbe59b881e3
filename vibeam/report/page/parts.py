"""Parts of a page: tables as plain rows, pictures, scripts; the templates that set them."""

from __future__ import annotations

import csv
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO, StringIO
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.report.tables import ReportTable, filled_columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def texts(table: ReportTable) -> dict[str, Any]:
    """A terminal's table as texts, without the columns that are empty in every row; ``numbers``: those of numbers."""
    columns = [table.columns[at] for at in filled_columns(table)]
    return {
        "title": str(table.title or ""),
        "caption": str(table.caption or ""),
        "heads": [str(each.header) for each in columns],
        "rows": list(zip(*([str(cell) for cell in each.cells] for each in columns), strict=True)),
        "numbers": [each.justify == "right" for each in columns],
    }


DOTS = 110  # dots an inch of a picture of dots
LINES_BYTES = 80_000  # picture of lines that is kept whatever its size in dots
KINDS = {".svg": "image/svg+xml", ".png": "image/png"}
NUMBERS_BYTES = 80_000  # largest text of a picture's numbers that the page holds


@dataclass(frozen=True)
class Picture:
    """A static picture, what it shows in ``words``, and its ``numbers`` as CSV where the page holds them.

    ``data``: the content of a data URL, or an SVG that is part of the page.
    """

    name: str
    words: str
    data: str
    numbers: str = ""

    @property
    def inline(self) -> bool:
        """Test whether it is an SVG that takes its colours from the page."""
        return self.data.startswith("<svg")


def picture(name: str, words: str, make: Callable[[], Figure]) -> Picture:
    """Picture of a figure: as SVG, as PNG where that is large and a PNG is smaller."""
    import matplotlib as mpl

    from vibeam.figures.files import METADATA
    from vibeam.figures.page import PAGE, composed

    with mpl.rc_context(PAGE):
        figure = composed(make)
        figure.set_layout_engine(None)  # the layout is found: keep it for both formats
        lines, dots = BytesIO(), BytesIO()
        figure.savefig(lines, format="svg", metadata=METADATA[".svg"])
        if lines.tell() > LINES_BYTES:
            figure.savefig(dots, format="png", dpi=DOTS)
    kind, content = (".png", dots) if 0 < dots.tell() < lines.tell() else (".svg", lines)
    return Picture(name, words, embedded(KINDS[kind], content.getvalue()), numbers_of(figure))


def embedded(kind: str, content: bytes) -> str:
    """A file of some kind (MIME) as the content of a data URL."""
    return f"{kind};base64,{b64encode(content).decode()}"


def numbers_of(figure: Figure) -> str:
    """Lines and bars of a figure as CSV, a row a point; empty where there are none, or too many for a page."""
    from matplotlib.container import BarContainer

    rows: list[tuple[object, ...]] = []
    for axes in figure.axes:
        panel = axes.get_title(loc="left") or axes.get_title() or axes.get_ylabel()
        for line in axes.lines:
            points = np.asarray(line.get_xydata(), dtype=float).tolist()
            rows += [(panel, line.get_gid() or line.get_label(), *point) for point in points]
        for bars in axes.containers:
            if isinstance(bars, BarContainer):
                rows += [(panel, bars.get_label(), float(each.get_center()[0]), each.get_height()) for each in bars]
    made = as_csv(("panel", "curve", "x", "y"), rows)
    return made if rows and len(made) <= NUMBERS_BYTES else ""


def as_csv(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Rows as CSV, numbers with six digits."""
    text = StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(heads)
    writer.writerows([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in rows)
    return text.getvalue()


EXPORT = re.compile(r"^export (\w+) (\w+)", re.MULTILINE)
IMPORT = re.compile(r'^import (\{.*\}) from "\./(\w+)\.js";$', re.MULTILINE)


def bundle(names: Sequence[str]) -> str:
    """Modules of scripts, each after those that it imports from, as one text that needs no files: none is global."""
    parts = ["const modules = {};"]
    for name in names:
        text = text_of(f"{name}.js")
        known = ", ".join(each[1] for each in EXPORT.findall(text))
        own = IMPORT.sub(r"const \1 = modules.\2;", EXPORT.sub(r"\1 \2", text))
        parts.append(f"modules.{name} = (() => {{\n{own}return {{ {known} }};\n}})();")
    return "\n".join(parts)


def text_of(name: str) -> str:
    """Text of a file of this folder."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def rendered(template: str, scripts: Sequence[str], **values: object) -> str:
    """A template of this folder with its values, texts escaped; style and ``scripts`` are part of the page."""
    from jinja2 import Environment, FunctionLoader

    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, loader=FunctionLoader(text_of))
    environment.globals |= {"text_of": text_of, "picture_of": picture, "texts": texts}
    return environment.get_template(template).render(values, scripts=bundle(scripts))
