"""The comparison of fidelities, and the check against reference curves."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import SDOF, case, curve

from vibeam.case.fidelity import restitutions
from vibeam.case.plans import Reference
from vibeam.casefile.read import load, parse
from vibeam.exchange.curves.reference import read_curve
from vibeam.exchange.faults import CaseError, printable, shortest
from vibeam.runs.result import Result
from vibeam.runs.summary import compare
from vibeam.studies.regression.references import CheckRow, check
from vibeam.system.response import Branches, Ended

GRID = np.linspace(14.0, 17.0, 7)
HUMP = np.array([1.0, 2.0, 4.0, 8.0, 4.0, 2.0, 1.0])


def result(**branches: Branches) -> Result:
    return Result(case(), branches)


def test_summary_of_each_fidelity() -> None:
    coarse = Branches(curve(GRID, HUMP), curve(GRID[::-1], HUMP + 1))
    fine = Branches(
        curve(GRID, 2 * HUMP, modes=8, cpu_seconds=4e-3), curve(GRID[::-1], HUMP, modes=8, cpu_seconds=4e-3)
    )
    first, second = compare(result(coarse=coarse, fine=fine))
    assert (first.fidelity, first.modes, first.peak.amplitude, first.peak.frequency) == ("coarse", 1, 9.0, 15.5)
    assert (first.peak.direction, second.peak.direction) == ("down", "up")
    assert (first.cost_ratio, second.cost_ratio) == (1.0, 4.0)
    assert (first.impacts, second.failed) == (1400, 0)
    assert first.nanoseconds_per_impact == pytest.approx(1e4)
    assert second.distance is None
    assert first.distance is not None
    relative = np.concatenate((np.full(7, -0.5), 1 / HUMP))
    assert first.distance.points == 14
    assert first.distance.worst == 1.0
    assert first.distance.rms == pytest.approx(np.sqrt(np.mean(relative**2)))


def test_distance_is_over_points_where_both_are_periodic() -> None:
    period = np.array([1, 0, 1, 1, 1, 1, -1])
    ended = np.array([0, 0, 1, 0, 0, 0, 0])
    ours = Branches(curve(GRID, np.where(period == 0, 99.0, HUMP), period, ended=ended))
    other = Branches(curve(GRID, HUMP, np.array([1, 1, 1, 0, 1, 1, 1])))
    measured = ours.off(other)
    assert (measured.points, measured.total, measured.worst) == (4, 7, 0.0)
    assert measured.peak == 99 / 8 - 1  # the motions at the peaks need not repeat
    assert Branches(up=ours.up).off(Branches(down=other.up)).points == 0


def test_the_peak_is_the_highest_complete_point_whether_it_repeats_or_not() -> None:
    wild = curve(GRID, HUMP, np.array([1, 1, 1, 0, 1, 1, 1]))
    failed = replace(wild, ended=np.array([0, 0, 0, 1, 0, 0, 0]))
    assert (wild.peak.amplitude, wild.peak.frequency, wild.peak.point, wild.peak.repeats) == (8.0, 15.5, 3, False)
    assert (failed.peak.amplitude, failed.peak.point, failed.peak.repeats) == (4.0, 2, True)
    both = Branches(failed, wild)
    assert (both.peak.amplitude, both.peak.direction) == (8.0, "down")
    assert np.isnan(failed.off(wild).peak)  # the other's peak is at a point that this one has not
    assert wild.off(failed).peak == 1.0


@pytest.mark.parametrize(
    ("period", "expected"),
    [
        ([1, 1, 1, 1, 1, 1, 1], (14.0, 17.0)),
        ([-1, 1, 1, 1, 2, 1, 1], (14.5, 15.5)),
        ([1, 0, 1, 1, 1, -1, 1], (15.0, 16.0)),
        ([1, 1, 0, 0, 0, 0, 0], (14.0, 14.5)),
        ([-1, 0, 2, -1, 0, 0, 3], None),
    ],
)
def test_period_one_range_is_the_contiguous_one_around_its_largest_amplitude(period: Any, expected: Any) -> None:
    response = curve(GRID, HUMP, np.array(period))
    assert response.period_one == expected
    reversed_ = curve(GRID[::-1], HUMP[::-1], np.array(period)[::-1])
    assert reversed_.period_one == expected


def test_a_failed_point_ends_the_range_and_is_counted() -> None:
    ended = np.where(GRID == 15.0, Ended.EVENT_LIMIT.code, Ended.COMPLETE.code)
    branches = Branches(curve(GRID, np.where(GRID == 15.0, np.nan, HUMP), ended=ended))
    assert compare(result(only=branches))[0].failed == 1
    assert compare(result(only=branches))[0].period_one == {"up": (15.5, 17.0)}


def test_a_fidelity_that_failed_everywhere_has_no_numbers_and_no_error() -> None:
    nothing = Branches(curve(GRID, np.nan, 0, ended=1, impacts=0, cpu_seconds=np.nan))
    row = compare(result(only=nothing, other=Branches(curve(GRID, HUMP))))[0]
    assert np.isnan([row.peak.amplitude, row.peak.frequency, row.nanoseconds_per_impact]).all()
    assert (row.period_one, row.failed) == ({"up": None}, 7)


HEAD = "# a comment\nfrequency_hz,direction,amplitude,maximum,minimum,reach,impacts_per_period,impact_velocity,period\n"


def checked(
    tmp_path: Path, lines: str, branches: Branches, partial: bool = False, head: str = HEAD, **changes: Any
) -> CheckRow:
    file = tmp_path / "curve.csv"
    file.write_text(head + lines, encoding="utf-8")
    usual = {"fidelity": "sdof", "quantity": "amplitude", "tolerance": 0.01, "direction": "both"}
    reference = Reference(name="exact", file=file, **(usual | changes))

    class Case:
        references = {"exact": reference}  # noqa: RUF012

    return check(Case, result(sdof=branches), partial=partial)[0]  # type: ignore[arg-type]


BOTH = Branches(curve(GRID, HUMP), curve(GRID[::-1], HUMP))


def test_a_reference_that_is_met(tmp_path: Path) -> None:
    row = checked(tmp_path, "14,up,1.005,,,,,,1\n14.5,down,2,,,,,,1\n", BOTH)
    assert (row.passed, row.points, row.total, row.notes) == (True, 2, 2, ())
    assert row.worst == pytest.approx(0.005 / 1.005)
    assert (row.frequency, row.tolerance) == (14.0, 0.01)


def test_a_difference_beyond_the_tolerance_is_a_miss(tmp_path: Path) -> None:
    row = checked(tmp_path, "14,up,1.0,,,,,,1\n15,down,4.05,,,,,,1\n", BOTH)
    assert (row.passed, row.frequency) == (False, 15.0)
    assert checked(tmp_path, "14,up,1.0,,,,,,1\n15,down,4.05,,,,,,1\n", BOTH, tolerance=0.02).passed


def test_another_period_is_a_miss_even_without_a_value(tmp_path: Path) -> None:
    for line in ("14,up,1.0,,,,,,2\n", "14,up,,,,,,,0\n"):
        row = checked(tmp_path, line, BOTH)
        assert (row.passed, row.worst) == (False, 0.0)
        assert "at 14 Hz up: period 1, not" in row.notes[0]


def test_empty_cells_and_other_directions_are_not_compared(tmp_path: Path) -> None:
    row = checked(tmp_path, "14,up,1,,,,,,1\n14.5,up,,9,,,,,\n15,down,99,,,,,,1\n", BOTH, direction="up")
    assert (row.passed, row.total) == (True, 1)


def test_a_point_off_the_grid_is_a_miss_unless_the_grid_was_overridden(tmp_path: Path) -> None:
    lines = "14,up,1,,,,,,1\n14.00001,up,1,,,,,,1\n14.000000001,up,1,,,,,,1\n"
    row = checked(tmp_path, lines, BOTH)
    assert (row.passed, row.points, row.total) == (False, 2, 3)
    assert row.notes == ("1 of 3 reference points are not in the sweep's grid",)
    assert checked(tmp_path, lines, BOTH, partial=True).passed


def test_no_match_at_all_is_a_miss(tmp_path: Path) -> None:
    for partial in (True, False):
        assert not checked(tmp_path, "1,up,1,,,,,,1\n", BOTH, partial).passed
        assert not checked(tmp_path, "14,down,1,,,,,,1\n", Branches(up=BOTH.up), partial).passed
        none = checked(tmp_path, "14,down,1,,,,,,1\n", BOTH, partial, direction="up")
        assert (none.passed, none.notes) == (False, ("the file has no such point",))


def test_a_point_that_failed_is_a_miss_with_its_reason(tmp_path: Path) -> None:
    failed = Branches(curve(GRID, HUMP, ended=Ended.NOT_FINITE.code))
    row = checked(tmp_path, "14,up,1,,,,,,1\n", failed, tolerance=1e9)
    assert (row.passed, row.worst) == (False, float("inf"))
    assert "overflowed" in row.notes[0]


def test_a_number_that_is_none_is_a_miss(tmp_path: Path) -> None:
    assert not checked(tmp_path, "14,up,1,,,,,,1\n", Branches(curve(GRID, np.nan)), tolerance=1e9).passed


def test_a_value_of_zero_is_compared_with_the_largest(tmp_path: Path) -> None:
    touching = Branches(curve(GRID, HUMP, maximum=np.where(GRID == 14.0, 1e-12, HUMP)))
    lines = "14,up,,0,,,,,1\n15.5,up,,8,,,,,1\n"
    assert checked(tmp_path, lines, touching, quantity="maximum", tolerance=1e-6).passed
    assert not checked(tmp_path, lines, touching, quantity="maximum", tolerance=1e-7).passed


@pytest.mark.parametrize(
    ("head", "lines", "message"),
    [
        (HEAD, "", ": has no line of numbers below its heads"),
        ("frequency_hz,direction\n", "", "write frequency_hz,direction,amplitude, or name its own in the case"),
        ("frequency_hz,direction,amplitude,amplitud\n", "14,up,1,1", "did you mean 'amplitude'"),
        ("frequency_hz,direction,amplitude,direction\n", "", ": has 2 columns 'direction': say which"),
        (HEAD, "14,sideways,1,,,,,,1\n", ":3: direction 'sideways' is neither up nor down"),
        (HEAD, "14,up,one,,,,,,1\n", ":3: 'one' is not a number"),
        (HEAD, "14,up\n", ":3: 2 cells for 9 columns"),
        (HEAD, "14,up,1,,,,,,1,7,8\n", ":3: 11 cells for 9 columns"),
        (HEAD, "14,up,1,,,,,,1.5\n", ":3: the period '1.5' is not a whole number"),
        (HEAD, "0,up,1,,,,,,1\n", ":3: the frequency 0 Hz is not above 0"),
        (HEAD, "14,up,1e400,,,,,,1\n", ":3: '1e400' is not a finite number"),
        (HEAD, f"14,up,1,,,,,,{'1' * 5000}\n", ":3: the period '11"),
        (HEAD, f"14,up,1,,,,,,1{' ' * 200_000}\n", ":3: has 200014 characters; a line may have 100000"),
    ],
)
def test_a_file_that_is_no_reference_says_where(tmp_path: Path, head: str, lines: str, message: str) -> None:
    with pytest.raises(CaseError) as caught:
        checked(tmp_path, lines, BOTH, head=head)
    assert message in str(caught.value)
    assert shortest(tmp_path / "curve.csv") in str(caught.value)


def test_a_reference_that_cannot_be_read_says_so(tmp_path: Path) -> None:
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00")
    os.mkfifo(tmp_path / "pipe.csv")
    with (tmp_path / "vast.csv").open("wb") as file:
        file.truncate(6 * 10**9)
    (tmp_path / "empty.csv").touch()
    (tmp_path / "zeros.csv").write_bytes(bytes(10_000_000))
    for name, message in {
        "": ": is a folder, not a file",
        "none.csv": ": no such file",
        "\0": ": no such file",
        "empty.csv": ": is empty",
        "b.csv": ": cannot be read: it is not UTF-8 text",
        "pipe.csv": ": is not a regular file",
        "vast.csv": ": has 6000 MB; such a file may have 100 MB at most",
        "zeros.csv": ": cannot be read: it is not UTF-8 text",
    }.items():
        path = tmp_path / name
        with pytest.raises(CaseError) as caught:
            read_curve(path, "amplitude").along(("up", "down"))
        assert str(caught.value) == printable(f"{shortest(path)}{message}")


@pytest.mark.parametrize("text", ["14,up,1\n15,up,2\n", "# nothing\n", "x,y\n1,2\n", "\n\n14 up 1\n"])
def test_a_reference_without_a_heading_is_one_fault(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        read_curve(tmp_path / "a.csv", "reach").along(("up", "down"))
    assert len(caught.value.faults) == 1
    assert "does not begin with the names of its columns: write frequency_hz,direction,reach" in str(caught.value)


def test_a_table_of_a_spreadsheet_is_read(tmp_path: Path) -> None:
    text = 'frequency_hz, "direction", amplitude\n"14", "up", 1e-3\n'
    (tmp_path / "a.csv").write_text(text.replace(", ", ","), encoding="utf-8-sig", newline="\r\n")
    (point,) = read_curve(tmp_path / "a.csv", "amplitude").along(("up", "down"))
    assert (point.frequency, point.direction, point.value) == (14.0, "up", 1e-3)


def test_a_reference_is_named_by_its_shorter_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.csv").write_text(HEAD + "14,up,one,,,,,,1\n", encoding="utf-8")
    (tmp_path / "rig").mkdir()
    for folder, name in ((tmp_path, "a.csv"), (tmp_path / "rig", "../a.csv"), (Path("/"), str(tmp_path / "a.csv")[1:])):
        monkeypatch.chdir(folder)
        with pytest.raises(CaseError) as caught:
            read_curve(tmp_path / "a.csv", "amplitude").along(("up", "down"))
        assert str(caught.value).startswith(f"{name}:3: ")


@pytest.mark.parametrize("text", ["secret,direction,amplitude\n", HEAD + "secret,up,1,,,,,,1\n", "secret\n"])
def test_what_a_file_outside_the_case_s_folder_holds_is_not_shown(tmp_path: Path, text: str) -> None:
    (tmp_path / "rig").mkdir()
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    table = '[reference.exact]\nfile = "../a.csv"\nfidelity = "sdof"\nquantity = "amplitude"\ntolerance = 1\n'
    reference = parse(SDOF + table, tmp_path / "rig" / "case.toml").references["exact"]
    with pytest.raises(CaseError, match=r"a\.csv:[13]: ") as caught:
        reference.points()
    assert "secret" not in str(caught.value)
    with pytest.raises(CaseError, match="secret" if "," in text else "names of its columns"):
        replace(reference, quote=True).points()


def test_every_reference_in_the_repository_can_be_read() -> None:
    folder = Path(__file__).parents[3] / "cases" / "references"
    for path in sorted(folder.glob("*.csv")):
        assert read_curve(path, "amplitude").along(("up", "down"))


def test_restitutions_of_the_contact_and_of_mode_1() -> None:
    """PHYSICS §3 for the rig; a platform that moves changes neither, and another law has no such number."""
    file = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
    platform = {
        "mass": "5 kg",
        "frequency": "3.25 Hz",
        "damping_ratio": 0.05,
        "coupling": "two-way",
        "calibrated_at": "15.5 Hz",
    }
    contact = {"stop.restitution_of": "contact"}
    for keys in ({}, {f"platform.{key}": value for key, value in platform.items()}):
        found = load(file, set=keys | contact)
        for name, first in (("sdof", 0.72), ("two_modes", 0.684), ("beam", 0.602474)):
            both = restitutions(found.scene_of(name), found.fidelities[name])
            assert both == pytest.approx((0.72, first), abs=2e-4)
    first = load(file)
    assert restitutions(first.scene, first.fidelities["beam"]) == pytest.approx(
        (1.72 * 1.72 / 1.602474 - 1, 0.72), abs=2e-6
    )
    yields = load(file, set=contact | {"stop.law": "linear", "stop.stiffness": "1e6 N/m"})
    assert np.isnan(restitutions(yields.scene, yields.fidelities["beam"])).all()
