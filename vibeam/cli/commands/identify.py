"""``vibeam identify``: linear parameters of a measured signal, or keys of a case from its measured modes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import AsJson, Overrides, TableFile, load, output_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result, write_table

if TYPE_CHECKING:
    from vibeam.studies.identification.estimates import Identification

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
    as_json: AsJson = False,
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
    print_result(found, as_json, lambda tables: [tables.identified(found)], [*found.directions, *found.notes])


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
