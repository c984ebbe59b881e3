"""Results as tidy tables: a row a point or a motion, a column a quantity with its unit.

Of a sweep a row is a point of every fidelity and way, and beside them stand the motions that solvers know in closed
form. Under a record a row is a motion, and beside them stands every impact.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.exchange.whole_files import beside
from vibeam.report.output import plain, write_csv
from vibeam.runs.result import Result, output_units

if TYPE_CHECKING:
    from vibeam.runs.transient.result import TransientResult

FEW = 8  # modes whose energies a table has unless all are asked for
SHOWN = {" s-2": "/s²", " s-1": "/s", "s-2": "1/s²", "s-1": "1/s"}  # units of results files, as tables have them


def write_tables(result: Any, path: Path, left_out: Collection[str] = ()) -> list[Path]:
    """Write all points or motions to ``path``, beside it known motions or impacts where there are any; the files.

    ``result``: a ``Result``, of a case with [record] a ``TransientResult``. ``left_out``: columns that are not written.
    """
    parts, units = result.columns()
    rows: list[dict[str, Any]] = []
    for part in parts:
        shown = {name: values for name, values in part.items() if name not in left_out}
        heads = [_head(name, units.get(name, "1")) for name in shown]
        rows += (dict(zip(heads, row, strict=True)) for row in zip(*map(plain, shown.values()), strict=True))
    write_csv(rows, path)
    swept = result.case.record is None
    kind, own = ("curves", "motions") if swept else ("motions", "impacts")
    known = [plain(row) for row in (motions(result) if swept else impacts(result))]
    if not known:
        return [path]
    further = beside(path.with_name(f"{path.stem.removesuffix(f'_{kind}')}_{own}.csv"))
    write_csv(known, further)
    return [path, further]


def many_energies(result: Any) -> list[str]:
    """Columns of modal energies where a fidelity has more than ``FEW`` of them."""
    names = dict.fromkeys(name for part in result.columns()[0] for name in part if name.startswith("mode_energy_"))
    return list(names) if len(names) > FEW else []


def impacts(result: TransientResult) -> Iterator[dict[str, Any]]:
    """Every impact of every motion."""
    speed = "m/s" if result.case.scene.natural_unit is None else "1/s"
    for name, own in result.items():
        for i, value in enumerate(result.factors):
            for j, seed in enumerate(result.seeds or (0,)):
                known = (own.impact_times[i][j], own.impact_velocities[i][j], own.impact_contacts[i][j])
                for time, velocity, contact in zip(*known, strict=True):
                    head = {"fidelity": name, result.over: value, "seed": seed}
                    yield head | {"time (s)": time, f"velocity ({speed})": velocity, "contact": contact + 1}


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


def _head(name: str, unit: str) -> str:
    for stored, shown in SHOWN.items():
        unit = unit.replace(stored, shown)
    return name if unit == "1" else f"{name} ({unit})"
