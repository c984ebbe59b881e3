"""Pictures of maps and ``vibeam map``: what is drawn is what was computed, boundaries are roots of exact functions."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from stand_in import SI
from typer.testing import CliRunner

import vibeam
from vibeam.case.grid_keys import AxisPlan
from vibeam.cli.main import app
from vibeam.maps.boundaries import boundaries_of
from vibeam.observe.periodicity import classes
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.report.maps.labels import shown_axis
from vibeam.report.maps.page import map_figure
from vibeam.report.maps.plane import panels

RIG = Path("cases/dtu_loose.toml").absolute()

FREQUENCY = {"key": "sweep.frequency", "from": 14.0, "to": 17.0, "points": 5}
VOLTAGE = {"key": "drive.voltage", "from": 0.2, "to": 0.8, "points": 4}
GAP = {"key": "stop.gap", "values": ["-0.1 mm", "0.1 mm"]}

TABLES: dict[str, dict[str, Any]] = {
    "period": {"axes": [GAP, VOLTAGE, FREQUENCY], "fidelities": ["sdof"], "direction": "both"},
    "values": {"axes": [VOLTAGE, FREQUENCY], "fidelities": ["sdof", "two_modes"], "quantity": "reach"},
    "bifurcation": {"axes": [FREQUENCY], "fidelities": ["sdof"], "direction": "both"},
    "basins": {"axes": [FREQUENCY], "fidelities": ["sdof"], "starts": 3, "spread": "1 mm"},
}


def case(picture: str, **more: Any) -> vibeam.Case:
    table = {"picture": picture, "settle": 20, "hold": 16, "boundaries": False} | TABLES[picture] | more
    return vibeam.load(RIG, set=SI | {"map": {"m": table}, "figure.format": ["svg"], "reference": None})


@pytest.mark.parametrize("picture", ["values", "bifurcation", "basins"])
def test_every_picture_is_drawn_of_its_map(picture: str, tmp_path: Path) -> None:
    found = vibeam.run_map(case(picture), "m", tmp_path / "m.h5")
    figure = map_figure(found)
    across = shown_axis(found.case, found.plan.axes[-1])
    labels = {axes.get_xlabel() for axes in figure.axes}
    assert across.label in labels
    assert all(np.all(np.isfinite(axes.dataLim.get_points())) for axes in figure.axes[:1])


@pytest.mark.parametrize("picture", ["bifurcation", "basins"])
def test_a_map_without_motion_is_drawn_without_a_warning(picture: str, tmp_path: Path) -> None:
    table = {"picture": picture, "settle": 20, "hold": 16, "boundaries": False} | TABLES[picture]
    still = {"map": {"m": table}, "drive.voltage": 0.0, "stop.gap": 1e-3, "reference": None}
    figure = map_figure(vibeam.run_map(vibeam.load(RIG, set=SI | still), "m", tmp_path / "m.h5"))
    assert np.all(np.isfinite(figure.axes[0].get_ylim()))


@pytest.mark.parametrize("picture", ["bifurcation", "basins"])
def test_a_map_of_one_point_is_drawn_without_a_warning(picture: str, tmp_path: Path) -> None:
    axes = [{"key": "sweep.frequency", "values": [15.0]}]
    figure = map_figure(vibeam.run_map(case(picture, axes=axes), "m", tmp_path / "m.h5"))
    low, high = figure.axes[0].get_xlim()
    assert low < high


def test_the_cells_of_a_period_map_are_the_classes_of_its_points(tmp_path: Path) -> None:
    found = vibeam.run_map(case("period"), "m", tmp_path / "m.h5")
    figure = map_figure(found)
    shown = list(panels(found))
    assert [(each.row, each.column) for each in shown] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert shown[1].title == "(b) gap at the sensor 0.1 mm"
    for each in shown:
        axes = figure.axes[2 * each.row + each.column]
        (mesh,) = [part for part in axes.collections if isinstance(part, QuadMesh)]
        way, gap = each.way, each.column
        wanted = classes(*(found["sdof"].values[name][way, gap] for name in ("period", "rest", "ended")))
        np.testing.assert_array_equal(mesh.get_array(), wanted)


@pytest.mark.parametrize("picture", TABLES)
def test_a_map_of_each_picture_is_drawn(picture: str, tmp_path: Path) -> None:
    fidelities = ["sdof", "two_modes"] if picture != "period" else ["sdof"]
    rig = case(picture, fidelities=fidelities, settle=2, hold=4)
    figure = map_figure(vibeam.run_map(rig, "m", tmp_path / "m.h5"))
    assert any(axes.has_data() for axes in figure.axes)


def roots(system: vibeam.ImpactSystem, amplitude: float, omega: float, kind: Kind) -> np.ndarray[Any, Any]:
    """Roots near ``omega``, which is not in the middle between two places that are looked at, nor one of them."""
    found = vibeam.boundaries(system, amplitude, (omega * 0.99903, omega * 1.00109), 1, points=21, kinds=(kind,))
    return np.array([each.omega for each in found])


@pytest.mark.parametrize("drive", [{}, {"drive": {"velocity": "20 mm/s"}}])
def test_boundaries_over_a_level_of_the_drive_are_roots_at_that_level(drive: dict[str, Any]) -> None:
    """Also where the base's amplitude falls with the frequency."""
    rig = vibeam.load(RIG, set=drive)
    key, levels = ("drive.velocity", (0.005, 0.04)) if drive else ("drive.voltage", (0.2, 0.8))
    axes = [AxisPlan(key, tuple(np.linspace(*levels, 9)), ""), AxisPlan("sweep.frequency", (14.0, 15.5, 17.0), "Hz")]
    found, why = boundaries_of(rig, "two_modes", axes, ())
    assert why == ""
    folds = [each for each in found if each.kind is Kind.FOLD]
    assert folds
    system = rig.system("two_modes")
    for curve in folds:
        for at in (len(curve.frequency) // 3, 2 * len(curve.frequency) // 3):
            omega = 2 * np.pi * curve.frequency[at]
            amplitude = vibeam.load(RIG, set=SI | {**drive, key: float(curve.value[at])}).amplitude_of(
                "two_modes", np.array([omega])
            )
            assert np.min(np.abs(roots(system, float(np.ravel(amplitude)[0]), omega, Kind.FOLD) - omega)) < 1e-6 * omega


@pytest.mark.parametrize("drive", [{}, {"drive": {"velocity": "8 mm/s"}}])
def test_boundaries_over_the_gap_are_roots_at_that_gap(drive: dict[str, Any]) -> None:
    """A gap that was measured at the sensor is larger at the contact; also where the drive falls with the frequency."""
    rig = vibeam.load(RIG, set=drive)
    axes = [AxisPlan("stop.gap", (0.0, 5e-5, 1e-4), "m"), AxisPlan("sweep.frequency", (15.0, 16.0, 17.0), "Hz")]
    found, why = boundaries_of(rig, "sdof", axes, ())
    assert why == ""
    curve = next(each for each in found if each.kind is Kind.DOUBLING and each.clear.any())
    at = int(np.flatnonzero(curve.clear)[np.count_nonzero(curve.clear) // 2])
    gap = vibeam.load(RIG, set=SI | {"stop.gap": float(curve.value[at])}).system("sdof").gap
    omega = 2 * np.pi * curve.frequency[at]
    amplitude = float(np.ravel(rig.amplitude_of("sdof", np.array([omega])))[0])
    known = roots(replace(rig.system("sdof"), gap=gap), amplitude, omega, Kind.DOUBLING)
    assert np.min(np.abs(known - omega)) < 1e-6 * omega


def test_where_no_boundaries_are_known_a_note_says_why() -> None:
    frequency = AxisPlan("sweep.frequency", (15.0, 17.0), "Hz")
    start = AxisPlan("start.velocity", (0.5, 0.6), "m/s")
    assert "a key of the case" in boundaries_of(vibeam.load(RIG), "sdof", [start, frequency], ())[1]
    two = vibeam.load(RIG, set={"stop.second_gap": "1 mm"})
    assert "a second stop" in boundaries_of(two, "sdof", [AxisPlan("stop.gap", (0.0, 1e-4), "m"), frequency], ())[1]


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "rig.toml"
    path.write_text(case("values").text, encoding="utf-8")
    return path


def call(*words: object, expect: int = 0) -> Any:
    result = CliRunner().invoke(app, ["map", *map(str, words)])
    assert result.exit_code == expect, result.output
    return result


def test_the_command_writes_file_and_picture_and_goes_on(file: Path, tmp_path: Path) -> None:
    first = call(file, "--json")
    assert {path.name for path in tmp_path.iterdir()} == {"rig.toml", "rig_m.h5", "rig_m.svg"}
    (told,) = json.loads(first.stdout)["maps"]
    rows = told["rows"]
    assert [row["fidelity"] for row in rows] == ["sdof", "sdof", "two_modes", "two_modes"]
    assert rows[0]["no_impact"] + rows[0]["period_1"] + rows[0]["not_periodic"] <= 1
    again = call(file)
    assert "all 80 points are there already" in again.stderr
    assert again.stdout.splitlines()[-1] == "wrote rig_m.h5, rig_m.svg"
    assert again.stdout.startswith("m: of 80 motions over drive voltage and drive frequency ")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("n",), "n: no such map"),
        (("--set", "map.m.hold=0"), "--set map.m.hold: 0 is outside"),
        (("--set", "map.m.axes=[]"), "has no axis"),
        (("--out", "a.csv"), "--out names the file of a map that ends in .h5"),
        (("--set", "fidelity.sdof.solver='\"orbit\"'"), "solver"),
    ],
)
def test_a_mistake_leaves_a_message_and_no_file(file: Path, tmp_path: Path, words: tuple[str, ...], said: str) -> None:
    result = call(file, *words, expect=2)
    assert said in result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"rig.toml"}


def test_a_case_without_maps_is_told_how_to_have_one(tmp_path: Path) -> None:
    assert (
        "--picture stability (verdict, period, …), or add a table [map.NAME]"
        in call(RIG, "--out", tmp_path, expect=2).stderr
    )
