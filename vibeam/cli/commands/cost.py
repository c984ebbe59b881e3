"""``vibeam cost``: the cost study as plot and table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, folder, load, run_study
from vibeam.cli.output import print_result


def cost(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FOLDER", help="The folder for plot and table, made if new.", show_default=False),
    ] = None,
) -> None:
    """Measure accuracy against time.

    Every fidelity by every solver, and the sources of the error.
    """
    from vibeam.report import cost as cost_table
    from vibeam.report.cost import write_files
    from vibeam.runs.comparison.differences import headline
    from vibeam.studies.cost.study import cost as costs

    loaded = load(case, set_)
    place = folder(out or Path())
    study = run_study(case, loaded, costs)
    files = write_files(study, place, case.stem, loaded)
    print_result(
        {"study": study, "files": files}, as_json,
        lambda tables: [cost_table.runs(study), cost_table.parts(study)], [*cost_table.sentences(study), *files],
        [headline(study.comparison)],
    )  # fmt: skip
