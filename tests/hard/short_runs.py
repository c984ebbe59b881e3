"""A case made short: few frequencies, periods, elements, modes and figures, so that it ends soon."""

from __future__ import annotations

import tomllib
from typing import Any

from vibeam.case.case import Case
from vibeam.casefile.toml_writing import toml_text

POINTS, SETTLE, HOLD = 3, 5, 4
ELEMENTS, MODES = 40, 12
FIDELITIES, SHOWS, PANELS, PERIODS = 4, 2, 2, 6
OPTIONS = {"steps": (0, 2000), "rtol": (1e-10, 1), "atol": (1e-14, 1)}  # of solvers: range to which they are cut

Tables = dict[str, Any]


def shortened(case: Case) -> str:
    """The case as TOML, short; what only checks results is left out."""
    tables = tomllib.loads(case.text)
    for name in ("reference", "expect", "measured", "chosen_by", "cost", "influence"):
        tables.pop(name, None)
    _cut(tables["sweep"], settle=SETTLE, hold=HOLD)
    tables["sweep"]["frequency"] = _few_frequencies(tables["sweep"]["frequency"])
    _cut(tables.get("beam", {}), elements=ELEMENTS)
    tables["fidelity"] = {name: _fidelity(each) for name, each in list(tables["fidelity"].items())[:FIDELITIES]}
    shows = {name: _show(each, tables["fidelity"]) for name, each in tables.get("show", {}).items()}
    tables["show"] = dict([(name, each) for name, each in shows.items() if each.get("fidelities", True)][:SHOWS])
    return toml_text(tables)


def _cut(table: Tables, **most: int) -> None:
    table.update({name: min(table[name], value) for name, value in most.items() if table.get(name) is not None})


def _few_frequencies(grid: Any) -> Any:
    if isinstance(grid, dict):
        return grid | {"points": min(grid["points"], POINTS)}
    return sorted({grid[0], grid[len(grid) // 2], grid[-1]})


def _fidelity(table: Tables) -> Tables:
    _cut(table, modes=MODES)
    _cut(table.get("set", {}), **{"beam.elements": ELEMENTS})
    for name, value in table.get("options", {}).items():
        if name in OPTIONS and isinstance(value, int | float):
            table["options"][name] = type(value)(min(max(value, OPTIONS[name][0]), OPTIONS[name][1]))
    return table


def _show(table: Tables, kept: Tables) -> Tables:
    if "fidelities" in table:
        table["fidelities"] = [name for name in table["fidelities"] if name in kept]
    for name in ("frequency", "velocity"):
        if isinstance(table.get(name), list):
            table[name] = table[name][:PANELS]
    _cut(table, settle=SETTLE, subdivision=2)
    _cut(table, periods=PERIODS)
    if table.get("subdivision", 1) > 1 and "periods" in table:
        table["periods"] = PERIODS
    return table
