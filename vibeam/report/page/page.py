"""One self-contained HTML page of a results file: pictures, tables and charts that ask nothing of any network."""

from __future__ import annotations

import tomllib
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING, Any

from vibeam.report.page.charts import as_json, chart_data
from vibeam.report.page.drawing import drawing
from vibeam.report.run_report import run_report

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.figure import Figure

    from vibeam.report.tables import ReportTable
    from vibeam.runs.result import Result
    from vibeam.runs.stored_result import StoredResult


ELSEWHERE = ("title", "source", "units", "fidelity", "sweep", "show", "reference", "expect", "measured", "cost",
             "influence", "map", "uncertain", "chosen_by", "fit", "figure", "accuracy", "accuracy_of")  # fmt: skip


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


def scene_table(text: str) -> PageTable:
    """Keys of the case that say what stands on the bench, in SI units; effects among them are those that are active."""
    tables = {name: value for name, value in tomllib.loads(text).items() if name not in ELSEWHERE}
    rows = [row for name, value in tables.items() for row in _rows(name, value)]
    return PageTable("The scene, in SI units", ("table", "key", "value"), rows, (False, False, True))


def _rows(name: str, value: Any) -> Iterator[tuple[str, str, str]]:
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, each in enumerate(value, 1):
            yield from _rows(f"{name} {number}", each)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            if isinstance(inner, Mapping):
                yield from _rows(f"{name}.{key}", inner)
            else:
                yield name, key, _shown(inner)
    else:
        yield "", name, _shown(value)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_shown, value[:12])) + " …" * (len(value) > 12)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


SCRIPTS = ("response.js", "motion.js", "page.js")  # one after the other
DOTS = 110  # dots an inch of a static picture
PICTURES_BYTES = 420_000  # of all static pictures together


@dataclass(frozen=True)
class Picture:
    """A static picture as PNG in base64, with what it shows in words."""

    name: str
    words: str
    data: str


def page(stored: StoredResult) -> str:
    """The page as HTML; CaseError where a model of the case cannot be built any more."""
    from jinja2 import Environment

    result, said = stored.result, run_report(stored.result)
    room = files(__package__)
    template = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True).from_string(
        (room / "page.html").read_text(encoding="utf-8")
    )
    return template.render(
        result=result,
        case=result.case,
        missing=stored.missing,
        headlines=[said.answer] if said.answer else [],
        sentences=said.notes,
        scene=drawing(result.case.scene),
        overview=result.overview,
        scene_keys=scene_table(result.case.text),
        no_beam=result.case.scene.no_beam,
        tables=list(map(of_report, said.tables)),
        checks=_checks(result, stored.left_out),
        pictures=_pictures(result),
        provenance=sorted(stored.provenance.items()),
        data=as_json(chart_data(stored)),
        script="\n".join((room / name).read_text(encoding="utf-8") for name in SCRIPTS),
        style=(room / "page.css").read_text(encoding="utf-8"),
        plot_script=(room / "vendor" / "uPlot.iife.min.js").read_text(encoding="utf-8"),
        plot_style=(room / "vendor" / "uPlot.min.css").read_text(encoding="utf-8"),
        plot_licence=(room / "vendor" / "uPlot.LICENSE").read_text(encoding="utf-8"),
    )


@dataclass(frozen=True)
class Checks:
    """Checks of the case as tables; ``why``: the reason for none."""

    tables: list[PageTable]
    passed: int = 0
    missed: int = 0
    why: str = ""


def _checks(result: Result, left_out: tuple[str, ...]) -> Checks:
    """References, regression values and measured numbers of the case, where each fidelity was run by itself."""
    case = result.case
    lost = f"Not checked against {', '.join(left_out)}: no such files beside the results; name the case with --case."
    if left_out and not (case.references or case.expectations or case.measured):
        return Checks([], why=lost)
    if not (case.references or case.expectations or case.measured):
        return Checks([], why="The case names no reference to check against and no measured number.")
    if result.accuracy is not None:
        return Checks([], why="Checked by vibeam check, which runs each fidelity by itself.")
    from vibeam.exchange.faults import CaseError
    from vibeam.figures.units import units_of
    from vibeam.report.checks import verdicts
    from vibeam.studies.regression.check import check, compare_measured

    try:
        rows, measured = check(case, result), compare_measured(case, result)
    except CaseError as fault:
        return Checks([], why=f"Not checked: {fault}")
    passed, missed = (sum(row.passed is verdict for row in rows) for verdict in (True, False))
    made = [of_report(each) for each in verdicts(rows, measured, units_of(case))]
    return Checks(made, passed, missed, lost if left_out else "")


def _pictures(result: Result) -> list[Picture]:
    """The figure of the run, and further figures of the case as far as there is room."""
    from vibeam.figures.response_curve import frc
    from vibeam.report.figures import figure

    found = [_picture("response", "Amplitude against frequency of all fidelities", lambda: frc(result))]
    room = PICTURES_BYTES - len(found[0].data)
    for name, plan in result.case.shows.items():
        if name not in result.shown:
            continue
        made = _picture(name, f"Figure {name}: {plan.kind}", partial(figure, result, plan))
        if len(made.data) < room:
            found.append(made)
            room -= len(made.data)
    return found


def _picture(name: str, words: str, make: Callable[[], Figure]) -> Picture:
    import matplotlib as mpl

    from vibeam.figures.page import PAGE, composed

    keys: dict[str, Any] = {"format": "png", "dpi": DOTS}
    with mpl.rc_context(PAGE), BytesIO() as content:
        composed(make).savefig(content, **keys)
        return Picture(name, words, b64encode(content.getvalue()).decode())
