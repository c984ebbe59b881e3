"""Regression check of a case: its result against its reference curves and expected numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.studies.regression import expectations as expect
from vibeam.studies.regression import references

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.run.result import Result
    from vibeam.studies.regression.references import CheckRow


def check(case: Case, result: Result | None = None, *, partial: bool = False) -> list[CheckRow]:
    """Compare a case with its references and expectations, one row each; ``row.passed`` is the verdict.

    ``result`` None: the case is run, every fidelity by itself. ``partial`` forgives frequencies that the sweep does not
    have. CaseError for a reference file that cannot be read.
    """
    if result is None:
        from vibeam.run.run import run

        case = case.everywhere()
        result = run(case, show=False)
    return references.check(case, result, partial=partial) + expect.check(case, result, partial=partial)
