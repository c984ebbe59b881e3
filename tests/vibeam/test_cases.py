"""Every file in ``cases/`` runs, short, and meets its references there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.case import Case
from vibeam.references import check, reference_points
from vibeam.response import Ended

FILES = sorted((Path(__file__).parents[2] / "cases").rglob("*.toml"))


def shortened(file: Path, **more: object) -> Case:
    """The case at five of its reference's frequencies, the ends and the middle among them."""
    case = vibeam.load(file)
    first = next(iter(case.references.values()))
    there = sorted({p.frequency for p in reference_points(first) if p.value is not None})
    few = [there[round(i)] for i in np.linspace(0, len(there) - 1, 5)]
    return vibeam.load(file, set={"sweep.frequency": few} | more)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_case_runs_and_meets_its_references(file: Path) -> None:
    case = shortened(file)
    result = vibeam.run(case)
    for branches in result.values():
        for _, response in branches.items():
            assert np.all(response.ended == Ended.COMPLETE.code)
            assert np.all(np.isfinite(response.amplitude))
    rows = check(case, result, partial=True)
    assert rows
    assert all(row.passed and row.points for row in rows), rows


def test_a_reference_can_be_missed() -> None:
    file = next(f for f in FILES if f.stem == "dtu_neutral")
    case = shortened(file, **{"stop.restitution": 0.7201})
    assert not any(row.passed for row in check(case, vibeam.run(case), partial=True))
