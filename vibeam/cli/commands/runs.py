"""``vibeam run``: results of cases, of one or of several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from vibeam.cli.arguments import (
    RESULTS,
    CaseFiles,
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
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_sheet
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked
from vibeam.cli.several import answers, require_folder
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.report.output import StudySheet


_ACCURACY = "What suffices; absent = that of the case, else 5 %."


def run(
    cases: CaseFiles,
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
    from vibeam.studies.regression.references import require_readable

    asked = part_asked(price, part, gather, {"--fresh": fresh, "several cases": len(cases) > 1})
    within = None if accuracy is None else number("--accuracy", accuracy, RATIO, positive=True)
    if within is not None and within >= 1:
        raise UsageError(f"--accuracy {accuracy}: must lie between 0 and 100 %: write '5 %' or 0.05")

    def prepared(path: Path) -> Case:
        case = of_fidelities(load(path, set_), fidelity)
        if within is not None:
            case = replace(case, asked={**case.asked, "verdict": replace(case.asked["verdict"], accuracy=within)})
        require_readable(case)
        if len(cases) > 1:
            loaded("vibeam.runs.systems:require_runnable")(case)
        return case

    if len(cases) > 1:
        place = _shared_folder(cases, out)
        answers("runs", cases, prepared, lambda case: _swept(case, place / f"{case.path.stem}.h5", fresh))
        return
    case = prepared(cases[0])
    path = results_path(case, out)
    if asked is None:
        print_sheet(*_swept(case, path, fresh))
        return
    if case.record is None:
        raise UsageError("--price, --part, --gather: of a case with [record]; points of a [sweep] follow each other")
    with in_parts("run", path, asked) as shared:
        run_case(case, path if asked == "gather" else None, show=False)
    sheet, files = _swept(case, path, fresh)
    shared.discard()
    print_sheet(sheet, files)


def _swept(case: Case, path: Path, fresh: bool) -> tuple[StudySheet, list[Path]]:
    """Report of the run of a case, and the files written."""
    result = run_case(case, path, fresh=fresh, compare=True)
    from vibeam.report.figures import write_figures

    swept = case.record is None
    report = loaded("vibeam.report.run_report:run_report" if swept else "vibeam.report.transient:transient_report")
    return report(result), [path, *write_figures(result, path)]


def _shared_folder(paths: Sequence[Path], out: str | None) -> Path:
    """Folder of the results of cases; UsageError where not each has a file of its own there."""
    require_folder("--out", out, RESULTS)
    for stem in {path.stem for path in paths}:
        if len(same := [str(path) for path in paths if path.stem == stem]) > 1:
            raise UsageError(f"{', '.join(same)}: all write {stem}.h5: run them apart, each with an --out of its own")
    return Path() if out is None else folder(Path(out))
