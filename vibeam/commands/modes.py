"""``vibeam modes``: the table of modes, and their shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibeam.commands.answer import answer
from vibeam.commands.arguments import AsJson, CaseFile, Overrides, load
from vibeam.commands.mistakes import Mistake, of_case
from vibeam.commands.streams import say


def modes(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[Path | None, typer.Option("--out", help="Write the mode shapes to this VTU file.")] = None,
    count: Annotated[int, typer.Option("--count", min=1, help="How many modes.")] = 10,
) -> None:
    """The modes of the finite-element beam, and the restitution that is left when it is cut off after each."""
    from vibeam.modes import mode_table, write_shapes

    loaded = load(case, set_)
    if out is not None and out.suffix != ".vtu":
        raise Mistake(f"{out}: mode shapes go into a .vtu file")
    table = of_case(case, lambda: mode_table(loaded.scene, count))
    if out is not None:
        write_shapes(table, out)
        say(f"wrote {out}")
    answer(table.rows, as_json, lambda tables: [tables.modal(table)], table.notes)
