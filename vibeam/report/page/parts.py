"""Parts of a page: tables as plain rows, pictures, scripts; the templates that set them."""

from __future__ import annotations

import csv
import json
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from io import BytesIO, StringIO
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.figures.style import DASHES, Look
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


LIGHTER = 0.45  # share of white in a line's colour on a dark ground


def look_on_page(own: Look) -> dict[str, Any]:
    """Colours, dashes and relative width of a fidelity's lines on the page."""
    dash = [] if own.dash == DASHES[0] else [3 * each for each in own.dash[1]]
    return {**colours_on_page(own.colour), "dash": dash, "wide": own.wide}


def colours_on_page(colour: str) -> dict[str, str]:
    """Colour of a line (#rrggbb) on white paper, and a lighter one on a dark ground."""
    parts = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return {"colour": colour, "dark": "#" + "".join(f"{round(part + LIGHTER * (255 - part)):02x}" for part in parts)}


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


def as_json(values: Any) -> str:
    """JSON that may stand in a script element of a page, whatever texts it holds."""
    text = json.dumps(values, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e").replace("\u2028", "\\u2028")


EXPORT = re.compile(r"^export ((?:async )?\w+) (\w+)", re.MULTILINE)
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\.{1,2}/(?:[\w./]+/)?(\w+)\.js";$', re.MULTILINE)
COMMENT = re.compile(r"^[ \t]*(?://[^\n]*|/\*\*.*?\*/[ \t]*)\n", re.DOTALL | re.MULTILINE)  # whole lines of it
HOME = "vibeam.report:page"  # package and its folder with files of pages


def bundle(names: Sequence[str], first: bool = True, homes: Sequence[str] = (HOME,)) -> str:
    """Modules of scripts, each after those that it imports from, as one text that needs no files: none is global.

    Lines that are comments stay in the files. ``first``: no other text of modules stands before it on the page.
    """
    parts = ["const modules = {};"] if first else []
    for name in names:
        text = COMMENT.sub("", text_of(f"{name}.js", homes))
        known = ", ".join(each[1] for each in EXPORT.findall(text))
        own = IMPORT.sub(r"const \1 = modules.\2;", EXPORT.sub(r"\1 \2", text))
        parts.append(f"modules.{name} = (() => {{\n{own}return {{ {known} }};\n}})();")
    return "\n".join(parts)


def with_imports(names: Sequence[str], known: Sequence[str] = (), homes: Sequence[str] = (HOME,)) -> tuple[str, ...]:
    """Modules with all that they import from, each behind those, less those that are ``known`` to stand before.

    ValueError where modules import each other in a circle.
    """
    found: list[str] = []

    def add(name: str, above: tuple[str, ...]) -> None:
        if name in above:
            raise ValueError(f"{' > '.join([*above, name])}: these modules import each other")
        if name not in known and name not in found:
            for _, home in IMPORT.findall(text_of(f"{name}.js", homes)):
                add(home, (*above, name))
            found.append(name)

    for each in names:
        add(each, ())
    return tuple(found)


def text_of(name: str, homes: Sequence[str] = (HOME,)) -> str:
    """Text of a file of the ``homes``, in which no two have the same name; FileNotFoundError where none has it."""
    for home in homes:
        package, _, folder = home.partition(":")
        found = files(package).joinpath(folder, name)
        if found.is_file():
            return found.read_text(encoding="utf-8")
    raise FileNotFoundError(f"{name}: in none of {', '.join(homes)}")


@dataclass(frozen=True)
class LivePart:
    """Part of a page that computes in the reader's browser: what its scripts make of the ``payload``, as JSON.

    ``refusals``: a sentence on each fidelity that it does not have. An empty ``payload`` is a part without its engine.
    ``template``, ``style`` and ``script``: names of its files, in the ``homes`` or those of all pages; modules of the
    ``engine`` stand in an element of their own, whose text is a worker's too.
    """

    payload: str
    refusals: tuple[str, ...]
    template: str
    style: str
    script: str
    engine: tuple[str, ...]
    homes: tuple[str, ...]


def rendered(template: str, scripts: Sequence[str], live: LivePart | None = None, **values: object) -> str:
    """A template with its values, texts escaped; style and ``scripts`` are part of the page, the last one starts it."""
    from jinja2 import Environment, FunctionLoader

    read = partial(text_of, homes=(HOME, *live.homes) if live else (HOME,))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, loader=FunctionLoader(read))
    environment.globals |= {"text_of": read, "picture_of": picture, "texts": texts}
    values |= {"live": live, "flies": False}
    if live and live.payload:
        homes = (HOME, *live.homes)
        flown = with_imports(live.engine, homes=homes)
        scripts = with_imports([*scripts[:-1], live.script, *scripts[-1:]], flown, homes)
        values |= {"flies": True, "engine": f'"use strict";\n{bundle(flown, homes=homes)}'}
        return environment.get_template(template).render(values, scripts=bundle(scripts, False, homes))
    return environment.get_template(template).render(values, scripts=bundle(scripts))
