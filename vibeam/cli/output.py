"""Results of a command on stdout: JSON, or tables with notes below them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.cli.streams import put, put_json, reader_gone, say

if TYPE_CHECKING:
    from vibeam.report.output import StudySheet
    from vibeam.report.tables import ReportTable


Tables = Callable[[Any], Sequence["ReportTable"]]


def print_result(
    rows: Any,
    as_json: bool,
    tables: Tables = lambda tables: [],
    notes: Iterable[object] = (),
    head: Iterable[str] = (),
) -> None:
    """Print ``rows`` as JSON, or the ``tables`` that ``vibeam.report.tables`` makes of them.

    One line each of ``head`` stands above the tables, one of each of the ``notes`` below them.
    """
    from vibeam.report import output
    from vibeam.report import tables as table

    if as_json:
        put_json(output.to_json(rows))
        return
    for first in head:
        put(first)
    for shown in tables(table):
        try:
            table.print_table(shown)
        except SystemExit:  # raised by rich for a reader that has gone
            reader_gone()
    for line in notes:
        put(str(line))


def print_sheet(sheet: StudySheet, as_json: bool, files: Sequence[Path] = ()) -> None:
    """Print a study: its data as JSON, or its tables and sentences, with the ``files`` written."""
    data = {**sheet.data, "files": files} if files else sheet.data
    print_result(data, as_json, lambda _: sheet.tables, [*sheet.notes, *files], filter(None, [sheet.answer]))


def write_table(rows: Any, out: Path | None) -> None:
    """Write ``rows`` as CSV to ``out``, where a file is asked for."""
    if out is not None:
        from vibeam.report import output

        output.write_csv(rows, out)
        say(f"wrote {out}")
