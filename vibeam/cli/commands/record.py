"""``vibeam record``: the curves of a case as reference files, with their provenance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, folder, load, run_case
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_result


def record(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
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
    from dataclasses import replace

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
    print_result({"files": written}, as_json, notes=[*written, *_table(loaded.path.parent, files)])


def _table(home: Path, files: dict[str, Path]) -> list[str]:
    """Tables that check the case against the files."""
    lines = ["", "The tables that check them:", ""]
    for name, file in files.items():
        shown = file.relative_to(home) if file.is_relative_to(home) else file.absolute()
        lines += [f"[reference.{name}_before]", f'file = "{shown.as_posix()}"', f'fidelity = "{name}"']
        lines += ['quantity = "amplitude"', 'tolerance = "0.001 %"', ""]
    return lines
