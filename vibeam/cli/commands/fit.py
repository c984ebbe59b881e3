"""``vibeam fit``: keys of a case from measured frequency responses, with intervals and what stays open."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_sheet

if TYPE_CHECKING:
    from vibeam.case.case import Case


def fit(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    next_: Annotated[
        bool, typer.Option("--next", help="Also say which frequency, level or gap to measure next.")
    ] = False,
    write: Annotated[
        Path | None,
        typer.Option(
            "--write", metavar="FILE", help="Also write the case with the estimated values in it.", show_default=False
        ),
    ] = None,
) -> None:
    """Estimate keys of the case from its measured curves, as [fit] says.

    Along branches of periodic motions: values, 95 % intervals, and what the curves cannot separate.
    """
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.fit import estimated_case, sheet
    from vibeam.studies.fit.study import fit as fitted

    loaded = load(case, set_)
    path = table_path(loaded, out, "fit")
    if write is not None:
        _require_new(loaded, write, set_)
    study = run_study(case, loaded, lambda own, tell: fitted(own, tell, next_point=next_))
    found = sheet(study)
    files = found.write(path, loaded.figure)
    if write is not None:
        write_whole(write, run_study(case, loaded, lambda *_: estimated_case(study)).encode())
        files.append(write)
    print_sheet(found, as_json, files)


def _require_new(case: Case, write: Path, set_: list[str] | None) -> None:
    """UsageError where the case cannot be written to ``write``."""
    beside = case.path.parent
    if set_:
        raise UsageError("--write: the file is written without --set: write these keys into the case first")
    if write.suffix != ".toml":
        raise UsageError(f"{write}: --write names a case, which ends in .toml")
    if write.parent.resolve() != beside.resolve():
        raise UsageError(f"{write}: --write names a file beside the case, {beside / write.name}: its curves lie there")
    if write.exists():
        raise UsageError(f"{write}: is there already: name another file")
