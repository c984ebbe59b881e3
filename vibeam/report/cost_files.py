"""What ``vibeam cost`` leaves on disk: the plot twice, and every run as a line of CSV."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.report.output import plain, write_rows
from vibeam.report.page import paths_of
from vibeam.report.work_precision import write_work_precision

if TYPE_CHECKING:
    from vibeam.case import Case
    from vibeam.cost.study import Study


def write_files(study: Study, folder: Path, stem: str, case: Case) -> list[Path]:
    """Write ``STEM_cost.csv`` and the plot beside it, as the case says, into the folder; gives their paths."""
    table = folder / f"{stem}_cost.csv"
    figures = paths_of(table, case.figure)
    write_work_precision(study, case, *figures)
    write_rows(_lines(study), table)
    return [*figures, table]


def _lines(study: Study) -> list[dict[str, Any]]:
    """Every run as a line; what is nested gets names with a dot, as ``total.amplitude_rms``."""
    return [dict(_flat(plain(row))) for row in study.rows]


def _flat(value: Mapping[str, Any], above: str = "") -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for name, inner in value.items():
        if isinstance(inner, list):
            inner = {part["name"]: {key: part[key] for key in ("mean", "rms", "worst")} for part in inner}
        found += _flat(inner, f"{above}{name}.") if isinstance(inner, Mapping) else [(f"{above}{name}", inner)]
    return found
