"""Figures and tables: what is apart is not joined, what occurs is explained, units are said."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from stand_in import case, curve, system

from vibeam.case.plans import Reference
from vibeam.casefile.documentation import reference_table
from vibeam.figures.response_curve import frc, grazing, write_frc
from vibeam.figures.units import METRIC, units_of
from vibeam.observe.branches import MotionClass, jumps, pieces
from vibeam.report import tables as table
from vibeam.report.checks import checks
from vibeam.report.derive import derivation
from vibeam.report.modes import modal
from vibeam.report.output import to_json, write_csv
from vibeam.report.run_report import details, fidelities
from vibeam.runs.comparison.errors import AmplitudeError, ComparedFidelity, ResponseComparison
from vibeam.runs.result import Result
from vibeam.runs.summary import compare
from vibeam.studies.derive import DerivedParameter
from vibeam.studies.modes import ModeRow, ModeTable
from vibeam.studies.regression.references import CheckRow
from vibeam.system.number_text import percent, signed
from vibeam.system.response import Branches
from vibeam_models.sdof import SdofScene

SVG = "{http://www.w3.org/2000/svg}"
GRID = np.linspace(14.0, 17.0, 61)
SMOOTH = 1e-3 / (1 + 8 * (GRID - 15.2) ** 2)
JUMPED = np.where(GRID < 15.8, SMOOTH, 0.2 * SMOOTH)


def result(*names: str, up: Any = JUMPED, period: Any = 1, modes: int = 1, **changes: Any) -> Result:
    branches = {
        name: Branches(curve(GRID, up, period, modes=modes), curve(GRID[::-1], SMOOTH[::-1], modes=modes))
        for name in names or ("one",)
    }
    systems = {name: system(modes) for name in branches}
    return Result(case(system=systems.__getitem__, **changes), branches)


def lines(svg: Path) -> dict[str, int]:
    """The named lines of a figure and how many points each has: corners of its path, or marks."""
    groups = ElementTree.parse(svg).iter(f"{SVG}g")
    named = {
        group.get("id", ""): group
        for group in groups
        if re.match(r"(\w+-(up|down|gap)|reference-)", group.get("id", ""))
    }
    return {name: _corners(group) or len(list(group.iter(f"{SVG}use"))) for name, group in named.items()}


def _corners(group: ElementTree.Element) -> int:
    path = group.find(f"{SVG}path")
    return 0 if path is None else len(re.findall("[ML] ", path.get("d", "")))


def drawn(tmp_path: Path, shown: Result) -> tuple[dict[str, int], str]:
    write_frc(shown, tmp_path / "a.svg", tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    return lines(tmp_path / "a.svg"), (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_a_jump_is_not_joined(tmp_path: Path) -> None:
    found, _ = drawn(tmp_path, result())
    up = {name: count for name, count in found.items() if name.startswith("one-up")}
    assert list(up) == ["one-up-0-period_one", "one-up-1-period_one"]
    assert sum(name.startswith("one-down") for name in found) == 1


def test_a_smooth_curve_is_one_piece_however_steep() -> None:
    peak = 1e-3 / (1 + 400 * (GRID - 15.2) ** 2)
    assert [len(piece) for piece in pieces(curve(GRID, peak))] == [61]
    for amplitude in (GRID * 0 + 1.0, GRID, 1 / GRID, np.sin(GRID)):
        assert not jumps(amplitude, np.ones(61, dtype=np.int64), np.ones(61)).any()


def test_another_branch_of_the_same_period_is_not_joined() -> None:
    """A sweep down of two modes: at 5.45 Hz two impacts in two periods, below one, and the amplitude leaps."""
    amplitude = 1e-3 * np.array([0.6348, 0.6212, 0.7375, 0.7104, 0.6876])
    impacts = np.array([1, 1, 0.5, 0.5, 0.5])
    swept = curve(np.linspace(5.5, 5.3, 5), amplitude, [1, 2, 2, 2, 2], impacts_per_period=impacts)
    assert [len(piece) for piece in pieces(swept)] == [1, 1, 3]
    grazing_only = curve(np.linspace(5.5, 5.3, 5), 1e-3 * np.array([5, 4, 3, 1.5, 1]), impacts_per_period=impacts)
    assert [len(piece) for piece in pieces(grazing_only)] == [5]


def test_a_jump_of_another_quantity_is_cut_beside_those_of_the_amplitude() -> None:
    speed = np.where(GRID < 14.6, 1.0, 2.0)
    assert [len(piece) for piece in pieces(curve(GRID, JUMPED), speed)] == [12, 24, 25]


def test_kinds_of_motion_are_apart_and_explained(tmp_path: Path) -> None:
    period = np.select([GRID < 14.5, GRID < 15.5, GRID < 16.0, GRID < 16.5], [-1, 1, 2, 3], 0)
    shown = result(up=SMOOTH, period=period)
    found, text = drawn(tmp_path, shown)
    kinds = [name.rsplit("-", 1)[1] for name in found if name.startswith("one-up")]
    assert kinds == ["no_contact", "period_one", "period_more", "period_more", "not_periodic"]
    for word in ("sweep up", "sweep down", "no contact", "period 2 … 16", "not periodic", "grazing", "one (1 mode)"):
        assert word in text
    assert "failed" not in text


def test_failed_points_are_marked() -> None:
    response = curve(GRID, SMOOTH, ended=np.where(GRID > 16.0, 3, 0))
    assert [piece.kind for piece in pieces(response)] == [MotionClass.PERIOD_ONE, MotionClass.FAILED]
    assert list(pieces(curve([], []))) == []


def test_reference_and_gap_are_drawn(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("frequency_hz,direction,amplitude,period\n15,up,1e-3,1\n16,up,,0\n", encoding="utf-8")
    reference = Reference("exact", file, "one", "amplitude", 0.01, "up")
    found, text = drawn(tmp_path, result(references={"exact": reference}))
    assert (found["reference-exact"], found["one-gap"]) == (1, 2)
    assert ">reference<" in text


def test_the_grazing_amplitude_is_the_gap_carried_to_the_output() -> None:
    assert grazing(system(3, gap=1e-4), "contact") == pytest.approx(1e-4)
    assert grazing(system(3, gap=1e-4), "sensor") == pytest.approx(0.5e-4)
    assert grazing(system(3, gap=-1e-4), "sensor") < 0


def test_axes_say_their_units(tmp_path: Path) -> None:
    _, metric = drawn(tmp_path, result())
    assert "drive frequency Ω/2π (Hz)" in metric
    assert "amplitude at the sensor, ½(max − min) (mm)" in metric
    scene = SdofScene(natural_frequency=2 * np.pi, damping_ratio=0.01, gap=0, restitution=0.9, amplitude=1)
    shown = result(scene=scene)
    _, plain = drawn(tmp_path, shown)
    assert "drive frequency Ω/ω" in plain
    assert "(mm)" not in plain
    assert "Hz" not in plain
    low, high = frc(shown).axes[0].get_xlim()
    assert 13.5 < low < 14.0 < 17.0 < high < 17.5


def test_many_fidelities_get_a_panel_each() -> None:
    assert len(frc(result("a", "b", "c")).axes) == 1
    figure = frc(result(*"abcde"))
    titles = [axes.get_title() for axes in figure.axes if axes.axison]
    assert titles == [f"{name} (1 mode)" for name in "abcde"]


def test_a_figure_is_the_same_each_time(tmp_path: Path) -> None:
    write_frc(result(), tmp_path / "a.svg")
    write_frc(result(), tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_tables_show_what_they_are_given(capsys: pytest.CaptureFixture[str]) -> None:
    summaries = compare(result("one", "two"))
    found = {"two": ComparedFidelity("two", "one", ResponseComparison(AmplitudeError(0.0321, 15.2, "up", 1.0, 1.0)))}
    table.print_table(fidelities(summaries, found))
    table.print_table(details(summaries))
    row = CheckRow("exact", "one", "amplitude", 3, 4, 0.0123, 15.2, 0.01, False, ("one is off",))
    table.print_table(checks([row]))
    table.print_table(table.keys(reference_table()))
    text = capsys.readouterr().out
    words = (
        "peak",
        "(mm)",
        "15.2 ↑",
        "14–17",
        "3.2 %",
        "finest",
        "missed",
        "3 of 4",
        "1.23 %",
        "one is off",
        "youngs_modulus",
    )
    for word in words:
        assert word in text


def test_units() -> None:
    assert (METRIC.lengths(1.5e-4), METRIC.lengths(float("nan")), METRIC.range(None)) == ("0.15 mm", "–", "–")
    assert units_of(case()) == METRIC


@dataclass(frozen=True)
class Shown:
    number: float
    path: Path

    @property
    def double(self) -> float:
        return 2 * self.number


def test_output_for_programs(tmp_path: Path) -> None:
    rows = (Shown(1.5, Path("a")), Shown(float("nan"), Path("b")))
    assert json.loads(to_json({"rows": rows, "array": np.arange(2)})) == {
        "rows": [{"number": 1.5, "path": "a", "double": 3.0}, {"number": None, "path": "b", "double": None}],
        "array": [0, 1],
    }
    write_csv(rows, tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text(encoding="utf-8") == "number,path,double\n1.5,a,3.0\n,b,\n"


def cells(shown: Any, header: str) -> list[str]:
    (column,) = [each for each in shown.columns if str(each.header).startswith(header)]
    return [str(each) for each in column.cells]


def test_round_off_is_shown_as_nothing() -> None:
    """A node's displacement, 9.16e-13 beside 1.19, and an identity's error of half an ulp; 3.6e-6 is a number."""
    rows = [(1.19, 1.131, 0.8413), (9.16e-13, -3.6e-6, 2.33e-12)]
    modes = [ModeRow(n, 14.0 * n, 0.01, *each, 0.03 * n, 0.7, 0.7) for n, each in enumerate(rows, 1)]
    shown = modal(ModeTable(tuple(modes), np.zeros(0), np.zeros((0, 0))))
    assert [cells(shown, name)[1] for name in ("contact", "sensor", "load")] == ["0", "-3.6e-06", "0"]
    same = DerivedParameter("mass", "M", "kg", 1.0 + 2.0**-52, 1.0, "none")
    other = DerivedParameter("mass", "M", "kg", 1.00347, 1.0, "a point")
    assert cells(derivation([same, other]), "error") == ["0", "+0.347 %"]


def test_what_is_off_altogether_is_capped_and_no_percentage_is_a_power_of_ten() -> None:
    assert [percent(each) for each in (8e4, 99.9, 0.123456, np.inf, np.nan)] == [
        "> 10000 %", "9990 %", "12.3 %", "∞", "–",
    ]  # fmt: skip
    shares = (8e4, 12.34, -0.5, -5.9e-6, 3e-9, 9e-13, 0)
    assert [signed(each) for each in shares] == ["> +10000 %", "+1230 %", "-50 %", "-0.0006 %", "0", "0", "0"]


def test_seven_impacts_tell_no_cost_of_an_impact_and_a_family_has_no_finest() -> None:
    shared = compare(result("one", "two", modes=2))
    few = [replace(each, impacts=count, cpu_seconds=0.0157) for each, count in zip(shared, (7, 20000), strict=True)]
    assert cells(details(few), "ns each") == ["–", "785"]
    assert cells(details(few), "off at peak") == ["", "0"]
    assert cells(details([replace(each, distance=None) for each in shared]), "off at peak") == ["", ""]


def test_the_finest_is_exact_or_compared_with_a_fuller_model() -> None:
    """Its errors stand in brackets, and the caption says what they are of."""
    rows = compare(result("one", "two", modes=2))
    comparison = ResponseComparison(AmplitudeError(0.0321, 15.2, "up", 1.0, 1.0))
    whole = ComparedFidelity("one", "", None, 2, whole=True)
    beyond = ComparedFidelity("one", "", comparison, 16)
    unknown = ComparedFidelity("one", "", None, why="the case gives only these modes")
    for own, cell in ((whole, "exact"), (beyond, "[3.2 %]"), (unknown, "[–]")):
        shown = fidelities(rows, {"one": own, "two": ComparedFidelity("two", "one", comparison)}, finest=["one"])
        assert cells(shown, "amplitudes") == [cell, "3.2 %"]
        assert ("[ ]: one against 16 modes" in str(shown.caption)) == (own is beyond)
