"""``vibeam run``: the results file, its figures and its summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, ResultsFile, load, results_path, run_case
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_result

if TYPE_CHECKING:
    from vibeam.run.result import Result


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
    from vibeam.figures.units import units_for
    from vibeam.report.figures import write_figures
    from vibeam.run.comparison.wording import headline, notes
    from vibeam.run.estimate.summary import estimate_texts
    from vibeam.run.remarks import remarks
    from vibeam.run.summary import compare

    files = [path, *write_figures(result, path)]
    rows = compare(result)
    units = units_for(result)
    remarked, compared = remarks(result), result.comparisons
    whole = {"fidelities": rows, "remarks": remarked, "found": result.found, "total": result.total, "files": files}
    whole |= {"comparisons": compared} | ({"curves": curves} if (curves := result.curves) else {})
    estimated = estimate_texts(result.estimates)
    whole |= {"estimates": estimated.rows} if estimated.rows else {}
    head = list(map(headline, compared))
    below = [*(line for each in compared for line in notes(each)), *estimated.sentences, *remarked, *files]
    study = result.accuracy
    if study is None:
        print_result(
            whole, as_json,
            lambda tables: [tables.responses(rows, units, estimated), tables.costs(rows, compared)], below, head,
        )  # fmt: skip
        return
    from vibeam.report import accuracy as accuracy_table

    print_result(
        whole | {"accuracy": study}, as_json,
        lambda tables: [tables.responses(rows, units, estimated), accuracy_table.choices(study)],
        [*accuracy_table.sentences(study, units), *accuracy_table.limits(study, compared), *below], head,
    )  # fmt: skip
