"""``vibeam cost``: the cost study as plot and table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, folder, load, run_study
from vibeam.cli.output import print_sheet


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
    from vibeam.report.cost import sheet
    from vibeam.studies.cost.study import cost as costs

    loaded = load(case, set_)
    place = folder(out or Path())
    found = sheet(run_study(case, loaded, costs), loaded)
    print_sheet(found, as_json, found.write(place / f"{case.stem}_cost.csv", loaded.figure))
