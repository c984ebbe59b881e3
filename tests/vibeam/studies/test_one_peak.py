"""One peak of one sweep, whoever asks: run, check, influence and uncertainty."""

from __future__ import annotations

from pathlib import Path

import pytest

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.report.run_report import fidelities
from vibeam.runs.comparison.beyond import response_of
from vibeam.runs.result import Result
from vibeam.runs.summary import compare
from vibeam.studies.regression.check import check
from vibeam.studies.swept_numbers import refined_peak
from vibeam.studies.uncertainty.samples import Sampler

NEUTRAL = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"

EXPECTED = """
[expect.height]
quantity = "peak"
fidelity = "sdof"
direction = "up"
value = "0.3883 mm"
tolerance = "1 %"
source = "x"
"""

TOO_SHORT = {"sweep.frequency.points": 7, "sweep.settle": 12, "sweep.hold": 8, "sweep.direction": "up"}  # to settle


@pytest.fixture(scope="module")
def case() -> Case:
    text = NEUTRAL.read_text("utf-8").split("[reference.exact]")[0] + EXPECTED
    return parse(text, NEUTRAL, set=TOO_SHORT)


@pytest.fixture(scope="module")
def result(case: Case) -> Result:
    return vibeam.run(case, show=False)


def test_all_commands_have_one_peak_of_a_sweep_that_does_not_repeat_there(case: Case, result: Result) -> None:
    top = compare(result)[0].peak
    assert top.amplitude == pytest.approx(0.3883e-3, rel=1e-3)
    assert not top.repeats
    (row,) = check(case, result, partial=True)
    assert (row.passed, row.notes[0]) == (True, "up: the motion at the peak does not repeat")
    swept = response_of(case, "sdof", case.system("sdof"), len(case.sweep.frequency))
    assert swept is not None
    own = refined_peak(swept)
    assert (own.amplitude, own.frequency) == (top.amplitude, top.frequency)
    assert own.why == "the motion at the peak does not repeat"
    sampled = Sampler(case, ()).nominal("sdof")
    assert (sampled.peak[0], sampled.peak_frequency[0]) == pytest.approx((top.amplitude, top.frequency), rel=1e-12)


def test_a_peak_that_does_not_repeat_is_marked(result: Result) -> None:
    table = fidelities(compare(result), {})
    cell = next(column for column in table.columns if "peak" in str(column.header))
    assert str(next(iter(cell.cells))).endswith("*")
    assert "*: the motion at the peak does not repeat" in str(table.caption)
