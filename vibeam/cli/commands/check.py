"""``vibeam check``: the verdict on a case's references and expectations, and its measured numbers beside the model."""

from __future__ import annotations

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, ResultsFile, load, results_path, run_case
from vibeam.cli.output import print_result
from vibeam.cli.streams import say

MISSED = 1


def check(
    case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: ResultsFile = None, fresh: Fresh = False
) -> None:
    """Compare a case with references and measured numbers.

    Exit code 1 where a reference is missed.
    """
    loaded = load(case, set_)
    if not (loaded.references or loaded.expectations or loaded.measured):
        say(f"{case}: a sound case, but it names no reference to check against and no measured number")
        print_result([], as_json)
        return
    from vibeam.case.held import held_of
    from vibeam.casefile.read import without_accuracy
    from vibeam.figures.units import units_of
    from vibeam.run.remarks import remarks
    from vibeam.studies.regression.check import check as checked
    from vibeam.studies.regression.check import compare_measured
    from vibeam.studies.regression.references import require_readable

    require_readable(loaded)
    loaded = without_accuracy(loaded)  # each fidelity is checked by itself
    result = run_case(loaded, None if out is None else results_path(loaded, out), show=False, fresh=fresh)
    rows = checked(loaded, result, partial=bool(set_))
    measured = compare_measured(loaded, result)
    units = units_of(loaded)
    compared = any(each.against for each in loaded.expectations.values())
    print_result(
        [*rows, *measured], as_json, lambda tables: tables.verdicts(rows, measured, units), remarks(result),
        [f"Held: {held_of(loaded.scene).label}."] if compared else [],
    )  # fmt: skip
    if not all(row.passed for row in rows):
        raise typer.Exit(MISSED)
