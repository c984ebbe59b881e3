"""References at their own frequencies: flown there, of either branch, with their uncertainty; recorded ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stand_in import SDOF

import vibeam
from vibeam.casefile.read import parse
from vibeam.report.references import references_figure
from vibeam.runs.result import Result
from vibeam.studies.regression.check import at_references
from vibeam.studies.regression.references import require_readable

CASES = Path(__file__).parents[3] / "cases"
OFF = 2.17 / (2 * np.pi)  # Hz, between the third and the fourth frequency of the sweep


def without_stop() -> vibeam.Case:
    """A linear oscillator of natural frequency 1 rad/s and 1.5 % damping: the stop is out of reach."""
    return parse(SDOF.replace("gap = 0.0", "gap = 1.0").replace("settle = 20", "settle = 600"))


def exact(frequency: float) -> float:
    """Amplitude over a base motion of 0.5e-3: B r²/√((1 − r²)² + (2 ζ r)²)."""
    r = 2 * np.pi * frequency
    return float(0.5e-3 * r**2 / np.hypot(1 - r**2, 0.03 * r))


def test_a_point_off_the_grid_is_flown_there() -> None:
    case = without_stop()
    assert not np.isclose(case.sweep.frequency, OFF).any()
    curve = vibeam.ReferenceCurve.of([OFF], [exact(OFF)])
    (row,) = vibeam.check(case.with_reference("point", curve, "sdof", tolerance=1e-6))
    assert (row.passed, row.points, row.total) == (True, 1, 1)
    off = vibeam.ReferenceCurve.of([OFF], [1.01 * exact(OFF)])
    (row,) = vibeam.check(case.with_reference("point", off, "sdof", tolerance=1e-3))
    assert row.passed is False
    assert "1 of 1 points off by more than allowed: 0.345366 Hz" in row.notes[0]
    assert "(-0.99 %)" in row.notes[0]


def test_what_the_sweep_has_is_not_flown_anew() -> None:
    case = without_stop()
    result = vibeam.run(case, show=False)
    on = vibeam.ReferenceCurve.of(case.sweep.frequency, result["sdof"].up.amplitude)
    with_both = case.with_reference("on", on, "sdof").with_reference(
        "off", vibeam.ReferenceCurve.of([OFF], [1.0]), "sdof"
    )
    found = at_references(with_both, result)
    assert found["on"] is result["sdof"]
    assert len(found["off"].up) == len(case.sweep.frequency) + 1


def test_a_point_beyond_the_sweep_is_told() -> None:
    case = without_stop().with_reference("far", vibeam.ReferenceCurve.of([9.0, OFF], [1.0, exact(OFF)]), "sdof", 1e-6)
    (row,) = vibeam.check(case)
    assert (row.passed, row.points) == (False, 1)
    assert "1 of 2 reference points are outside the sweep, 0.238732 … 0.397887 Hz: widen it, or give" in row.notes[0]


def test_twice_the_uncertainty_is_allowed_beside_the_tolerance() -> None:
    case, wrong = without_stop(), 1.05 * exact(OFF)
    for uncertainty, passed in ((0.026 * wrong, True), (0.02 * wrong, False)):
        curve = vibeam.ReferenceCurve.of([OFF], [wrong], uncertainty=uncertainty)
        (row,) = vibeam.check(case.with_reference("point", curve, "sdof", tolerance=1e-6))
        assert row.passed is passed


def test_without_a_direction_the_nearer_branch_counts() -> None:
    case = without_stop()
    result = vibeam.run(case, show=False)
    down = replace(result["sdof"].down, amplitude=2 * result["sdof"].down.amplitude)
    both = vibeam.Branches(result["sdof"].up, down)
    f, a = case.sweep.frequency, result["sdof"].up.amplitude
    curve = vibeam.ReferenceCurve.of(f, np.where(np.arange(len(f)) % 2, a, 2 * a))
    (row,) = vibeam.check(case.with_reference("either", curve, "sdof", 1e-9), Result(case, {"sdof": both}))
    assert row.passed
    assert "each point is compared with the nearer branch" in row.notes[-1]


def test_a_measured_curve_has_no_verdict_without_a_tolerance() -> None:
    (row,) = vibeam.check(without_stop().with_reference("m", vibeam.ReferenceCurve.of([OFF], [9.0]), "sdof"))
    assert (row.passed, row.kind) == (None, "measured")


def test_arrays_that_are_no_curve() -> None:
    for arguments, said in (
        (([1.0, 2.0], [1.0]), "must be of one shape"), (([-1.0], [1.0]), "above 0 Hz"), (([np.nan], [1.0]), "finite"),
        (([1.0], [1.0], "amplitud"), "did you mean 'amplitude'"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=said):
            vibeam.ReferenceCurve.of(*arguments)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="up or down"):
        vibeam.ReferenceCurve.of([1.0], [1.0], direction="left")
    with pytest.raises(ValueError, match="standard deviation"):
        vibeam.ReferenceCurve.of([1.0], [1.0], uncertainty=-1.0)
    with pytest.raises(KeyError, match="there are sdof"):
        without_stop().with_reference("m", vibeam.ReferenceCurve.of([1.0], [1.0]), "beam")


HEAD = '[reference.m]\nfile = "m.csv"\nfidelity = "sdof"\nquantity = "amplitude"\n'


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("", ': reference.m.tolerance: missing: write tolerance = "1 %", or measured = true'),
        ("measured = true\nwindow = [1]", "window: must be two frequencies"),
        ("measured = true\ncolumns = { amplitud = 2 }", "'amplitud' is no column of a reference; did you mean 'ampl"),
        ("measured = true\ncolumns = { reach = 2 }", 'columns: reach is not compared: quantity = "amplitude"'),
        ("measured = true\ncolumns = { amplitude = 0 }", "amplitude: must be a head in quotes or a column's number"),
        ("measured = true\nunits = { amplitude = \"furlong\" }", "'furlong' is no unit that is known"),
        ('measured = true\nscale = "2 mm/furlong"', "has an unknown unit"),
        ("measured = true\nscale = 0", "is 0: no value would be left"),
        ('measured = true\nuncertainty = "2 kg"', "2 kg"),
        ('measured = true\nseparator = ";"', "separator: ';' is not one of \"semicolon\""),
    ],
)  # fmt: skip
def test_faults_of_the_table_are_told(tmp_path: Path, keys: str, said: str) -> None:
    (tmp_path / "m.csv").write_text("f,a\n1,2\n")
    with pytest.raises(vibeam.CaseError) as caught:
        parse(SDOF + HEAD + keys + "\n", tmp_path / "case.toml")
    assert said in str(caught.value)
    assert len(caught.value.faults) == 1


def test_a_table_is_written_back_as_it_was_read(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("f,a,s\n1,2,1\n")
    keys = 'columns = { frequency = "f", amplitude = 2 }\nscale = "2 1/V"\nunits = { amplitude = "mV" }\n'
    more = 'window = [0.1, 2]\nuncertainty = "2 %"\noffset = 0.5\nmeasured = true\ndecimal = "."\nseparator = "comma"\n'
    case = parse(SDOF + HEAD + keys + more, tmp_path / "case.toml")
    again = parse(case.text, tmp_path / "case.toml")
    assert again.references == case.references
    require_readable(case)
    curve = vibeam.read_curve(tmp_path / "m.csv", form=case.references["m"].form)
    np.testing.assert_allclose(curve.value, [2 * 2e-3 + 0.5])
    np.testing.assert_allclose(curve.uncertainty, 0.02 * curve.value)


def test_references_are_drawn_in_the_unit_of_what_the_output_reads() -> None:
    case = vibeam.load(CASES / "dtu_sensors.toml", set={"sweep.frequency": ["14.5 Hz", "15 Hz"], "sweep.settle": 20})
    measured = case.with_reference("gauge", vibeam.ReferenceCurve.of([14.5, 15.0], [2e-4, 2e-4]), "sdof")
    result = vibeam.run(measured)
    found = at_references(measured, result)
    made = references_figure(measured, vibeam.check(measured, result), found)
    assert made.axes[0].get_ylabel() == "amplitude (µε)"
    assert made.axes[0].get_ylim()[1] > 200
