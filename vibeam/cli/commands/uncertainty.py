"""``vibeam uncertainty``: bands on the curve, sensitivity, a cheaper mean, errors side by side."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.output import print_sheet


def uncertainty(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    samples: Annotated[int, typer.Option("--samples", min=16, help="A power of two: of runs an input.")] = 128,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the samples.")] = 0,
) -> None:
    """Carry what [uncertain] says through the sweep: bands, sensitivity, errors side by side."""
    from vibeam.report.uncertainty import sheet
    from vibeam.studies.uncertainty.study import uncertainty as study_of

    loaded = load(case, set_)
    path = table_path(loaded, out, "uncertainty")
    found = sheet(run_study(case, loaded, lambda own, tell: study_of(own, tell, samples=samples, seed=seed)))
    print_sheet(found, as_json, found.write(path, loaded.figure))
