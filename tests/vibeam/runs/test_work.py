"""Work that is counted by what is computed: budgets that do not depend on the machine."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from stand_in import RIG

from vibeam.casefile.read import load
from vibeam.runs.comparison import beyond
from vibeam.runs.comparison.beyond import response_of
from vibeam.runs.comparison.errors import Asked
from vibeam.runs.comparison.simulator import CaseSimulator, simulator_of
from vibeam.runs.comparison.work import PATIENCE, START, Work, WorkRate, WorkSpent

SHORT: dict[str, Any] = {
    "sweep.frequency": {"from": "14.9 Hz", "to": "15.7 Hz", "points": 9}, "sweep.direction": "up",
    "sweep.settle": 40, "sweep.hold": 5,
}  # fmt: skip
LINEAR = {"stop.law": "linear", "stop.stiffness": "1e6 N/m", "stop.restitution_of": "contact"}


@pytest.mark.parametrize("law", [{}, LINEAR, {"stop.second_gap": "2 mm"}])
def test_work_does_not_depend_on_the_time_that_it_took(law: dict[str, Any]) -> None:
    case = load(RIG, set=SHORT | law)
    simulator = simulator_of(case, "beam")
    assert simulator is not None
    found, _ = simulator.at(15.2, None)
    rate = WorkRate.of(case.scene_of("beam"))
    slow = replace(found, cpu_seconds=1000 * found.cpu_seconds)
    assert rate.seconds(slow, 45) == rate.seconds(found, 45) > 0


def test_work_grows_with_modes_and_periods() -> None:
    case, spent = load(RIG, set=SHORT), dict[str, float]()
    for name in ("two_modes", "beam"):
        work = Work()
        assert response_of(case, name, case.system(name), 9, work) is not None
        spent[name] = work.spent
    assert spent["two_modes"] < spent["beam"]
    longer, work = load(RIG, set=SHORT | {"sweep.settle": 400}), Work()
    response_of(longer, "beam", longer.system("beam"), 9, work)
    assert 5 < work.spent / spent["beam"] < 15  # 405 for 45 periods


def test_a_sweep_that_does_not_fit_is_broken_off() -> None:
    case, whole = load(RIG, set=SHORT), Work()
    assert response_of(case, "beam", case.system("beam"), 9, whole) is not None
    work = Work(0.4 * whole.spent)
    assert response_of(case, "beam", case.system("beam"), 9, work) is None
    assert work.spent < 0.9 * whole.spent
    assert response_of(case, "beam", case.system("beam"), 9, Work(1.1 * whole.spent)) is not None


def test_a_long_point_is_broken_off_in_its_middle() -> None:
    case = load(RIG, set=SHORT | {"sweep.settle": 100_000})
    work = Work(1e-4, breaks=True)
    with pytest.raises(WorkSpent):
        CaseSimulator(case, "beam", work=work).at(15.2, None)
    assert work.spent < 0.01


def test_pieces_of_a_point_are_the_point() -> None:
    case = load(RIG, set=SHORT | {"sweep.settle": 700})
    whole, _ = CaseSimulator(case, "beam").at(15.2, None)
    parts, _ = CaseSimulator(case, "beam", work=Work(breaks=True)).at(15.2, None)
    np.testing.assert_allclose(parts.amplitude, whole.amplitude, rtol=1e-9)


def test_a_machine_far_slower_than_what_is_counted_ends_too() -> None:
    work = Work(1.0)
    work.add(0.1, 0.9 * PATIENCE)
    assert not work.done
    work.add(0.1, 0.2 * PATIENCE + START)
    assert work.done


def test_a_fuller_model_that_surely_does_not_fit_is_not_made(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load(RIG, set=SHORT)
    own = response_of(case, "beam", case.system("beam"), 9)
    assert own is not None
    monkeypatch.setattr(beyond, "system", pytest.fail)
    found = beyond.beside_fuller(case, "beam", own, case.system("beam").size, Asked(), a_place=1e3)
    assert found.comparison is None
    assert "takes longer than" in found.why
