"""Curves of a result as tidy tables: a row a point of every fidelity and way, a column a quantity with its unit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.report.output import plain, write_rows
from vibeam.runs.result import output_units
from vibeam.system.quantities import LAYOUT, Ended, unit_of

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.system.quantities import OutputUnits
    from vibeam.system.response import FrequencyResponse


def write_curves(result: Result, path: Path) -> list[Path]:
    """Write all points to ``path``, and beside it the motions that solvers know in closed form, where there are any."""
    write_rows([plain(row) for row in points(result)], path)
    known = [plain(row) for row in motions(result)]
    if not known:
        return [path]
    beside = path.with_name(f"{path.stem.removesuffix('_curves')}_motions.csv")
    write_rows(known, beside)
    return [path, beside]


def points(result: Result) -> Iterator[dict[str, Any]]:
    """Every point of every fidelity and way, in the order swept."""
    units = output_units(result.case)
    for name, branches in result.items():
        for way, response in branches.items():
            columns = dict(_columns(response, units))
            for index in range(len(response)):
                values = {column: each[index] for column, each in columns.items()}
                yield {"fidelity": name, "direction": way} | values | {"ended": _reason(response, index)}


def _columns(response: FrequencyResponse, units: OutputUnits) -> Iterator[tuple[str, Any]]:
    """Values of each quantity by its head, those of a mode or an impact as columns of their own."""
    for name, quantity in LAYOUT.items():
        values, unit = getattr(response, name), unit_of(quantity, units)
        if values.ndim == 1:
            yield _head(name, unit), values
        else:
            yield from ((_head(f"{name}_{at}", unit), each) for at, each in enumerate(values.T, 1))


def _head(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} ({unit.replace(' s-1', '/s').replace('s-1', '1/s')})"


def _reason(response: FrequencyResponse, index: int) -> str:
    return Ended.of_code(int(response.ended[index])).name


def motions(result: Result) -> Iterator[dict[str, Any]]:
    """Every motion that the solver of a fidelity knows over frequency, unstable ones too."""
    units = output_units(result.case)
    heads = {"frequency": "Hz", "amplitude": units.output, "reach": units.length, "velocity": f"{units.length} s-1"}
    for name, curves in result.curves.items():
        for index, branch in np.argwhere(np.isfinite(curves.velocity)):
            row: dict[str, Any] = {"fidelity": name, "periods": curves.periods, "branch": branch + 1}
            for quantity, unit in heads.items():
                values = getattr(curves, quantity)
                row[_head(quantity, unit.removeprefix("1 "))] = values[(index, branch)[: values.ndim]]
            yield row | {"stable": curves.stable[index, branch], "admissible": curves.admissible[index, branch]}
