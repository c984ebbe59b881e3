"""``vibeam keys``: the reference table."""

from __future__ import annotations

from vibeam.commands.answer import answer, written
from vibeam.commands.arguments import AsJson, TableFile


def keys(as_json: AsJson = False, out: TableFile = None) -> None:
    """Every key of a case file: what it means, its unit, its default."""
    from vibeam.keys import reference_table

    rows = reference_table()
    written(rows, out)
    answer(rows, as_json, lambda tables: [tables.keys(rows)])
