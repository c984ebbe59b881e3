"""``vibeam check``: the verdict on a case's references and expectations, and its measured numbers beside the model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import (
    AsJson,
    CaseFile,
    Fresh,
    Overrides,
    ResultsFile,
    load,
    output_path,
    results_path,
    run_case,
)
from vibeam.cli.output import print_result
from vibeam.cli.streams import say

if TYPE_CHECKING:
    from vibeam.studies.regression.references import CheckRow

MISSED = 1
DRAWN = (".png", ".svg", ".pdf")

Plot = Annotated[
    str | None,
    typer.Option(
        "--plot", metavar="FILE", help="Draw references and model (.png, .svg, .pdf), or the folder for it.",
        show_default=False,
    ),
]  # fmt: skip


def check(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: ResultsFile = None,
    fresh: Fresh = False,
    plot: Plot = None,
) -> None:
    """Compare a case with references and measured numbers.

    References are compared at their own frequencies. Exit code 1 where one is missed.
    """
    loaded = load(case, set_)
    path = None if plot is None else output_path(plot, f"{loaded.path.stem}_check.png", DRAWN, "a figure")
    if not (loaded.references or loaded.expectations or loaded.measured):
        from vibeam.runs.systems import require_runnable

        require_runnable(loaded)
        say(f"{case}: a sound case, but it names no reference to check against and no measured number")
        print_result([], as_json)
        return
    from vibeam.case.held import held_of
    from vibeam.casefile.read import without_accuracy
    from vibeam.figures.units import units_of
    from vibeam.report.checks import verdicts
    from vibeam.runs.summary import remarks
    from vibeam.studies.regression.check import at_references, compare_measured
    from vibeam.studies.regression.check import check_expectations as expectations
    from vibeam.studies.regression.references import check as of_references
    from vibeam.studies.regression.references import require_readable

    require_readable(loaded)
    loaded = without_accuracy(loaded)  # each fidelity is checked by itself
    result = run_case(loaded, None if out is None else results_path(loaded, out), show=False, fresh=fresh)
    partial = any(each.strip().startswith("sweep") for each in set_ or ())
    at = at_references(loaded, result, partial=partial)
    rows = [*of_references(loaded, result, partial=partial, at=at), *expectations(loaded, result, partial=bool(set_))]
    measured = compare_measured(loaded, result)
    units = units_of(loaded)
    compared = any(each.against for each in loaded.expectations.values())
    print_result(
        [*rows, *measured], as_json, lambda _: verdicts(rows, measured, units),
        [*_registrations(rows), *remarks(result)],
        [f"Held: {held_of(loaded.scene).label}."] if compared else [],
    )  # fmt: skip
    if path is not None and at:
        from vibeam.report.references import write_references

        write_references(loaded, rows, at, path)
        say(f"wrote {path}")
    if any(row.passed is False for row in rows):
        raise typer.Exit(MISSED)


def _registrations(rows: Iterable[CheckRow]) -> list[str]:
    """Shift and amplitude error of every curve that is off."""
    return [f"{row.reference}: {row.registration.sentence}." for row in rows if row.registration is not None]
