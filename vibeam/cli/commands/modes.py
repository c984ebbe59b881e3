"""``vibeam modes``: the table of modes, and their shapes."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, load, output_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_result
from vibeam.cli.streams import say


def modes(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        str | None, typer.Option("--out", metavar="FILE", help="The VTU file of the mode shapes, or the folder for it.")
    ] = None,
    count: Annotated[int, typer.Option("--count", min=1, help="How many modes.")] = 10,
) -> None:
    """Tabulate the modes of the finite-element beam.

    Each stands with the restitution of mode 1 in a model that is cut off after it.
    """
    from vibeam.studies.modes import mode_table, write_shapes

    loaded = load(case, set_)
    path = (
        None if out is None else output_path(out, f"{loaded.path.stem}_modes.vtu", (".vtu",), "a file of mode shapes")
    )
    table = of_case(case, lambda: mode_table(loaded.scene, count))
    if path is not None:
        write_shapes(table, path)
        say(f"wrote {path}")
    print_result(table.rows, as_json, lambda tables: [tables.modal(table)], table.notes)
