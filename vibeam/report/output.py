"""Results of a command: JSON on stdout, CSV in a file; the sheet of a study, and its files."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from io import StringIO
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import FigurePlan
from vibeam.exchange.whole_files import beside, write_whole
from vibeam.figures.files import paths_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.report.tables import ReportTable


def to_json(value: Any) -> str:
    """Value as JSON; NaN and ∞ become null."""
    return json.dumps(plain(value), ensure_ascii=False, indent=2, allow_nan=False)


def write_csv(rows: Sequence[Any], path: Path) -> None:
    """Write rows as CSV, mappings or records: a column a name, in the order of first appearance."""
    text, found = StringIO(newline=""), [row if isinstance(row, Mapping) else plain(row) for row in rows]
    writer = csv.DictWriter(text, list(dict.fromkeys(name for row in found for name in row)))
    writer.writeheader()
    writer.writerows(found)
    write_whole(path, text.getvalue().encode())


def plain(value: Any) -> Any:
    """Convert dataclasses (their properties too), paths and numpy values to JSON types."""
    if is_dataclass(value) and not isinstance(value, type):
        return {name: plain(getattr(value, name)) for name in _names(type(value))}
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(inner) for inner in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if isfinite(value) else None
    return str(value) if isinstance(value, Path) else value


def _names(kind: type[Any]) -> list[str]:
    bases = [each for each in kind.__mro__ if is_dataclass(each)]
    properties = [name for each in bases for name, member in vars(each).items() if isinstance(member, property)]
    return [each.name for each in fields(kind)] + properties


@dataclass(frozen=True)
class SheetPicture:
    """Picture of a sheet by a ``name``, what it shows in ``words``, what makes it; ``ending``: of its file's stem."""

    name: str
    words: str
    draw: Callable[[], Figure]
    ending: str = ""

    def files(self, stem: Path, plan: FigurePlan) -> list[Path]:
        """Files of the picture beside ``stem``."""
        return paths_of(stem.with_name(f"{stem.stem}{self.ending}.x"), plan)


@dataclass(frozen=True)
class StudySheet:
    """Answer of a study in one sentence, its ``tables``, and ``notes``: what is uncertain, each with what to do.

    ``more`` tables and ``details``, sentences, are shown on the page and with ``-v`` alone. ``data`` for JSON; ``rows``
    of the CSV file: mappings, or records of one dataclass; ``draw`` makes the figure; ``pictures``: those of a page in
    its place; ``page`` makes a page of its own; ``study``: by which its files are named, where not by the command.
    """

    answer: str
    tables: Sequence[ReportTable] = ()
    notes: Sequence[str] = ()
    details: Sequence[str] = ()
    more: Sequence[ReportTable] = ()
    data: Mapping[str, Any] = field(default_factory=dict)
    rows: Sequence[Any] = ()
    draw: Callable[[], Figure] | None = None
    pictures: Sequence[SheetPicture] = ()
    page: Callable[[], str] | None = None
    study: str = ""

    def write(self, table: Path, plan: FigurePlan) -> list[Path]:
        """Write the rows to ``table``, the figure beside it as ``plan`` says, and the page; return the files."""
        figures: list[Path] = []
        alone = [SheetPicture("", "", self.draw)] if self.draw is not None else []
        for each in self.pictures or alone:
            from vibeam.figures.page import write_page

            figures += (own := each.files(table, plan))
            write_page(each.draw, own)
        write_csv(self.rows, table)
        if self.page is None:
            return [table, *figures]
        page = beside(table.with_suffix(".html"))
        write_whole(page, self.page().encode())
        return [page, table, *figures]


def one_sheet(found: Sequence[tuple[str, StudySheet]]) -> StudySheet:
    """Sheets of maps, by their names, as one: each map's answer in a line of its own, its data under ``maps``."""
    sheets = [sheet for _, sheet in found]
    data = [{"map": name, "answer": sheet.answer, "notes": sheet.notes} | {**sheet.data} for name, sheet in found]
    return StudySheet(
        "\n".join(sheet.answer for sheet in sheets),
        [each for sheet in sheets for each in sheet.tables],
        list(dict.fromkeys(each for sheet in sheets for each in sheet.notes)),
        [each for sheet in sheets for each in sheet.details],
        [each for sheet in sheets for each in sheet.more],
        data={"maps": data},
    )
