"""``vibeam new``: a template of a case file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_result
from vibeam.cli.streams import put, say


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
    as_json: AsJson = False,
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
    (say if as_json else put)(f"wrote {target}{beside}: edit it, then: vibeam run {target}")
    print_result({"written": target}, as_json)


def _write(file: Path, text: str) -> None:
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except FileExistsError:
        raise UsageError(f"{file}: is there already: name another file") from None
