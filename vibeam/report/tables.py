"""Tables as wide as the terminal: text wraps, further columns go into a further table, and no number is cut.

That of keys is made here.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import fields
from io import StringIO
from itertools import zip_longest
from math import isfinite
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any, TextIO, cast

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from vibeam.exchange.whole_files import naming_stdout
from vibeam.system.number_text import ratio, shown_in

if TYPE_CHECKING:
    from vibeam.casefile.documentation import KeyRow

LINES = (24, 16, 12)  # characters of text that stay on one line in a narrow column, if the terminal can hold them


class ReportTable(Table):
    """Table whose first ``heads`` columns identify a row; they are repeated in its continuations.

    ``details``: places of the columns that are shown with ``-v`` and on the page alone. ``unbroken``: in a file each
    row is one line.
    """

    unbroken = False

    def __init__(self, title: str, heads: int = 1) -> None:
        super().__init__(title=title, box=box.SIMPLE_HEAD, collapse_padding=True, pad_edge=False, show_edge=False)
        self.heads = heads
        self.details: set[int] = set()

    def add(self, *names: str, detail: bool = False) -> None:
        """Add columns; a name that ends in | is a right-aligned column of numbers. ``detail``: shown with ``-v``."""
        for name in names:
            self.details |= {len(self.columns)} if detail else set()
            self.add_column(name.rstrip("|"), justify="right" if name.endswith("|") else "left", overflow="fold")

    def brief(self) -> ReportTable:
        """Table without its columns of details."""
        return _copied(self, [at for at in range(len(self.columns)) if at not in self.details])


def _copied(
    table: ReportTable, chosen: Sequence[int], rows: int | None = None, sizes: Iterable[int] = ()
) -> ReportTable:
    """Table of the chosen columns, of these widths where they are given, and of its first rows."""
    made = ReportTable(str(table.title), table.heads)
    made.caption, made.unbroken = table.caption, table.unbroken
    for at, size in zip_longest(chosen, sizes):
        column = table.columns[at]
        made.add_column(column.header, justify=column.justify, overflow="fold", width=size)
    cells = [list(table.columns[at].cells) for at in chosen]
    for number, row in enumerate(table.rows[:rows]):
        made.add_row(*(column[number] for column in cells), end_section=row.end_section)
    return made


def height(table: ReportTable) -> int:
    """Number of lines that a table takes on stdout."""
    console = _console(table, StringIO())
    with console.capture() as captured:
        _print(console, table)
    return captured.get().count("\n")


def cut(table: ReportTable, lines: int) -> ReportTable:
    """Table of so many ``lines`` at most, and one row at least; its title says how many rows it has in all."""
    found, kept = table, len(table.rows)
    while kept > 1 and height(found) > lines:
        kept = max(1, min(kept - 1, kept - height(found) + lines))
        found = _copied(table, range(len(table.columns)), kept)
        found.title = f"{table.title} (first {kept} of {len(table.rows)} rows, all with -v)"
    return found


def fitted(table: ReportTable, width: int) -> list[ReportTable]:
    """Split the table into pieces of ``width`` characters, the first columns repeated in each.

    A piece of one column may be wider: its numbers are not cut.
    """
    least = _narrowest(table, width)
    pieces = _pieces(filled_columns(table), least, table.heads, width)
    return [_part(table, chosen, least, width) for chosen in pieces]


def filled_columns(table: ReportTable) -> list[int]:
    """The first columns, and those behind them that are not empty in every row."""
    return [
        at
        for at, column in enumerate(table.columns)
        if at < table.heads or not table.rows or any(map(str, column.cells))
    ]


def _narrowest(table: ReportTable, width: int) -> list[int]:
    """Least width of every column: texts are broken further where one column would not fit beside the first."""
    for line in LINES:
        least = [_least(column, line) for column in table.columns]
        if all(_whole([*least[: table.heads], size]) <= width for size in least[table.heads :]):
            break
    return least


def needed(table: ReportTable) -> int:
    """Width in characters at which nothing wraps."""
    return _whole([_most(table.columns[index]) for index in filled_columns(table)])


def _pieces(filled: Sequence[int], least: Sequence[int], heads: int, width: int) -> list[list[int]]:
    """Columns of each piece: in order, as many as ``width`` holds."""
    pieces = [[*filled[:heads]]]
    for index in filled[heads:]:
        if len(pieces[-1]) > heads and _whole([least[i] for i in [*pieces[-1], index]]) > width:
            pieces.append([*filled[:heads]])
        pieces[-1].append(index)
    return pieces


def _part(table: ReportTable, chosen: Sequence[int], least: Sequence[int], width: int) -> ReportTable:
    """Table of the chosen columns, each with its given width."""
    columns = [table.columns[index] for index in chosen]
    part = _copied(table, chosen, None, _widths(columns, [least[index] for index in chosen], width))
    if chosen != filled_columns(table)[: len(chosen)]:
        part.title = f"{table.title}, continued"
    return part


def _widths(columns: Sequence[Column], least: Sequence[int], width: int) -> list[int]:
    """Width of each column: what it needs, the rest shared by the texts that wrap most."""
    sizes, most = list(least), [_most(column) for column in columns]
    left = width - _whole(sizes)
    while left > 0 and sizes != most:
        widest = max(range(len(sizes)), key=lambda i: most[i] - sizes[i])
        sizes[widest] += 1
        left -= 1
    return sizes


def _whole(sizes: Sequence[int]) -> int:
    """Total width of columns with two blanks between them."""
    return sum(sizes) + 2 * (len(sizes) - 1)


def _least(column: Column, line: int) -> int:
    """Least width of a column: its numbers in one line, its texts in lines of ``line`` characters.

    Words are broken on the narrowest terminals only.
    """
    header = max((cell_len(word) for word in str(column.header).split()), default=0)
    lines = _lines(column)
    if column.justify == "right":
        return max(header, *map(cell_len, lines), 0)
    words = max((cell_len(word) for text in lines for word in text.split()), default=0) if line > LINES[-1] else 0
    return max(header, min(max(map(cell_len, lines), default=0), max(words, line)))


def _most(column: Column) -> int:
    """Width at which nothing of a column wraps."""
    return max([cell_len(line) for line in [*_lines(column), *str(column.header).splitlines()]], default=0)


def _lines(column: Column) -> list[str]:
    return [line for cell in column.cells for line in str(cell).splitlines()]


USUAL = 100  # columns, where stdout is no terminal
ARROWS = {"up": " ↑", "down": " ↓"}  # way of the sweep


def print_table(table: ReportTable) -> None:
    """Print a table on stdout, split where the terminal is too narrow."""
    with naming_stdout():
        _print(_console(table, sys.stdout), table)


def on_screen() -> bool:
    """Test whether stdout is a terminal, or of the width of one."""
    return sys.stdout.isatty() or "COLUMNS" in os.environ


def _console(table: ReportTable, file: TextIO) -> Console:
    """Console as wide as the terminal; in a file as wide as the table, 80 to ``USUAL`` columns where it is broken."""
    console = Console(file=file, highlight=False, markup=False)
    if not on_screen() and not console.is_terminal:
        console.width = max(80, needed(table) if table.unbroken else min(USUAL, needed(table)))
    elif not console.is_terminal:
        console.width = get_terminal_size().columns
    return console


def _print(console: Console, table: ReportTable) -> None:
    width = console.width
    for piece in fitted(table, width):
        title, piece.title, piece.caption = str(piece.title), None, None
        console.width = max(width, needed(piece))  # a single number may be wider than a very narrow terminal
        console.print(Text(title, style="bold"))
        stripped = table.unbroken and not console.is_terminal
        lines = ("".join(each.text for each in line).rstrip() for line in console.render_lines(piece))
        console.print(Text("\n".join(lines)) if stripped else piece)
        console.width = width
    if table.caption:
        console.print(Text(str(table.caption), style="dim italic"))
    console.print()


def plain(quantity: str) -> str:
    """Number without its unit, which the column's head has."""
    return quantity.partition(" ")[0]


