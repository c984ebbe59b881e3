"""Result of an earlier run, read from its file: nothing is computed, nothing is written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.runs.result import Result
from vibeam.runs.run_plan import restricted
from vibeam.runs.store.adaptation import case_text
from vibeam.runs.store.branches import branch_names, points_of, read_rows, response_of
from vibeam.runs.store.figures import sheets_of
from vibeam.runs.store.file import opened_to_read
from vibeam.runs.store.records import (
    COMPARED,
    COMPARISON,
    CURVES,
    kept,
    read_compared,
    read_comparisons,
    read_curves,
    read_models,
)
from vibeam.store.blocks import Values
from vibeam.store.errors import reading
from vibeam.system.response import Branches
from vibeam.system.state import StatesAfter

if TYPE_CHECKING:
    import h5py

    from vibeam.case.case import Case


@dataclass(frozen=True)
class StoredResult:
    """A ``result`` of which ``missing`` points were not run yet (NaN), and what else its file holds.

    ``result``: a ``Result``, of a case with [record] a ``TransientResult``.
    ``provenance``: what computed the numbers, by name. ``left_out``: references of the case whose files
    were not found. ``numbers``: what decides the numbers, as TOML.
    """

    result: Any
    provenance: Mapping[str, str]
    missing: int
    numbers: str
    left_out: tuple[str, ...] = ()


def read_result(path: str | Path, parse: Callable[[str], Case]) -> StoredResult:
    """Read a results file, complete or not; ``parse`` makes a case of its text.

    StoreError where it is none, or damaged; CaseError where its case cannot be built any more.
    """
    file = Path(path)
    with opened_to_read(file) as stored:
        with reading(file, "/case"):
            text = case_text(stored, "whole")
        case = parse(text)
        with reading(file, "its groups"):
            return _read(stored, file, case)


def _read(stored: h5py.File, path: Path, case: Case) -> StoredResult:
    case = restricted(case, {name for name, _ in branch_names(stored)} & set(case.fidelities))
    rows = {at: read_rows(stored[at[0]][at[1]]) for at in branch_names(stored) if at[0] in case.fidelities}
    models = {name: properties for name, (_, properties) in read_models(stored).items()}
    branches = {name: _branches(stored, name, rows) for name in dict.fromkeys(name for name, _ in rows)}
    ordered = {name: branches[name] for name in case.fidelities if name in branches}
    shown = {name: kept(stored, sheets_of(plan), plan.key) for name, plan in case.shows.items()}
    result = Result(
        case,
        ordered,
        path,
        sum(points_of(stored[one][way]) for one, way in rows),
        {name: sheets for name, sheets in shown.items() if sheets is not None},
        read_comparisons(stored[COMPARISON]) if COMPARISON in stored else (),
        models,
        read_compared(stored[COMPARED.place]) if COMPARED.place in stored else (),
        {name: _states(name, rows) for name in ordered},
    )
    provenance = {name: str(value) for name, value in stored["provenance"].attrs.items()}
    return StoredResult(result, provenance, result.total - result.found, case_text(stored, "text"))


def _states(name: str, rows: Mapping[tuple[str, str], Values]) -> dict[str, StatesAfter]:
    """States after the points of the branches of a fidelity."""
    return {
        way: StatesAfter(values["state_displacement"], values["state_velocity"])
        for (one, way), values in rows.items() if one == name
    }  # fmt: skip


def _branches(stored: h5py.File, name: str, rows: Mapping[tuple[str, str], Values]) -> Branches:
    found = {way: rows[name, way] for way in ("up", "down") if (name, way) in rows}
    ways = {way: response_of(values) for way, values in found.items()}
    curves = read_curves(stored[name][CURVES]) if CURVES in stored[name] else None
    return Branches(ways.get("up"), ways.get("down"), curves)
