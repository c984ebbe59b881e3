"""``vibeam fit``: keys of a case from measured frequency responses, with intervals and what stays open."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.output import print_result


def fit(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    next_: Annotated[
        bool, typer.Option("--next", help="Also say which frequency, level or gap to measure next.")
    ] = False,
) -> None:
    """Estimate keys of the case from its measured curves, as [fit] says.

    Along branches of periodic motions: values, 95 % intervals, and what the curves cannot separate.
    """
    from vibeam.figures.files import paths_of
    from vibeam.report.fit import as_data, fit_tables, write_fit
    from vibeam.studies.fit.study import fit as fitted

    loaded = load(case, set_)
    path = table_path(loaded, out, "fit")
    study = run_study(case, loaded, lambda own, tell: fitted(own, tell, next_point=next_))
    figures = paths_of(path, loaded.figure)
    write_fit(study, path, figures)
    files = [path, *figures]
    print_result(as_data(study) | {"files": files}, as_json, lambda _: fit_tables(study), [*study.sentences, *files])
