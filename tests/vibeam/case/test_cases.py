"""Every file in ``cases/`` runs, short, and meets its references there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from case_files import SWEPT
from stand_in import SI

import vibeam
from vibeam.case.case import Case
from vibeam.studies.regression import check as expect
from vibeam.studies.regression.readings import compare
from vibeam.studies.regression.references import check
from vibeam.system.response import Ended

STEPPED = ("direct", "zhuravlev", "ivanov", "moreau")
ANALYTICAL = ("mapping", "averaging", "orbit")  # they say where they have no motion
WHOLE = 201  # points of a sweep up to which it is run as it is
FILES = SWEPT
SLOW = ("two_stops", "dtu_harmonic", "fig27_drive", "fig27_damping", "fig27_mass")  # 10 to 30 s each; fig27 stays
SLOW += ("fig22_gap", "fig28_mass")  # fig22 and fig28 stay
SLOW += ("hammer", "discs", "stuttgart_left")  # solids of more than 5000 coordinates
JUMPING = ("sdof_nominal", "sdof_methods")  # which of two motions is met hangs on the points between
LINGERING = ("dtu_tight",)  # at its lowest frequencies a motion from rest may take longer than it settles to repeat


def shortened(file: Path, **more: object) -> Case:
    """The case at a few of its reference's frequencies, the ends and the middle among them."""
    case = vibeam.load(file)
    if not case.references:
        return expecting(case, **more)
    first = next(iter(case.references.values()))
    there = sorted({p.frequency for p in first.points() if p.value is not None})
    there = there[len(there) // 3 if file.stem in LINGERING else 0 :]
    count = 5 if file.stem in JUMPING else 3
    few = [there[round(i)] for i in np.linspace(0, len(there) - 1, count)]
    return vibeam.load(file, set=SI | {"sweep.frequency": few} | more)


def expecting(case: Case, **more: object) -> Case:
    """The case at the frequencies where it expects something; where that is of whole branches, a small sweep at all.

    A large sweep is then run near them, and so is the way up to where motions end: a long jump would carry a motion
    that does not repeat there. Integration by steps, which takes seconds a point, settles from rest at one frequency in
    fewer periods. What is read off a figure needs no sweep; the peaks of the experiment lie anywhere in
    it.
    """
    swept = [each for each in case.expectations.values() if each.show is None]
    wanted = {each.frequency for each in swept if each.frequency is not None}
    whole = any(each.frequency is None for each in swept)
    if not swept or (whole and case.path.parent.name == "experiment"):
        return vibeam.load(case.path, set=more if swept else {"sweep.frequency": ["14.5 Hz"]} | more)
    small = len(case.sweep.frequency) <= WHOLE
    near = (1.0 if small else 0.04) if whole else 1e-9  # 1: everywhere
    swept_at = case.sweep.frequency.tolist()
    ends = {each.frequency for each in swept if each.quantity == "period" and each.value == -1 and each.frequency}
    grid = [
        f
        for f in swept_at
        if not wanted
        or any(np.isclose(f, each, rtol=near) for each in wanted)
        or any(0.97 * end < f < end for end in ends)
    ]
    stepped = any(each.solver in STEPPED for each in case.fidelities.values())
    settle = {"sweep.settle": 60, "sweep.direction": "up"} if stepped else {}
    return vibeam.load(case.path, set=SI | {"sweep.frequency": grid} | settle | more)


@pytest.mark.parametrize(
    "file",
    [pytest.param(file, marks=pytest.mark.slow) if file.stem in SLOW else file for file in FILES],
    ids=lambda file: file.stem,
)
def test_a_case_runs_and_meets_its_references(file: Path) -> None:
    case = shortened(file)
    result = vibeam.run(case, show=False)
    for name, branches in result.items():
        for _, response in branches.items():
            there = response.ended == Ended.COMPLETE.code
            without = case.fidelities[name].solver in ANALYTICAL and response.ended == Ended.NO_ORBIT.code
            assert np.all(there | without)
            assert np.all(np.isfinite(response.amplitude[there]))
    rows = check(case, result, partial=True) + expect.check(case, result, partial=True)
    assert rows or case.measured
    assert all((row.passed or row.kind == "measured") and row.points for row in rows), rows
    figures = {name for name, each in case.measured.items() if each.show}
    assert not [row.notes for row in compare(case, result) if row.measured in figures and row.notes]


def test_every_numerical_figure_of_the_paper_has_its_case() -> None:
    names = {file.stem for file in FILES if file.parent.name == "paper"}
    assert "eq38" in names
    numbers = {int(name.removeprefix("fig")) for name in names - {"eq38"}}
    assert numbers == {3, 5, 6, 7, 8, 9, 10, 11, 13, 14}


def test_every_experiment_of_the_paper_has_its_case() -> None:
    names = {file.stem for file in FILES if file.parent.name == "experiment"}
    numbers = ("17", "18a", "18b", "18c", "19", "20", "21", "22", "22_gap", "25", "27", "28", "28_mass", "30")
    assert names >= {*(f"fig{number}" for number in numbers), "ridge"}


@pytest.mark.parametrize("change", [{"stop.restitution": 0.62}, {"sdof.damping_ratio": 0.02}])
def test_an_expected_number_can_be_missed(change: dict[str, float]) -> None:
    file = next(f for f in FILES if f.stem == "fig11")
    case = shortened(file, **change)
    rows = {row.reference: row.passed for row in expect.check(case, vibeam.run(case, show=False), partial=True)}
    assert not rows["of_the_exact"]


def test_a_reference_can_be_missed() -> None:
    file = next(f for f in FILES if f.stem == "dtu_neutral")
    case = shortened(file, **{"stop.restitution": 0.7201})
    assert not any(row.passed for row in check(case, vibeam.run(case), partial=True))
