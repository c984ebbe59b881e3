"""``vibeam new``: a template of a case file."""

from __future__ import annotations

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
    as_json: AsJson = False,
) -> None:
    """Write a case to start from, every key explained; never over a file that is there."""
    from vibeam.casefile.documentation import template

    target = output_path(out or path, "case.toml", (".toml",), "a case file")
    try:
        with target.open("x", encoding="utf-8") as file:
            file.write(template())
    except FileExistsError:
        raise UsageError(f"{target}: is there already: name another file") from None
    (say if as_json else put)(f"wrote {target}: edit it, then: vibeam run {target}")
    print_result({"written": target}, as_json)
