"""``vibeam run``: the results file, its figures and its summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, ResultsFile, load, results_path, run_case
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_result

if TYPE_CHECKING:
    from vibeam.runs.result import Result


def run(
    case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: ResultsFile = None, fresh: Fresh = False
) -> None:
    """Sweep every fidelity of a case, or continue a results file."""
    loaded = load(case, set_)
    from vibeam.studies.regression.references import require_readable

    require_readable(loaded)
    if any(plan.format for plan in loaded.shows.values()):
        from vibeam.figures.moving import require_programs

        of_case(loaded.path, lambda: require_programs(loaded))
    path = results_path(loaded, out)
    _report(run_case(loaded, path, fresh=fresh, compare=True), path, as_json)


def _report(result: Result, path: Path, as_json: bool) -> None:
    from vibeam.report.figures import write_figures
    from vibeam.report.run_report import run_report
    from vibeam.runs.estimate.records import estimate_texts
    from vibeam.runs.summary import compare, remarks

    files = [path, *write_figures(result, path)]
    whole = {"fidelities": compare(result), "remarks": remarks(result), "found": result.found, "total": result.total}
    whole |= {"files": files, "comparisons": result.comparisons}
    more = {"curves": result.curves, "estimates": estimate_texts(result.estimates).rows, "accuracy": result.accuracy}
    whole |= {name: value for name, value in more.items() if value}
    found = run_report(result)
    print_result(whole, as_json, lambda _: found.tables, [*found.sentences, *files], found.head)
