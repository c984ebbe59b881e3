"""``vibeam check``: references, regression values and measured numbers of a case; the record of its curves as such."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import (
    RESULTS,
    CaseFiles,
    Fidelities,
    Fresh,
    Overrides,
    ResultsFile,
    folder,
    load,
    of_fidelities,
    option,
    output_path,
    results_path,
    run_case,
)
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_sheet
from vibeam.cli.several import answers, require_folder
from vibeam.cli.streams import MISSED

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.report.output import StudySheet

    Answer = tuple[StudySheet, list[Path]]

DRAWN = (".png", ".svg", ".pdf")

_PLOT = "Draw references and model (.png, .svg, .pdf), or the folder for it."


def check(
    cases: CaseFiles,
    set_: Overrides = None,
    out: ResultsFile = None,
    fresh: Fresh = False,
    fidelity: Fidelities = None,
    plot: Annotated[str | None, option(_PLOT, "--plot", metavar="FILE")] = None,
    write: Annotated[bool, option("Write the curves as regression values, into --out.", "--write")] = False,
    force: Annotated[bool, option("With --write: replace files that are there.", "--force")] = False,
) -> None:
    """Say whether references and measured numbers hold.

    References are compared at their own frequencies. Exit code 1 where one is missed, of several cases in any. What
    --write writes goes into references/ beside the case where no --out says otherwise.

    \b
    Examples:
      vibeam check mine.toml --plot check.png
      vibeam check *.toml
      vibeam check mine.toml --write --fidelity sdof
    """
    if force and not write:
        raise UsageError("--force: replaces files of --write, which is not asked for")
    if found := [name for name, given in (("--plot", plot), ("--fresh", fresh)) if write and given]:
        raise UsageError("\n".join(f"{name}: of a check, and --write makes none: leave it out" for name in found))

    def prepared(path: Path) -> Case:
        case = of_fidelities(load(path, set_), fidelity)
        if plot is not None and not (case.references or any(each.file for each in case.inputs.values())):
            raise UsageError("--plot: draws references and drive.file, and this one has none: write a [reference.NAME]")
        return case

    def answer(case: Case) -> Answer:
        if write:
            return _recorded(case, out, force)
        path = None if plot is None else output_path(plot, f"{case.path.stem}_check.png", DRAWN, "a figure")
        return _checked(case, out, fresh, set_ or [], path)

    if len(cases) > 1:
        require_folder("--out", out, RESULTS)
        require_folder("--plot", plot, DRAWN)
        made = answers("checks", cases, prepared, answer, whole=True)
        missed = sum(each.get("missed", 0) for each in made.values())
    else:
        sheet, files = answer(prepared(cases[0]))
        print_sheet(sheet, files)
        missed = sheet.data.get("missed", 0)
    if missed:
        raise typer.Exit(MISSED)


def _checked(case: Case, out: str | None, fresh: bool, set_: list[str], path: Path | None) -> Answer:
    """Report of a check, and its files: references are drawn to ``path``."""
    from vibeam.report.checks import check_report
    from vibeam.report.measured import write_measured
    from vibeam.runs.systems import require_runnable

    if not (case.references or case.expectations or case.measured):
        if case.record is None:
            require_runnable(case)
        return check_report([], []), write_measured(case, path)
    from vibeam.case.held import held_of
    from vibeam.figures.units import units_of
    from vibeam.runs.summary import remarks
    from vibeam.studies.regression.check import at_references, check_expectations, compare_measured
    from vibeam.studies.regression.references import check as check_references
    from vibeam.studies.regression.references import require_readable

    require_readable(case)
    result = run_case(case, None if out is None else results_path(case, out), show=False, fresh=fresh)
    partial = any(each.strip().startswith("sweep") for each in set_)
    at = at_references(case, result, partial=partial)
    rows = check_references(case, result, partial=partial, at=at)
    rows += check_expectations(case, result, partial=bool(set_))
    held = held_of(case.scene).label if any(each.against for each in case.expectations.values()) else ""
    if path is not None and case.references:
        from vibeam.figures.page import write_page
        from vibeam.report.references import references_figure

        write_page(lambda: references_figure(case, rows, at), [path])
    measured, files = compare_measured(case, result), write_measured(case, path)
    if case.record is not None:
        from vibeam.report.transient import remarks as remarks_of

        return check_report(rows, measured, held=held, remarks=list(remarks_of(result))), files
    return check_report(rows, measured, units_of(case), held, remarks(result)), files


def _recorded(case: Case, out: str | None, force: bool) -> Answer:
    """Write the curves of a case as regression values; the tables that check them, and the files."""
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.output import StudySheet
    from vibeam.studies.regression.recorded_curves import recorded_answer, recorded_curves

    _ = case.sweep  # curves over frequency: a record case has none
    place = case.path.parent / "references" if out is None else Path(out)
    files = {name: place / f"{case.path.stem}_{name}.csv" for name in case.fidelities}
    there = [str(file) for file in files.values() if file.exists()]
    if there and not force:
        raise UsageError(f"{', '.join(there)}: is there already: --force replaces it, --out FOLDER writes elsewhere")
    result = run_case(case, None, show=False)
    folder(place)
    for name, file in files.items():
        write_whole(file, recorded_curves(result, name).encode())
    return StudySheet(recorded_answer(case, files)), list(files.values())
