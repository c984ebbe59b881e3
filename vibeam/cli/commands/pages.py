"""``vibeam report``: page and table of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import option, out_option, output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_json, put_lines
from vibeam.cli.streams import say, tell
from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from vibeam.runs.stored_result import StoredResult


PAGES = (".html", ".htm")  # endings
_BESIDE = "Its case file, where references or other files lie beside that."


def report(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="The results file (.h5).", show_default=False)],
    case: Annotated[Path | None, option(_BESIDE, "--case", metavar="CASE")] = None,
    out: Annotated[str | None, out_option("The page (.html), the table (.csv), or the folder for it.")] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Write all curves as a table in place of the page.")] = False,
    no_engine: Annotated[bool, option("A page without its engine: smaller, without sliders.", "--no-engine")] = False,
) -> None:
    """Write a page of results, or all curves as CSV.

    The page holds the answer, the scene, curves, motions, cost and checks, and an engine that flies the case again as
    sliders move; it needs no network. The table has a row for every point of every fidelity and way, and a column for
    every quantity, with its unit; with -v modal energies of more than eight modes too.

    \b
    Examples:
      vibeam report mine.h5
      vibeam report mine.h5 --no-engine
      vibeam report mine.h5 --csv --out tables/
    """
    from vibeam.casefile.read import load
    from vibeam.studies.stored import stored

    if results.suffix == ".toml":
        raise UsageError(
            f"{results}: is a case: name the results file that vibeam run makes of it, or vibeam explore it"
        )
    found = stored(results, None if case is None else load(case))
    rows = "curves" if found.result.case.record is None else "motions"
    wanted = (f"{results.stem}_{rows}.csv", (".csv",), "a table")
    path = output_path(out, *(wanted if csv else (f"{results.stem}.html", PAGES, "a page")))
    if csv:
        from vibeam.report.result_tables import many_energies, write_tables

        left_out = [] if verbosity().verbose else many_energies(found.result)
        files = write_tables(found.result, path, left_out)
        if left_out:
            tell(f"{left_out[0]} to {left_out[-1]} are left out: -v writes them")
    else:
        from vibeam.exchange.whole_files import write_whole

        write_whole(path, _page(found, no_engine).encode())
        files = [path]
    if verbosity().json:
        print_json({"files": files})
    else:
        put_lines(map(str, files))


def _page(found: StoredResult, no_engine: bool) -> str:
    """Page of results; without an engine where the libraries of pages are missing, which is told."""
    from vibeam.flight.engine.loading import KernelsUnavailable
    from vibeam.report.page.page import page

    try:
        return page(found, engine=not no_engine)
    except KernelsUnavailable as why:
        say(f"the page has no engine: {why}")
        return page(found)
