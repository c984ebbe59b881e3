"""Regression check of a case: its result, flown where references are, against curves, expected and measured numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.curves.record import SAME_FREQUENCY
from vibeam.studies.regression import expectations as expect
from vibeam.studies.regression import measured, references
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.result import Result
    from vibeam.studies.regression.measured import MeasuredRow
    from vibeam.studies.regression.references import CheckRow
    from vibeam.system.response import Branches


def at_references(case: Case, result: Result, *, partial: bool = False) -> dict[str, Branches]:
    """Branches by reference: those of ``result`` where its grid has all points, else swept anew with the others in it.

    Frequencies beyond the ends of the grid are not flown: no motion leads there. ``partial``: what is on the grid is
    enough, as long as there is anything.
    """
    wanted = {name: _off_grid(case, name, result, partial) for name in case.references}
    further: dict[str, Array] = {}
    for name, off in wanted.items():
        fidelity = case.references[name].fidelity
        if len(off):
            further[fidelity] = np.union1d(further.get(fidelity, np.empty(0)), off)
    swept = {fidelity: _swept(case, fidelity, off) for fidelity, off in further.items()}
    return {
        name: swept[reference.fidelity] if len(wanted[name]) else result[reference.fidelity]
        for name, reference in case.references.items()
    }


def _off_grid(case: Case, name: str, result: Result, partial: bool) -> Array:
    """Frequencies of a reference inside the grid's ends, and not in it."""
    grid = np.sort(case.sweep.frequency)
    there = np.unique([point.frequency for point in case.references[name].points()])
    near = np.clip(np.searchsorted(grid, there), 1, len(grid) - 1) if len(grid) > 1 else np.zeros(len(there), int)
    distance = np.minimum(np.abs(grid[near] - there), np.abs(grid[near - 1] - there))
    off = distance > SAME_FREQUENCY * there
    if partial and not off.all():
        return np.empty(0)
    return np.asarray(there[off & (there > grid[0]) & (there < grid[-1])])


def _swept(case: Case, fidelity: str, further: Array) -> Branches:
    from vibeam.runs.run import run

    grid = np.union1d(case.sweep.frequency, further)
    own = replace(
        case,
        sweep=replace(case.sweep, frequency=grid),
        fidelities={fidelity: case.fidelities[fidelity]},
        shows={},
        accuracy=None,
    )
    return run(own, show=False)[fidelity]


def check(case: Case, result: Result | None = None, *, partial: bool = False) -> list[CheckRow]:
    """Compare a case with its references and expectations, one row each; ``row.passed`` is the verdict.

    ``result`` None: the case is run, every fidelity by itself. References are compared at their own frequencies: what
    the sweep does not have between its ends is flown. ``partial`` forgives frequencies that it does not have. CaseError
    for a reference file that cannot be read.
    """
    result = _result(case) if result is None else result
    at = at_references(case, result, partial=partial)
    return references.check(case, result, partial=partial, at=at) + expect.check(case, result, partial=partial)


def compare_measured(case: Case, result: Result | None = None) -> list[MeasuredRow]:
    """Compare a case with its measured numbers, one row each; ``result`` as for ``check``. There is no verdict."""
    return measured.compare(case, _result(case) if result is None else result)


def _result(case: Case) -> Result:
    from vibeam.casefile.read import without_accuracy
    from vibeam.runs.run import run

    return run(without_accuracy(case), show=False)
