"""``vibeam report``: one self-contained HTML page of a results file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.streams import put


def report(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="The results file (.h5).", show_default=False)],
    case: Annotated[
        Path | None,
        typer.Option("--case", metavar="CASE", help="Its case file, where references or other files lie beside that."),
    ] = None,
    out: Annotated[
        str | None, typer.Option("--out", metavar="FILE", help="The page (.html), or the folder for it.")
    ] = None,
) -> None:
    """Write one HTML page of a results file: scene, curves, motions, cost, checks; it needs no network."""
    from vibeam.casefile.read import load
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.page.page import page
    from vibeam.studies.stored import stored

    if results.suffix == ".toml":
        raise UsageError(f"{results}: is a case: name the results file that vibeam run makes of it")
    path = output_path(out, f"{results.stem}.html", (".html", ".htm"), "a page")
    found = stored(results, None if case is None else load(case))
    write_whole(path, page(found).encode())
    put(str(path))
