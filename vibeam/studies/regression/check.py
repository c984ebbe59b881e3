"""Regression check of a case: its result against reference curves and expected numbers, and beside measured ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.studies.regression import expectations as expect
from vibeam.studies.regression import measured, references
from vibeam.studies.regression.flown import at_references

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.run.result import Result
    from vibeam.studies.regression.measured import MeasuredRow
    from vibeam.studies.regression.references import CheckRow


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
    from vibeam.run.run import run

    return run(without_accuracy(case), show=False)
