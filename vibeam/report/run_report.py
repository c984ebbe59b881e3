"""Report of a run: headlines, tables and sentences, the same on the terminal and on the page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vibeam.figures.units import units_for
from vibeam.report import tables
from vibeam.runs.comparison.differences import headline, notes
from vibeam.runs.estimate.summary import estimate_texts
from vibeam.runs.summary import compare, remarks

if TYPE_CHECKING:
    from vibeam.report.table_widths import ReportTable
    from vibeam.runs.result import Result


@dataclass(frozen=True)
class RunReport:
    """Lines above the tables, the tables, sentences below them."""

    headlines: list[str]
    tables: list[ReportTable]
    sentences: list[str]


def run_report(result: Result) -> RunReport:
    """Report of a result; its errors are estimated and its comparisons made as far as it has them."""
    rows, units, compared = compare(result), units_for(result), result.comparisons
    choice = () if result.accuracy is None else result.accuracy.sentences()
    estimated = estimate_texts(result.estimates)
    below = [*(line for each in compared for line in notes(each)), *estimated.sentences, *remarks(result)]
    shown = [tables.responses(rows, units, estimated), tables.costs(rows, compared)]
    return RunReport([*choice, *map(headline, compared)], shown, below)
