"""``vibeam fit``: keys of a case from what was measured."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import Overrides, TableFile, argument, load, option, output_path, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_sheet
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked
from vibeam.cli.study_command import ENDINGS, files_of
from vibeam_models.extensions import absent

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.cli.parts import Asked
    from vibeam.report.output import StudySheet


_KEY = "Of a case: a key, from its modal frequencies. Repeatable."
_MEASURED = "With --key: a [measured.NAME] to use; absent = all modes."


def fit(
    file: Annotated[Path, argument("A case (.toml), or a measured signal.", "FILE")],
    set_: Overrides = None,
    out: TableFile = None,
    next_: Annotated[bool, typer.Option("--next", help="Of a case: also say what to measure next.")] = False,
    write: Annotated[Path | None, option("Also write the case with the estimates.", "--write", metavar="FILE")] = None,
    key: Annotated[list[str] | None, option(_KEY, "--key", metavar="KEY")] = None,
    measured: Annotated[list[str] | None, option(_MEASURED, "--measured", metavar="NAME")] = None,
    price: PriceOption = False,
    part: PartOption = None,
    gather: GatherOption = False,
) -> None:
    """Estimate keys of a case from measurements, with intervals.

    Those of [fit] from its measured responses, or those named by --key from its measured modal frequencies.

    \b
    Examples:
      vibeam fit cases/synthetic/fit.toml --next
    """
    shared = part_asked(price, part, gather)
    of_responses = {"--next": next_, "--write": write, "--price": price, "--part": part, "--gather": gather}
    if file.suffix != ".toml":
        said = absent("vibeam fit FILE") or "name a case (.toml)"
        raise UsageError(f"{file}: is no case; what a measured signal fits is not known to the core: {said}")
    if key or measured:
        faults = [] if key else ["--measured: name the keys that they give, --key beam.thickness"]
        refuse_options(file, of_responses, "does not go with --key", faults)
        case = load(file, set_)
        show_identified(file, lambda: _of_modes(case, key or [], measured or []), out)
    else:
        _of_responses(file, set_, out, next_, write, shared)


def refuse_options(file: Path, options: dict[str, Any], why: str, faults: list[str] | None = None) -> None:
    """UsageError with all options that are given in vain, and further ``faults``."""
    given = [f"{name} {why}: leave it out" for name, value in options.items() if value or type(value) in (float, str)]
    if found := [*given, *(faults or [])]:
        raise UsageError("\n".join(f"{file}: {each}" for each in found))


def _of_modes(case: Case, keys: list[str], measured: list[str]) -> tuple[str, StudySheet]:
    """Method and sheet of the fit of keys to modal frequencies."""
    from vibeam.report.fit import identification_sheet
    from vibeam.studies.fit.modal_keys import identify_keys

    found = identify_keys(case, keys, measured)
    return found.method, identification_sheet(found)


def show_identified(file: Path, identified: Callable[[], tuple[str, StudySheet]], out: str | None) -> None:
    """Print the sheet of an identification; its table, or page by its method, is written where a file is asked for."""
    from vibeam.case.plans import FigurePlan

    path = None if out is None else output_path(out, f"{file.stem}_identified.csv", ENDINGS, "a table or page")
    method, sheet = of_case(file, identified)
    print_sheet(sheet, [] if path is None else files_of(sheet, path, file.stem, method, FigurePlan()))


def _of_responses(
    file: Path, set_: list[str] | None, out: str | None, next_: bool, write: Path | None, shared: Asked
) -> None:  # fmt: skip
    """Fit the keys of [fit] to the responses of a case, or do the part of it that is asked."""
    from vibeam.cli.progress import stderr
    from vibeam.exchange.whole_files import write_whole
    from vibeam.report.fit import sheet
    from vibeam.studies.fit import study as fits

    loaded = load(file, set_)
    path = table_path(loaded, out, "fit", ENDINGS)
    if write is not None:
        _require_new(loaded, write, set_)
    with in_parts("fit", path, shared) as rounds:
        study = of_case(file, lambda: fits.fit(loaded, stderr().print, next_point=next_))
    found = sheet(study)
    files = files_of(found, path, loaded.title, "keys estimated from measured responses", loaded.figure)
    if write is not None:
        write_whole(write, of_case(file, lambda: fits.estimated_case(study)).encode())
        files.append(write)
    rounds.discard()
    print_sheet(found, files)


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
