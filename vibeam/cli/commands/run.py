"""``vibeam run``: the results file, its figures and its summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, ResultsFile, load, results_path, run_case
from vibeam.cli.output import print_result

if TYPE_CHECKING:
    from vibeam.run.result import Result


def run(
    case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: ResultsFile = None, fresh: Fresh = False
) -> None:
    """Sweep every fidelity of a case, or continue a results file."""
    from vibeam.studies.regression.references import require_readable

    loaded = load(case, set_)
    require_readable(loaded)
    path = results_path(loaded, out)
    _report(run_case(loaded, path, fresh=fresh), path, as_json)


def _report(result: Result, path: Path, as_json: bool) -> None:
    from vibeam.figures.units import units_for
    from vibeam.report.figures import write_figures
    from vibeam.run.remarks import remarks
    from vibeam.run.summary import compare

    files = [path, *write_figures(result, path)]
    rows = compare(result)
    units = units_for(result)
    notes = remarks(result)
    whole = {"fidelities": rows, "remarks": notes, "found": result.found, "total": result.total, "files": files}
    whole |= {"curves": curves} if (curves := result.curves) else {}
    study = result.accuracy
    if study is None:
        print_result(
            whole, as_json, lambda tables: [tables.responses(rows, units), tables.costs(rows)], [*notes, *files]
        )
        return
    from vibeam.report import accuracy as accuracy_table

    print_result(
        whole | {"accuracy": study}, as_json,
        lambda tables: [tables.responses(rows, units), accuracy_table.choices(study)],
        [*accuracy_table.sentences(study, units), *notes, *files],
    )  # fmt: skip
