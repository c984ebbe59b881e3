"""Tables of the page: the terminal's own tables as plain rows, and the keys of the case."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vibeam.report.table_widths import ReportTable

ELSEWHERE = ("title", "source", "units", "fidelity", "sweep", "show", "reference", "expect", "measured", "cost",
             "influence", "map", "uncertain", "chosen_by", "fit", "figure", "accuracy", "accuracy_of")  # fmt: skip


@dataclass(frozen=True)
class PageTable:
    """Title, heads and rows of texts; ``numbers``: which columns are right-aligned."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: Sequence[bool]
    caption: str = ""


def of_report(table: ReportTable) -> PageTable:
    """A terminal's table as texts, without the columns that are empty in every row."""
    columns = [each for at, each in enumerate(table.columns) if at < table.heads or any(map(str, each.cells))]
    cells = [[str(cell) for cell in column.cells] for column in columns]
    return PageTable(
        str(table.title or ""),
        [str(each.header) for each in columns],
        list(zip(*cells, strict=True)),
        [each.justify == "right" for each in columns],
        str(table.caption or ""),
    )


def scene_table(text: str) -> PageTable:
    """Keys of the case that say what stands on the bench, in SI units; effects among them are those that are active."""
    tables = {name: value for name, value in tomllib.loads(text).items() if name not in ELSEWHERE}
    rows = [row for name, value in tables.items() for row in _rows(name, value)]
    return PageTable("The scene, in SI units", ("table", "key", "value"), rows, (False, False, True))


def _rows(name: str, value: Any) -> Iterator[tuple[str, str, str]]:
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, each in enumerate(value, 1):
            yield from _rows(f"{name} {number}", each)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            if isinstance(inner, Mapping):
                yield from _rows(f"{name}.{key}", inner)
            else:
                yield name, key, _shown(inner)
    else:
        yield "", name, _shown(value)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_shown, value[:12])) + " …" * (len(value) > 12)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
