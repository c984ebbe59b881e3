"""``vibeam fit``: keys of a case, and linear parameters of a signal, from what was measured."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.arguments import Overrides, TableFile, argument, load, option, output_path, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_sheet
from vibeam.cli.parts import GatherOption, PartOption, PriceOption, in_parts, part_asked
from vibeam.cli.study_command import ENDINGS, files_of

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.cli.parts import Asked
    from vibeam.studies.identification.estimates import Identification


_KEY = "Of a case: a key, from its modal frequencies. Repeatable."
_MEASURED = "With --key: a [measured.NAME] to use; absent = all modes."
_OF = "Of a signal: decay, spectrum or response; absent = found out."
_DRIVE = "Of a response: base displacement, base acceleration or force."
_LEVEL = "Of a response: amplitude of the drive, or 1."


def fit(
    file: Annotated[Path, argument("A case (.toml), or a measured signal.", "FILE")],
    set_: Overrides = None,
    out: TableFile = None,
    next_: Annotated[bool, typer.Option("--next", help="Of a case: also say what to measure next.")] = False,
    write: Annotated[Path | None, option("Also write the case with the estimates.", "--write", metavar="FILE")] = None,
    key: Annotated[list[str] | None, option(_KEY, "--key", metavar="KEY")] = None,
    measured: Annotated[list[str] | None, option(_MEASURED, "--measured", metavar="NAME")] = None,
    of: Annotated[str | None, option(_OF, "--of", metavar="KIND")] = None,
    x: Annotated[str | None, option("Its column of time or frequency.", "--x", metavar="HEAD")] = None,
    y: Annotated[str | None, option("Its column of values.", "--y", metavar="HEAD")] = None,
    from_: Annotated[str | None, option("Its first time or frequency taken.", "--from", metavar="TIME")] = None,
    to: Annotated[str | None, option("Its last time or frequency taken.", "--to", metavar="TIME")] = None,
    drive: Annotated[str | None, option(_DRIVE, "--drive", metavar="KIND")] = None,
    level: Annotated[float | None, option(_LEVEL, "--level", metavar="NUMBER")] = None,
    price: PriceOption = False,
    part: PartOption = None,
    gather: GatherOption = False,
) -> None:
    """Estimate parameters from measurements, with intervals.

    Of a case the keys of [fit] from its measured responses, or those named by --key from its measured modal
    frequencies. Of a file with a decay, a spectrum or a response natural frequency, damping and gain.

    \b
    Examples:
      vibeam fit cases/synthetic/fit.toml --next
      vibeam fit decay.csv --x "t [s]" --y "u [mm]"
    """
    from vibeam.studies.identification.modes import identify_keys
    from vibeam.studies.identification.signal_kind import identify_stretch

    of_signal = {"--of": of, "--x": x, "--y": y, "--from": from_, "--to": to, "--drive": drive, "--level": level}
    of_modes = {"--key": key, "--measured": measured}
    shared = part_asked(price, part, gather)
    of_responses = {"--next": next_, "--write": write, "--price": price, "--part": part, "--gather": gather}
    if file.suffix != ".toml":
        of_cases = {**of_responses, **of_modes, "--set": set_}
        _require(file, of_cases, "is of a case, which ends in .toml", _faults(of, drive, level))
        _show(file, lambda: identify_stretch(file, from_, to, of=of, x=x, y=y, drive=drive, level=level), out)
    elif key or measured:
        faults = [] if key else ["--measured: name the keys that they give, --key beam.thickness"]
        _require(file, {**of_responses, **of_signal}, "does not go with --key", faults)
        case = load(file, set_)
        _show(file, lambda: identify_keys(case, key or [], measured or []), out)
    else:
        _require(file, of_signal, "is of a signal, and this is a case")
        _of_responses(file, set_, out, next_, write, shared)


def _require(file: Path, options: dict[str, Any], why: str, faults: list[str] | None = None) -> None:
    """UsageError with all options that are given in vain, and further ``faults``."""
    given = [f"{name} {why}: leave it out" for name, value in options.items() if value or type(value) in (float, str)]
    if found := [*given, *(faults or [])]:
        raise UsageError("\n".join(f"{file}: {each}" for each in found))


def _faults(of: str | None, drive: str | None, level: float | None) -> list[str]:
    """Faults of the options of a signal."""
    from vibeam.exchange.faults import suggest
    from vibeam.studies.identification.response import DRIVES
    from vibeam.studies.identification.signal_kind import KINDS

    found = []
    if of is not None and of not in KINDS:
        found.append(f"--of {of}: {suggest(of, KINDS)}")
    elif of in KINDS[:2]:
        given = [name for name, value in (("--drive", drive), ("--level", level)) if value is not None]
        found += [f"{name} is of a response, and --of says {of}: leave one of them out" for name in given]
    if drive is not None and drive not in DRIVES:
        found.append(f"--drive {drive}: {suggest(drive, DRIVES)}")
    if level is not None and not (isfinite(level) and level > 0):
        found.append(f"--level {level:g} must be above 0")
    return found


def _show(file: Path, identified: Callable[[], Identification], out: str | None) -> None:
    """Print an identification; its table or page is written where a file is asked for."""
    from vibeam.case.plans import FigurePlan
    from vibeam.report.fit import identification_sheet

    path = None if out is None else output_path(out, f"{file.stem}_identified.csv", ENDINGS, "a table or page")
    found = of_case(file, identified)
    sheet = identification_sheet(found)
    print_sheet(sheet, [] if path is None else files_of(sheet, path, file.stem, found.method, FigurePlan()))


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