def keys(rows: Iterable[KeyRow]) -> ReportTable:
    """Table of every key of a case file, by table."""
    table = blank("Keys of a case file", "table", "key", "holds", "default", "meaning", heads=2)
    last = ""
    for row in rows:
        if last and row.table != last:
            table.add_section()
        default = "required" if row.required else row.default or "absent"
        table.add_row("" if row.table == last else row.table, row.key, row.unit, default, row.meaning)
        last = row.table
    return table


def blank(title: str, *names: str, heads: int = 1) -> ReportTable:
    """Empty table; a name that ends in | is a right-aligned column of numbers.

    The first ``heads`` columns are repeated where the others need a further table.
    """
    table = ReportTable(title, heads)
    table.add(*names)
    return table


def rows_of(title: str, rows: Sequence[object]) -> ReportTable:
    """Rows of one dataclass as a table, a column a field."""
    found = [{field.name: getattr(row, field.name) for field in fields(cast(Any, row))} for row in rows]
    columns = list(found[0]) if found else []
    numbers = {name for name in columns if all(isinstance(row[name], int | float) for row in found)}
    table = blank(title, *(f"{name}|" if name in numbers else name for name in columns))
    for row in found:
        table.add_row(*(f"{row[name]:.6g}" if name in numbers else str(row[name]) for name in columns))
    return table


def coefficient(value: float) -> str:
    """Coefficient of restitution as text; a dash where there is none."""
    return ratio(value, ".4f") if isfinite(value) else "–"


def shown(value: float, unit: str) -> str:
    """A value of an SI unit to four digits, with the prefix that suits it; a dash for NaN."""
    name, factor = shown_in(unit, value)
    return f"{value * factor:.4g} {name.removeprefix('1')}".rstrip() if isfinite(value) else "–"
