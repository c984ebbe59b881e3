"""The first sentence of a run: what suffices, as far as it is known, in every situation that a case may be in."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from stand_in import curve, one_mode

import vibeam
from vibeam.case.study_plans import VerdictPlan
from vibeam.casefile.read import parse
from vibeam.figures.units import METRIC
from vibeam.periodic.motion_kind import SteadyKind
from vibeam.report.comparison_words import Subject, both_numbers, cells, gravest
from vibeam.report.run_answer import run_answer
from vibeam.report.run_report import run_report
from vibeam.runs.comparison.ends import SweptEnd
from vibeam.runs.comparison.errors import AmplitudeError, Asked, EndError, KindDifference, ResponseComparison
from vibeam.runs.result import Result
from vibeam.system.response import Branches

GRID = np.linspace(14.0, 16.0, 41)
TOP = np.interp(GRID, [14.0, 15.0, 16.0], [1.0, 4.0, 1.0])
ONE, TWO, FREE, IRREGULAR = SteadyKind(1, 1), SteadyKind(2, 2), SteadyKind(-1), SteadyKind(0)
FIVE = Asked.of(0.05)


def result(ours: Any, theirs: Any = TOP, ours_has: str = "", theirs_has: str = "", **how: Any) -> Result:
    """Result of two fidelities, of one mode and of two, the second exact: the rig gives its one mode."""
    case = parse(one_mode(str(GRID.tolist()), 1, 1, "[fidelity.ours]", ours_has, "[fidelity.theirs]", theirs_has))
    parts = {"ours": curve(GRID, ours, **how), "theirs": curve(GRID, theirs, modes=2, **how)}
    return Result(case, {name: Branches(up) for name, up in parts.items()})


def answer(*given: Any, **how: Any) -> str:
    return run_answer(result(*given, **how))


def test_what_suffices_is_named_with_both_numbers() -> None:
    assert answer(0.98 * TOP).startswith("One mode suffices for 5 %: amplitudes within 2 %.")
    said = answer(1.2 * TOP)
    assert said.startswith("Two modes suffice for 5 % (all that the case gives). One mode is 20 % too high at ")


def test_an_error_at_one_frequency_decides() -> None:
    """An rms over all points would call it 1 %."""
    off = np.where(np.arange(41) == 7, 1.06, 1.0)
    said = answer(off * TOP)
    assert f"One mode is 6 % too high at {2 * np.pi * 14.35:.4g}." in said


def test_the_accuracy_of_the_case_decides() -> None:
    found = result(1.2 * TOP)
    asked = {**found.case.asked, "verdict": replace(VerdictPlan(), accuracy=0.25)}
    wide = Result(replace(found.case, asked=asked), dict(found))
    assert run_answer(wide).startswith("One mode suffices for 25 %: amplitudes within 20 %.")


def test_nothing_is_enough_whose_measure_is_not_known() -> None:
    """The finest is no exact solution here: pointwise mapping."""
    said = answer(0.98 * TOP, theirs_has='solver = "mapping"')
    assert said.startswith(
        "One mode is within 5 % of two modes: amplitudes within 2 %. How far two modes are off is not known"
    )
    said = answer(1.2 * TOP, theirs_has='solver = "mapping"')
    assert said.startswith("No other fidelity is known to be within 5 % of two modes. How far two modes are off is")
    assert "One mode is 20 % too high" in said
    assert "suffice" not in said


def test_a_branch_that_ends_late_is_no_small_thing() -> None:
    """Both at rest above their jump: 0.4 Hz late is 2.6 %, whatever the amplitudes before it."""
    theirs = np.where(GRID < 15.02, 1, -1)
    ours = np.where(GRID < 15.42, 1, -1)
    case = parse(one_mode(str(GRID.tolist()), 1, 1, "[fidelity.ours]", "[fidelity.theirs]"))
    parts = {"ours": curve(GRID, np.where(ours > 0, 1.0, 0.2), ours),
             "theirs": curve(GRID, np.where(theirs > 0, 1.0, 0.2), theirs, modes=2)}  # fmt: skip
    said = run_answer(Result(case, {name: Branches(up) for name, up in parts.items()}))
    assert "One mode jumps down 2.7 % late (" in said


def test_motions_without_impacts_points_that_failed_and_other_physics_are_said() -> None:
    apart = answer(2 * TOP, ours_has='set = { "stop.restitution" = 0.5 }')
    assert apart.startswith("No two of the 2 fidelities are of the same physics")
    assert "peaks are from 4 (theirs) to 8 (ours)." in apart
    assert answer(TOP, period=-1).startswith(
        "Nothing touches the stop. One mode suffices for 5 %: no contact in either."
    )
    assert " is held" not in answer(TOP, period=-1)
    assert answer(TOP, ended=3) == "No point was completed."
    failed = np.where(np.arange(41) > 20, 3, 0)
    said = run_answer(Result(*_failed(failed)))
    assert "may suffice (points failed from " in said


def _failed(ended: Any) -> tuple[vibeam.Case, dict[str, Branches]]:
    case = parse(one_mode(str(GRID.tolist()), 1, 1, "[fidelity.ours]", "[fidelity.theirs]"))
    return case, {"ours": Branches(curve(GRID, TOP, ended=ended)), "theirs": Branches(curve(GRID, TOP, modes=2))}


def test_of_many_that_miss_the_first_are_named() -> None:
    off = {"a": 1.6, "b": 1.5, "c": 1.4, "d": 1.3, "top": 1.0}
    case = parse(one_mode(str(GRID.tolist()), 1, 1, *(f"[fidelity.{name}]" for name in off)))
    parts = {name: Branches(curve(GRID, by * TOP, modes=1 + (name == "top"))) for name, by in off.items()}
    said = run_answer(Result(case, parts))
    assert re.search(r" a is 60 % too high at [\d.]+; b is 50 % too high at [\d.]+; 2 more are off as well\.", said)


@pytest.mark.parametrize(
    ("solver", "said"),
    [
        ("flight", "all that the case gives, computed exactly"),
        ("mapping", "alone, and how far it is off is not known"),
    ],
)
def test_one_fidelity_alone_says_what_is_known_of_it(solver: str, said: str) -> None:
    case = parse(one_mode(str(GRID.tolist()), 1, 1, f'[fidelity.ours]\nsolver = "{solver}"'))
    found = run_answer(Result(case, {"ours": Branches(curve(GRID, TOP))}))
    assert found.startswith(f"ours (1 mode) is {said}")
    assert "; its peak is 4 at " in found


def compared(found: Result, **own: Any) -> Result:
    """The result with its finest beside a fuller model of nine modes, as far off as is given."""
    [ours, theirs] = found.compare()
    found.compared = (ours, replace(theirs, whole=False, modes=9, comparison=ResponseComparison(**own)))
    return found


def test_a_reference_that_is_itself_off_makes_nothing_suffice() -> None:
    near = AmplitudeError(0.02, 15.0, "up", 1.02, 1.0)
    said = run_answer(compared(result(0.98 * TOP), amplitude=near, scattered=near))
    assert said.startswith(
        "One mode suffices for 5 %: amplitudes within 2 %. Two modes, the reference, are off as well: "
    )
    far = replace(near, error=0.07)
    said = run_answer(compared(result(0.98 * TOP), amplitude=far, scattered=far))
    assert said.startswith("No fidelity suffices for 5 %: two modes, the finest, are 7 % too high at 94.25 beside nine")
    open_ = replace(near, scatter=0.03)
    said = run_answer(compared(result(0.98 * TOP), amplitude=open_, scattered=open_))
    assert said.startswith(
        "One mode is within 5 % of two modes: amplitudes within 2 %. Whether two modes suffice is open"
    )


def end(at: float, before: SteadyKind, after: SteadyKind, step: float = 0.0, direction: str = "up") -> SweptEnd:
    return SweptEnd(at, 0.01, before, after, direction, step)


@pytest.mark.parametrize(
    ("before", "after", "step", "said"),
    [
        (ONE, FREE, -0.6, "two modes jump down 2 % late (102 for 100 Hz)"),
        (ONE, FREE, 0.0, "two modes leave the stop 2 % late (102 for 100 Hz)"),
        (FREE, ONE, 0.0, "two modes touch the stop 2 % late (102 for 100 Hz)"),
        (ONE, TWO, 0.0, "two modes double the period 2 % late (102 for 100 Hz)"),
        (ONE, IRREGULAR, 0.0, "two modes stop repeating 2 % late (102 for 100 Hz)"),
        (IRREGULAR, TWO, 0.0, "two modes repeat again 2 % late (102 for 100 Hz)"),
        (ONE, SteadyKind(1, 2), 0.0, "two modes change the impacts a period 2 % late (102 for 100 Hz)"),
        (ONE, ONE, 0.5, "two modes jump up 2 % late (102 for 100 Hz)"),
    ],
)  # fmt: skip
def test_every_end_has_its_words(before: SteadyKind, after: SteadyKind, step: float, said: str) -> None:
    found = ResponseComparison(
        ends=(EndError(0.02, 1e-3, end(102, before, after, step), end(100, before, after, step)),)
    )
    who, other = Subject("two modes", plural=True), Subject("eight modes", plural=True)
    assert gravest(who, other, found, FIVE, METRIC) == said
    single = gravest(Subject("one mode"), other, found, FIVE, METRIC)
    assert re.match(r"one mode (jumps|leaves|touches|doubles|stops|repeats|changes) ", single)


def test_early_and_late_are_of_the_way_of_the_sweep() -> None:
    down = EndError(0.02, 1e-3, end(102, ONE, FREE, -0.5, "down"), end(100, ONE, FREE, -0.5, "down"))
    assert "the jump down 2 % early (102 for 100 Hz)" in both_numbers(ResponseComparison(ends=(down,)), METRIC)
    near = replace(down, error=5e-4)
    assert both_numbers(ResponseComparison(ends=(near,)), METRIC) == "ends of branches within 0.2 %"


def test_a_difference_in_kind_is_named_where_it_is() -> None:
    found = ResponseComparison(kinds=(KindDifference(100.0, 103.0, 1e-3, "down", IRREGULAR, TWO),))
    said = gravest(Subject("two modes", plural=True), Subject("eight modes", plural=True), found, FIVE, METRIC)
    assert said == (
        "two modes do not repeat from 100 to 103 Hz swept down, where eight modes have period 2 with 2 impacts"
    )
    assert cells(found) == ("–", "–", "3 %")


def test_the_report_has_the_errors_of_all_and_marks_those_of_the_finest() -> None:
    near = AmplitudeError(0.02, 15.0, "up", 1.02, 1.0)
    found = compared(result(1.2 * TOP), amplitude=near, scattered=near)
    table = run_report(found).tables[0]
    columns = {str(column.header): [str(each) for each in column._cells] for column in table.columns}
    assert columns["amplitudes"] == ["20 %", "[2 %]"]
    assert "[ ]: theirs against nine modes" in str(table.caption)
