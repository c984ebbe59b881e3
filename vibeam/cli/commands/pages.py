"""``vibeam report`` and ``explore``: pages of results and of cases, tables of results."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import CaseFile, Fidelities, Overrides, load, of_fidelities, option, out_option, output_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_json, put_lines
from vibeam.cli.streams import say, tell
from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from vibeam.runs.stored_result import StoredResult


PAGES = (".html", ".htm")
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
    from vibeam.report.explore.page import results_page
    from vibeam.report.page.page import page

    try:
        return page(found) if no_engine else results_page(found)
    except KernelsUnavailable as why:
        say(f"the page has no engine: {why}")
        return page(found)


def explore(
    case: CaseFile,
    set_: Overrides = None,
    out: Annotated[str | None, out_option("The page (.html), or the folder for it.")] = None,
    fidelity: Fidelities = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Write the page, and open no browser.")] = False,
) -> None:
    """Fly a case in a page as its sliders move, without a sweep.

    The page holds the exact engine: frequency, drive, gap, restitution and damping are sliders, and a button writes the
    case at them. It is one file and needs no network. A browser opens it where the terminal has a display.

    \b
    Examples:
      vibeam explore mine.toml
      vibeam explore mine.toml --fidelity beam --set stop.gap='0.05 mm' --no-open
    """
    path = output_path(out, f"{case.stem}_explore.html", PAGES, "a page")
    found = of_fidelities(load(case, set_), fidelity)
    from vibeam.report.explore.exploration import exploration

    made = of_case(case, lambda: exploration(found))
    made.write(path)
    if verbosity().json:
        print_json({"files": [path], "flown": made.flown, "refused": made.refused})
        return
    put_lines([str(path)])
    for name, why in made.refused.items() if not verbosity().quiet else ():
        say(f"{name}: {why}")
    if not no_open and _display():
        import webbrowser

        webbrowser.open(path.resolve().as_uri())


def _display() -> bool:
    """Test whether somebody is there to look at a page: a terminal with a display, and no automation."""
    shown = sys.platform in ("darwin", "win32") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(shown) and sys.stdout.isatty() and not os.environ.get("CI")
