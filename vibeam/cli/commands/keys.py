"""``vibeam keys``: the reference table, and the schema for editors."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, TableFile, output_path
from vibeam.cli.errors import UsageError
from vibeam.cli.output import print_result, write_table
from vibeam.cli.streams import put_json


def keys(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="A table, stop, or a key, stop.gap; absent = all.", show_default=False),
    ] = None,
    as_json: AsJson = False,
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
    print_result(rows, as_json, lambda tables: [tables.keys(rows)])
