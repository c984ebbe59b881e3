"""What ``vibeam cost`` leaves on disk: the plot twice, and every run as a line of CSV."""

from __future__ import annotations

from collections.abc import Mapping
from csv import DictWriter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.report.output import plain
from vibeam.report.work_precision import write_work_precision

if TYPE_CHECKING:
    from vibeam.cost.study import Study


def write_files(study: Study, folder: Path, stem: str) -> list[Path]:
    """Write ``STEM_cost.png``, ``.svg`` and ``.csv`` into the folder; gives their paths."""
    figures = [folder / f"{stem}_cost{ending}" for ending in (".png", ".svg")]
    table = folder / f"{stem}_cost.csv"
    write_work_precision(study, *figures)
    write_rows(study, table)
    return [*figures, table]


def write_rows(study: Study, path: Path) -> None:
    """Every run as a line; what is nested gets names with a dot, as ``total.amplitude_rms``."""
    rows = [dict(_flat(plain(row))) for row in study.rows]
    names = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)


def _flat(value: Mapping[str, Any], above: str = "") -> list[tuple[str, Any]]:
    found: list[tuple[str, Any]] = []
    for name, inner in value.items():
        if isinstance(inner, list):
            inner = {part["name"]: {key: part[key] for key in ("mean", "rms", "worst")} for part in inner}
        found += _flat(inner, f"{above}{name}.") if isinstance(inner, Mapping) else [(f"{above}{name}", inner)]
    return found
