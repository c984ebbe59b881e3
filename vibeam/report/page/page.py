"""One self-contained HTML page of a results file: pictures, tables and charts that ask nothing of any network."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from vibeam.report.page.charts import as_json, chart_data
from vibeam.report.page.drawing import drawing
from vibeam.report.page.parts import PageTable, Picture, of_report, picture, rendered, section
from vibeam.report.run_report import run_report

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.runs.stored_result import StoredResult


ELSEWHERE = ("title", "source", "units", "fidelity", "sweep", "show", "reference", "expect", "measured", "cost",
             "influence", "map", "uncertain", "chosen_by", "fit", "figure", "accuracy", "accuracy_of")  # fmt: skip


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
PICTURES_BYTES = 420_000  # of all static pictures together


def page(stored: StoredResult) -> str:
    """The page as HTML; CaseError where a model of the case cannot be built any more."""
    result = stored.result
    return rendered(
        "results.html",
        title=result.case.title,
        result=result,
        case=result.case,
        missing=stored.missing,
        verdict=section("Verdict", run_report(result)),
        scene=drawing(result.case.scene),
        overview=result.overview,
        scene_keys=scene_table(result.case.text),
        no_beam=result.case.scene.no_beam,
        checks=_checks(result, stored.left_out),
        pictures=_pictures(result),
        provenance=sorted(stored.provenance.items()),
        data=as_json(chart_data(stored)),
        scripts=SCRIPTS,
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

    found = [picture("response", "Amplitude against frequency of all fidelities", lambda: frc(result))]
    room = PICTURES_BYTES - len(found[0].data)
    for name, plan in result.case.shows.items():
        if name not in result.shown:
            continue
        made = picture(name, f"Figure {name}: {plan.kind}", partial(figure, result, plan))
        if len(made.data) < room:
            found.append(made)
            room -= len(made.data)
    return found
