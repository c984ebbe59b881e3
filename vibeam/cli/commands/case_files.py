"""``vibeam new``, ``keys`` and ``doctor``: a case to start from, its keys, and whether the installation is whole."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import TableFile, output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_json, print_result, write_table
from vibeam.cli.streams import MISSED, put, put_json, say
from vibeam.cli.verbosity import verbosity


def keys(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="A table, stop, or a key, stop.gap; absent = all.", show_default=False),
    ] = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON schema of case files, for editors.")] = False,
    out: TableFile = None,
) -> None:
    """Every key of a case file: what it means, its unit, its default."""
    from vibeam.casefile.documentation import reference_table, rows_of
    from vibeam.report import output

    if schema:
        from vibeam.casefile.documentation import case_schema

        put_json(output.to_json(case_schema()))
        return
    try:
        rows = reference_table() if name is None else rows_of(name)
    except ValueError as unknown:
        raise UsageError(str(unknown)) from None
    write_table(rows, None if out is None else output_path(out, "keys.csv", (".csv",), "a table"))
    print_result(rows, lambda tables: [tables.keys(rows)])


def new(
    path: Annotated[str, typer.Argument(metavar="FILE", help="The case file to write, or its folder.")] = "case.toml",
    out: Annotated[
        str | None, typer.Option("--out", metavar="FILE", help="The same, as an option.", show_default=False)
    ] = None,
    rig: Annotated[
        str,
        typer.Option(
            "--rig", metavar="NAME", help="What the case is of: cantilever, tube, two-beams, matrices or modes."
        ),
    ] = "cantilever",
) -> None:
    """Write a case to start from, every key explained; never over a file that is there."""
    from vibeam.casefile.documentation import template
    from vibeam.casefile.rigs import RIGS
    from vibeam.exchange.faults import suggest

    if rig not in RIGS:
        raise UsageError(f"--rig {rig}: no such rig; {suggest(rig, RIGS)}")
    target = output_path(out or path, "case.toml", (".toml",), "a case file")
    texts = {target.with_name(name): text for name, text in RIGS[rig].files.items()} | {target: template(rig)}
    for file in texts:
        if file.exists():
            raise UsageError(f"{file}: is there already: name another file, or folder")
    for file, text in texts.items():
        _write(file, text)
    beside = f" and {', '.join(RIGS[rig].files)} beside it" if RIGS[rig].files else ""
    (say if verbosity().json else put)(f"wrote {target}{beside}: edit it, then: vibeam run {target}")
    print_result({"written": target})


def _write(file: Path, text: str) -> None:
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except FileExistsError:
        raise UsageError(f"{file}: is there already: name another file") from None


def doctor() -> None:
    """Examine the installation: versions, machine, kernels, folders, and known motions.

    Exit code 1 where there is a fault.
    """
    from vibeam.studies.doctor import Severity, examine, verdict

    findings, form = examine(), verbosity()
    faults = sum(each.state is Severity.FAULT for each in findings)
    if form.json:
        print_json({"answer": verdict(findings), "faults": faults, "findings": findings})
    else:
        right = () if form.verbose else (Severity.GOOD, Severity.FACT)
        shown = () if form.quiet else [each for each in findings if each.state not in right]
        put(verdict(findings))
        for topic, group in groupby(shown, key=lambda each: each.topic):
            put("\n".join([topic, *(f"  {each}" for each in group)]))
        if right and not form.quiet:
            put("more: -v")
    if faults:
        raise typer.Exit(MISSED)
