"""``vibeam study``: a study that a program has registered."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result, write_table

Name = Annotated[str, typer.Argument(metavar="NAME", help="The study's name.", show_default=False)]


def study(name: Name, case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Run a registered study of a case (see --load)."""
    from vibeam.exchange.faults import suggest
    from vibeam.studies.declaration import STUDIES

    registered = [each for each, declared in STUDIES.items() if not declared.own_command]
    if name not in registered:
        known = suggest(name, registered) if registered else "none is registered: write vibeam --load MODULE study …"
        raise UsageError(f"vibeam {name} is a command of its own" if name in STUDIES else f"no study {name!r}; {known}")
    declared, loaded = STUDIES[name], load(case, set_)
    rows = list(of_case(case, lambda: declared.of(loaded)))
    write_table(rows, None if out is None else table_path(loaded, out, name))
    print_result(rows, as_json, lambda tables: [tables.rows_of(declared.meaning, rows)])
