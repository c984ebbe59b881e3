"""Tables as wide as the terminal: text wraps, further columns go into a further table, and no number is cut."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.cells import cell_len
from rich.table import Column, Table

LINES = (24, 16, 12)  # characters of text that stay on one line in a narrow column, if the terminal can hold them


class ReportTable(Table):
    """Table whose first ``heads`` columns identify a row; they are repeated in its continuations."""

    def __init__(self, title: str, heads: int = 1) -> None:
        super().__init__(title=title, box=box.SIMPLE_HEAD, collapse_padding=True, pad_edge=False, show_edge=False)
        self.heads = heads

    def add(self, *names: str) -> None:
        """Add columns; a name that ends in | is a right-aligned column of numbers."""
        for name in names:
            self.add_column(name.rstrip("|"), justify="right" if name.endswith("|") else "left", overflow="fold")


def fitted(table: ReportTable, width: int) -> list[ReportTable]:
    """Split the table into pieces of ``width`` characters, the first columns repeated in each.

    A piece of one column may be wider: its numbers are not cut.
    """
    least = _narrowest(table, width)
    pieces = _pieces(_filled_columns(table), least, table.heads, width)
    return [_part(table, chosen, least, width) for chosen in pieces]


def _filled_columns(table: ReportTable) -> list[int]:
    """Columns after the first ones that are not empty in every row."""
    behind = range(table.heads, len(table.columns))
    return [index for index in behind if not table.rows or any(map(str, table.columns[index].cells))]


def _narrowest(table: ReportTable, width: int) -> list[int]:
    """Least width of every column: texts are broken further where one column would not fit beside the first."""
    for line in LINES:
        least = [_least(column, line) for column in table.columns]
        if all(_whole([*least[: table.heads], size]) <= width for size in least[table.heads :]):
            break
    return least


def needed(table: ReportTable) -> int:
    """Width in characters at which nothing wraps."""
    return _whole([_most(table.columns[index]) for index in [*range(table.heads), *_filled_columns(table)]])


def _pieces(filled: Sequence[int], least: Sequence[int], heads: int, width: int) -> list[list[int]]:
    """Columns of each piece: in order, as many as ``width`` holds."""
    first = list(range(heads))
    pieces = [first.copy()]
    for index in filled:
        if len(pieces[-1]) > heads and _whole([least[i] for i in [*pieces[-1], index]]) > width:
            pieces.append(first.copy())
        pieces[-1].append(index)
    return pieces


def _part(table: ReportTable, chosen: Sequence[int], least: Sequence[int], width: int) -> ReportTable:
    """Table of the chosen columns, each with its given width."""
    continued = chosen[table.heads :] and chosen[table.heads] != _filled_columns(table)[0]
    part = ReportTable(f"{table.title}, continued" if continued else str(table.title), table.heads)
    columns = [table.columns[index] for index in chosen]
    for column, size in zip(columns, _widths(columns, [least[index] for index in chosen], width), strict=True):
        part.add_column(column.header, justify=column.justify, overflow="fold", width=size)
    cells = [list(column.cells) for column in columns]
    for number, row in enumerate(table.rows):
        part.add_row(*(column[number] for column in cells), end_section=row.end_section)
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
