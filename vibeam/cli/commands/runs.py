"""``vibeam run``: results of cases, of one or of several."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import (
    RESULTS,
    Fidelities,
    Fresh,
    Overrides,
    ResultsFile,
    folder,
    load,
    number,
    of_fidelities,
    option,
    results_path,
    run_case,
)
from vibeam.cli.errors import UsageError, fault_of
from vibeam.cli.output import as_object, print_json, print_sheet, put_lines
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked
from vibeam.cli.streams import WRONG, say
from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.report.output import StudySheet


_ACCURACY = "What suffices; absent = that of the case, else 5 %."


def run(
    cases: Annotated[
        list[Path],
        typer.Argument(metavar="CASE...", help="The case file (TOML), or several."),
    ],
    set_: Overrides = None,
    out: ResultsFile = None,
    fresh: Fresh = False,
    fidelity: Fidelities = None,
    accuracy: Annotated[str | None, option(_ACCURACY, "--accuracy", metavar="PERCENT")] = None,
    price: PriceOption = False,
    part: PartOption = None,
    gather: GatherOption = False,
) -> None:
    """Say which fidelity suffices: sweep all, compare, store.

    A run that was stopped goes on where it was; after an edit of the case, what it does not change is kept, and results
    that would be lost are kept aside (NAME.1.h5). Of several cases --out names a folder, and a line each is printed.
    Realisations of a [record] are computed in parts, here or on a cluster, by --part.

    \b
    Examples:
      vibeam run mine.toml
      vibeam run *.toml --accuracy "2 %" --out results/
    """
    from vibeam.casefile.quantities import RATIO

    asked = part_asked(price, part, gather, {"--fresh": fresh, "several cases": len(cases) > 1})
    within = None if accuracy is None else number("--accuracy", accuracy, RATIO, positive=True)
    if within is not None and within >= 1:
        raise UsageError(f"--accuracy {accuracy}: must lie between 0 and 100 %: write '5 %' or 0.05")
    if len(cases) > 1:
        _run_several(cases, (set_, out, fidelity), fresh, within)
        return
    case = _runnable(cases[0], set_, fidelity)
    path = results_path(case, out)
    if asked is None:
        print_sheet(*_swept(case, path, fresh, within))
        return
    if case.record is None:
        raise UsageError("--price, --part, --gather: of a case with [record]; points of a [sweep] follow each other")
    with in_parts("run", path, asked) as shared:
        run_case(case, path if asked == "gather" else None, show=False)
    sheet, files = _swept(case, path, fresh, within)
    shared.discard()
    print_sheet(sheet, files)


def _runnable(path: Path, settings: list[str] | None, fidelities: Sequence[str] | None) -> Case:
    """The case, whose references can be read."""
    from vibeam.studies.regression.references import require_readable

    case = of_fidelities(load(path, settings), fidelities)
    require_readable(case)
    return case


def _swept(case: Case, path: Path, fresh: bool, within: float | None) -> tuple[StudySheet, list[Path]]:
    """Report of the run of a case, and the files written."""
    result = run_case(case, path, fresh=fresh, compare=True)
    from vibeam.report.figures import write_figures

    if case.record is not None:
        from vibeam.report.transient import transient_report as report
    else:
        from vibeam.report.run_report import run_report as report  # type: ignore[assignment]
    made: Any = result
    return report(made, within), [path, *write_figures(made, path)]


def _run_several(
    paths: Sequence[Path], of: tuple[list[str] | None, str | None, list[str] | None], fresh: bool, within: float | None
) -> None:
    """Run cases one after the other, each into a file of its own: all faults first, then a line each."""
    from vibeam.runs.systems import require_runnable

    settings, out, fidelities = of
    if out is not None and Path(out).suffix in RESULTS and not Path(out).is_dir():
        raise UsageError(f"--out {out}: names a folder where there are several cases")
    for stem in {path.stem for path in paths}:
        if len(same := [str(path) for path in paths if path.stem == stem]) > 1:
            raise UsageError(f"{', '.join(same)}: all write {stem}.h5: run them apart, each with an --out of its own")
    place = Path() if out is None else folder(Path(out))
    cases: dict[Path, Case] = {}
    found: dict[Path, dict[str, Any]] = {}
    for path in paths:
        with _noting(found, path):
            cases[path] = _runnable(path, settings, fidelities)
            require_runnable(cases[path])
    for path, case in cases.items():
        if path not in found:
            if not verbosity().quiet:
                say(f"{path}:")
            with _noting(found, path):
                found[path] = as_object(*_swept(case, place / f"{path.stem}.h5", fresh, within))
    if verbosity().json:
        print_json({"runs": [{"case": path, **found[path]} for path in paths]})
    else:
        put_lines(f"{path}: {_line(path, found[path])}" for path in paths)
    if any("error" in each for each in found.values()):
        raise typer.Exit(WRONG)


@contextmanager
def _noting(found: dict[Path, dict[str, Any]], path: Path) -> Iterator[None]:
    """Context that tells a user's mistake on stderr and keeps it as what was ``found``, in place of ending all."""
    try:
        yield
    except Exception as error:
        fault = fault_of(error)
        if fault is None:
            raise
        said = fault[0] if str(path) in fault[0] else f"{path}: {fault[0]}"
        say(said)
        found[path] = {"error": said, "faults": getattr(error, "faults", ())}


def _line(path: Path, found: Mapping[str, Any]) -> str:
    """Answer of one case of several, or why there is none."""
    if "error" not in found:
        return str(found["answer"])
    first, _, rest = found["error"].removeprefix(f"{path}: ").partition("\n")
    return f"not run: {first}" + f" (and {rest.count(chr(10)) + 1} more)" * bool(rest)
