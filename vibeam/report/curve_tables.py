"""Curves of a result as tidy tables: a row a point of every fidelity and way, a column a quantity with its unit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.report.output import plain, write_csv
from vibeam.runs.result import output_units

if TYPE_CHECKING:
    from vibeam.runs.result import Result


def write_curves(result: Result, path: Path) -> list[Path]:
    """Write all points to ``path``, and beside it the motions that solvers know in closed form, where there are any."""
    parts, units = result.columns()
    points: list[dict[str, Any]] = []
    for part in parts:
        heads = [_head(name, units.get(name, "1")) for name in part]
        rows = zip(*(plain(values) for values in part.values()), strict=True)
        points += (dict(zip(heads, row, strict=True)) for row in rows)
    write_csv(points, path)
    known = [plain(row) for row in motions(result)]
    if not known:
        return [path]
    beside = path.with_name(f"{path.stem.removesuffix('_curves')}_motions.csv")
    write_csv(known, beside)
    return [path, beside]


def _head(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} ({unit.replace(' s-1', '/s').replace('s-1', '1/s')})"


def motions(result: Result) -> Iterator[dict[str, Any]]:
    """Every motion that the solver of a fidelity knows over frequency, unstable ones too."""
    units = output_units(result.case)
    rate = f"{units.length} s-1".removeprefix("1 ")
    heads = {"frequency": "Hz", "amplitude": units.output, "reach": units.length, "velocity": rate}
    for name, curves in result.curves.items():
        for index, branch in np.argwhere(np.isfinite(curves.velocity)):
            row: dict[str, Any] = {"fidelity": name, "periods": curves.periods, "branch": branch + 1}
            for quantity, unit in heads.items():
                values = getattr(curves, quantity)
                row[_head(quantity, unit)] = values[(index, branch)[: values.ndim]]
            yield row | {"stable": curves.stable[index, branch], "admissible": curves.admissible[index, branch]}
