"""Every case with a record in cases/: it runs, moves to the end, and holds the numbers that it states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from case_files import RECORDS

import vibeam
from vibeam.studies.regression.check import check_expectations
from vibeam.system.response import Ended

SLOW = ("truck",)  # 10 s of CPU time


@pytest.mark.parametrize(
    "file",
    [pytest.param(file, marks=pytest.mark.slow) if file.stem in SLOW else file for file in RECORDS],
    ids=lambda file: file.stem,
)
def test_a_record_case_holds_what_it_states(file: Path) -> None:
    case = vibeam.load(file)
    result = vibeam.run(case, show=False)
    assert set(result) == set(case.fidelities)
    for own in result.values():
        assert np.all(own.ended == Ended.COMPLETE.code)
    rows = check_expectations(case, result)
    assert [row.reference for row in rows] == list(case.expectations)
    assert [row for row in rows if not row.passed] == []


def test_there_are_such_cases() -> None:
    assert len(RECORDS) >= 3
