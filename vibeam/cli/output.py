"""Answer of a command on stdout: one JSON object, or the answer, tables and notes of a sheet, of a screen's length."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from shutil import get_terminal_size
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from vibeam.cli.streams import put, put_json, reader_gone
from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from vibeam.report.output import StudySheet
    from vibeam.report.tables import ReportTable

LINES = 40  # of a screen
NOTES = 5  # remarks on a screen, a sentence each


def print_json(data: dict[str, Any]) -> None:
    """Print data as one object, its ``schema`` with name and version first."""
    from vibeam.exchange.curves.record import all_taken
    from vibeam.report.output import to_json

    put_json(to_json({"schema": f"vibeam.{verbosity().command}/1"} | data | all_taken()))


def print_sheet(sheet: StudySheet, files: Sequence[Path] = (), whole: bool = False) -> None:
    """Print a study with the ``files`` written: its data as JSON, else what of it fits a screen, all with ``-v``.

    ``whole``: all of it in any case.
    """
    form = verbosity()
    if form.json:
        print_json(as_object(sheet, files))
    elif form.quiet:
        put_lines([sheet.answer])
    elif form.verbose or whole:
        put_lines([sheet.answer] if sheet.answer else [])
        _put_tables([*sheet.tables, *sheet.more])
        put_lines([*sheet.notes, *sheet.details, *map(str, files)])
    else:
        _put_screen(sheet, files)


def as_object(sheet: StudySheet, files: Sequence[Path]) -> dict[str, Any]:
    """Content of the JSON object of a study with the ``files`` written."""
    return {"answer": sheet.answer, "notes": sheet.notes, **sheet.data} | ({"files": files} if files else {})


def _put_screen(sheet: StudySheet, files: Sequence[Path]) -> None:
    above, notes = [sheet.answer] if sheet.answer else [], [note.partition("\n")[0] for note in sheet.notes[:NOTES]]
    wrote = [f"wrote {', '.join(map(str, files))}"] if files else []
    tables = _fitting(sheet.tables, LINES - 1 - len(_lines([*above, *notes, *wrote])))
    rest = [sheet.tables[len(tables) :], notes != [*sheet.notes], sheet.more, sheet.details]
    put_lines(above)
    _put_tables(tables)
    put_lines([*notes, *(["more: -v"] if any(rest) else []), *wrote])


def _fitting(tables: Sequence[ReportTable], room: int) -> list[ReportTable]:
    """The tables that fit into so many lines, without their details; the first one in any case."""
    from vibeam.report.tables import cut, height

    found: list[ReportTable] = []
    for table in tables:
        shown = cut(table.brief(), room)
        room -= height(shown)
        if room < 0 and found:
            break
        found.append(shown)
    return found


def _put_tables(tables: Iterable[ReportTable]) -> None:
    from vibeam.report.tables import print_table

    for table in tables:
        try:
            print_table(table)
        except SystemExit:  # raised by rich for a reader that has gone
            reader_gone()


def put_lines(texts: Iterable[str]) -> None:
    """Print sentences, broken between words where a terminal shows them."""
    for line in _lines(texts):
        put(line)


def _lines(texts: Iterable[str]) -> list[str]:
    """Lines of sentences, broken between words where a terminal shows them."""
    parts = [line for text in texts for line in text.split("\n")]
    if not sys.stdout.isatty():
        return parts
    width = get_terminal_size().columns
    return [line for part in parts for line in wrap(part, width, break_long_words=False) or [""]]
