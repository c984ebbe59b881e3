"""``vibeam fit`` and ``identify``: keys of a case, and linear parameters, from what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import CaseFile, Overrides, TableFile, load, output_path, run_study, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result, print_sheet, write_table

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.identification.estimates import Identification


def fit(
    case: CaseFile,
    set_: Overrides = None,
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


KINDS = ("decay", "spectrum", "response")


def identify(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A case (.toml), or a measured signal (CSV, .mat …).")],
    set_: Overrides = None,
    key: Annotated[
        list[str] | None, typer.Option("--key", help="Of a case: a key to identify. Repeatable.", show_default=False)
    ] = None,
    measured: Annotated[
        list[str] | None,
        typer.Option("--measured", help="Of a case: a [measured.NAME] to use; absent = all modes.", show_default=False),
    ] = None,
    of: Annotated[
        str | None, typer.Option("--of", help="Of a signal: decay, spectrum or response.", show_default=False)
    ] = None,
    x: Annotated[
        str | None, typer.Option("--x", help="Its column of time or frequency; absent = the usual.", show_default=False)
    ] = None,
    y: Annotated[
        str | None, typer.Option("--y", help="Its column of values; absent = the usual.", show_default=False)
    ] = None,
    drive: Annotated[
        str, typer.Option("--drive", help="Of a response: base displacement, base acceleration or force.")
    ] = "base displacement",
    level: Annotated[float, typer.Option("--level", help="Of a response: amplitude of the drive.")] = 1.0,
    out: TableFile = None,
) -> None:
    """Identify linear parameters, with 95 % intervals.

    Of a measured signal: natural frequency, damping ratio, gain. Of a case: keys from its measured modal frequencies.
    """
    if file.suffix == ".toml":
        from vibeam.studies.identification.modes import identify_keys

        if of is not None:
            raise UsageError(f"--of {of}: is of a signal, and {file} is a case: name keys, --key beam.thickness")
        loaded = load(file, set_)
        found = of_case(file, lambda: identify_keys(loaded, key or [], measured or []))
    else:
        found = _of_signal(file, of, (x, y), drive, level, bool(key or measured or set_))
    path = None if out is None else output_path(out, f"{file.stem}_identified.csv", (".csv",), "a table")
    write_table(found.rows, path)
    print_result(found, lambda tables: [tables.identified(found)], [*found.directions, *found.notes])


def _of_signal(
    file: Path, of: str | None, columns: tuple[str | None, str | None], drive: str, level: float, of_case_too: bool
) -> Identification:
    from vibeam.exchange.faults import suggest
    from vibeam.studies.identification.estimates import read_signal
    from vibeam.studies.identification.response import identify_decay, identify_response, identify_spectrum

    if of_case_too:
        raise UsageError(f"{file}: --key, --measured and --set are of a case (.toml)")
    if of not in KINDS:
        said = "missing: which it is, --of decay" if of is None else f"--of {of}: {suggest(of, KINDS)}"
        raise UsageError(f"{file}: {said}, spectrum or response" if of is None else said)
    at, value, uncertainty = read_signal(file, "time" if of == "decay" else "frequency", *columns)
    if of == "decay":
        return of_case(file, lambda: identify_decay(at, value))
    if of == "spectrum":
        return of_case(file, lambda: identify_spectrum(at, value, uncertainty=uncertainty))
    return of_case(file, lambda: identify_response(at, value, drive=drive, level=level, uncertainty=uncertainty))
