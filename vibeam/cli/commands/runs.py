"""``vibeam run``, ``check``, ``record`` and ``report``: results of a case, what holds of them, and their page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import (
    CaseFile,
    Fresh,
    Overrides,
    ResultsFile,
    folder,
    load,
    output_path,
    results_path,
    run_case,
)
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result
from vibeam.cli.streams import MISSED, put, say

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.studies.regression.references import CheckRow


def run(case: CaseFile, set_: Overrides = None, out: ResultsFile = None, fresh: Fresh = False) -> None:
    """Sweep every fidelity of a case, or continue a results file."""
    loaded = load(case, set_)
    from vibeam.studies.regression.references import require_readable

    require_readable(loaded)
    if any(plan.format for plan in loaded.shows.values()):
        from vibeam.figures.moving import require_programs

        of_case(loaded.path, lambda: require_programs(loaded))
    path = results_path(loaded, out)
    _report(run_case(loaded, path, fresh=fresh, compare=True), path)


def _report(result: Result, path: Path) -> None:
    from vibeam.report.figures import write_figures
    from vibeam.report.run_report import run_report
    from vibeam.runs.estimate.records import estimate_texts
    from vibeam.runs.summary import compare, remarks

    files = [path, *write_figures(result, path)]
    whole = {"fidelities": compare(result), "remarks": remarks(result), "found": result.found, "total": result.total}
    whole |= {"files": files, "comparisons": result.comparisons}
    more = {"curves": result.curves, "estimates": estimate_texts(result.estimates).rows, "accuracy": result.accuracy}
    whole |= {name: value for name, value in more.items() if value}
    found = run_report(result)
    print_result(whole, lambda _: found.tables, [*found.notes, *files], filter(None, [found.answer]))


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
        print_result([])
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
        [*rows, *measured], lambda _: verdicts(rows, measured, units),
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


def record(
    case: CaseFile,
    set_: Overrides = None,
    out: Annotated[
        str | None,
        typer.Option(
            "--out", metavar="FOLDER", help="Where the files go; absent = references/ beside the case.",
            show_default=False,
        ),
    ] = None,
    fidelity: Annotated[
        str | None, typer.Option("--fidelity", help="This one alone; absent = all.", show_default=False)
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:  # fmt: skip
    """Write the curves of a case as regression values.

    Never over a file that is there, unless by --force.
    """
    loaded = load(case, set_)
    from vibeam.casefile.read import without_accuracy
    from vibeam.exchange.faults import suggest
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.checks import record as recorded

    if fidelity is not None and fidelity not in loaded.fidelities:
        raise UsageError(f"--fidelity {fidelity}: no such fidelity; {suggest(fidelity, loaded.fidelities)}")
    loaded = without_accuracy(loaded)
    names = [fidelity] if fidelity else list(loaded.fidelities)
    place = loaded.path.parent / "references" if out is None else Path(out)
    files = {name: place / f"{loaded.path.stem}_{name}.csv" for name in names}
    there = [str(file) for file in files.values() if file.exists()]
    if there and not force:
        raise UsageError(f"{', '.join(there)}: is there already: --force replaces it, --out FOLDER writes elsewhere")
    wanted = replace(loaded, fidelities={name: loaded.fidelities[name] for name in names})
    result = run_case(wanted, None, show=False)
    folder(place)
    for name, file in files.items():
        write_whole(file, recorded(result, name).encode())
    written = list(files.values())
    print_result({"files": written}, notes=[*written, *_table(loaded.path.parent, files)])


def _table(home: Path, files: dict[str, Path]) -> list[str]:
    """Tables that check the case against the files."""
    lines = ["", "The tables that check them:", ""]
    for name, file in files.items():
        shown = file.relative_to(home) if file.is_relative_to(home) else file.absolute()
        lines += [f"[reference.{name}_before]", f'file = "{shown.as_posix()}"', f'fidelity = "{name}"']
        lines += ['quantity = "amplitude"', 'tolerance = "0.001 %"', ""]
    return lines


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
