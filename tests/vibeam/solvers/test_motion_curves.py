"""All motions of a kind in the frequency-response curve: both branches, unstable ones dashed, and none where flown."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from sealed import edited
from stand_in import one_mode, same
from typer.testing import CliRunner

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.extensions.paper.averaging import AveragingSolver
from vibeam.figures.response_curve import write_frc
from vibeam.flight.solver import FlightSolver
from vibeam.observe.branches import motion_pieces
from vibeam.periodic.between_impacts import carried
from vibeam.periodic.orbit_search import orbits
from vibeam.solvers import SOLVERS
from vibeam.solvers.orbit import OrbitSolver
from vibeam.system.curves import MotionCurves
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

GRID = '{ from = "1.6 rad/s", to = "2.8 rad/s", points = 13 }'
LOOSE = one_mode(GRID, 300, 8, "[fidelity.flown]", gap=0.8e-3, direction="up")
METHODS = '[fidelity.orbit]\nsolver = "orbit"\n[fidelity.averaged]\nsolver = "averaging"\n'
MODEL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, gap=0.8e-3, restitution=0.9)
NO_METHODS = {"flight", "mapping", "direct", "zhuravlev", "ivanov", "moreau"}


@pytest.fixture(scope="module")
def case() -> Case:
    return parse(LOOSE + METHODS)


def equal(one: MotionCurves, other: MotionCurves) -> bool:
    names = [field.name for field in fields(MotionCurves)]
    return all(np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in names)


def test_a_run_has_both_branches_and_the_file_keeps_them(case: Case, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    first, again = vibeam.run(case, path), vibeam.run(case, path)
    assert set(first.curves) == {"orbit", "averaged"}
    assert first["flown"].curves is None
    for name, curves in first.curves.items():
        assert equal(curves, again.curves[name])
        assert {True, False} <= set(curves.stable[curves.admissible])
        np.testing.assert_array_equal(np.isfinite(curves.amplitude), curves.admissible)
    with h5py.File(path, "r") as file:
        assert set(file["flown"]) == {"up"}
        group = file["orbit/curves"]
        assert [dim[0].name for dim in group["reach"].dims] == ["/orbit/curves/frequency", "/orbit/curves/branch"]
        assert group["reach"].attrs["units"] == "1"
        assert group.attrs["periods"] == 1


def test_curves_that_are_not_there_are_written_anew(case: Case, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    first = vibeam.run(case, path)
    with edited(path) as file:
        del file["orbit/curves"]
    assert equal(vibeam.run(case, path).curves["orbit"], first.curves["orbit"])


def test_what_is_flown_is_the_same_to_the_bit_and_knows_of_no_curves(case: Case) -> None:
    alone, beside = vibeam.run(parse(LOOSE)), vibeam.run(case)
    first, second = alone["flown"].up, beside["flown"].up
    assert first is not None
    assert second is not None
    assert same(first, second, but=("cpu_seconds",))
    assert alone.curves == {}
    assert {name for name, each in SOLVERS.items() if not each.curves} == NO_METHODS


def test_the_stable_branch_is_what_is_flown(case: Case) -> None:
    result = vibeam.run(case)
    flown, curves = result["flown"].up, result.curves["orbit"]
    assert flown is not None
    both = (flown.period == 1) & (flown.impacts_per_period == 1)
    assert both.sum() >= 4
    for name in ("amplitude", "reach"):
        found = getattr(curves, name)[both, 0]
        np.testing.assert_allclose(found, getattr(flown, name)[both], rtol=1e-10, atol=0)
        assert not np.allclose(found * (1 + 1e-9), getattr(flown, name)[both], rtol=1e-10, atol=0)
    assert curves.stable[both, 0].all()


def test_the_unstable_branch_parts_what_strikes_on_from_what_comes_to_hang_free() -> None:
    """Flown from a little harder than the unstable motion it grows to the stable one, a little softer it stops."""
    omega = 1.9
    curves = OrbitSolver(MODEL, omega).curves([omega], 0.5e-3, "contact")
    assert list(curves.stable[0]) == [True, False]
    unstable = orbits(MODEL, vibeam.Drive(omega, 0.5e-3))[1]
    assert curves.velocity[0, 1] == unstable.velocity
    half = unstable.time + unstable.span / 2
    x, y = carried(MODEL, unstable.drive, unstable.state, unstable.time, np.array([half]))
    ends = []
    for share in (1 + 1e-4, 1 - 1e-4):
        end = half + 400 * unstable.span
        path = vibeam.simulate(MODEL, unstable.drive, end, State(x[0] * share, y[0] * share), t_start=half)
        late = path.impact_velocities[path.impact_times > end - 5 * unstable.span]
        ends.append(float(late.mean()) if len(late) else 0.0)
    assert sorted(ends) == [0.0, pytest.approx(curves.velocity[0, 0], rel=1e-8)]


def test_what_passes_through_the_stop_is_not_drawn() -> None:
    heavy = ImpactSystem.from_modes([1.0, 6.3], 0.01, [1.0, 0.6], [1.0, 0.2], gap=0.0, restitution=0.6)
    curves = OrbitSolver(heavy, 0.3).curves(np.linspace(0.3, 3.0, 28), 0.1, "contact")
    passing = np.isfinite(curves.velocity) & ~curves.admissible
    assert passing.any()
    assert curves.admissible.any()
    assert np.isnan(curves.amplitude[passing]).all()
    shown = sum(len(piece.frequency) for piece in motion_pieces(curves))
    assert curves.admissible.sum() <= shown < np.isfinite(curves.velocity).sum()
    assert all(np.isfinite(piece.amplitude).all() for piece in motion_pieces(curves))


def test_an_averaged_curve_is_in_the_units_of_the_system() -> None:
    own: dict[str, Any] = {"gap": 2e-4, "restitution": 0.9, "outputs": {"sensor": [0.4]}}
    made = ImpactSystem.from_modes(50.0, 0.015, -1.7, 0.6, **own)
    solver = AveragingSolver(made, strikes_only=True)
    curves = solver.curves([95.0, 101.0], 2e-4, "sensor")
    swept, _ = solver.steady([95.0, 101.0], 2e-4, None, 0, 8, "sensor")
    np.testing.assert_allclose(curves.amplitude[:, 0], swept.amplitude, rtol=1e-14)
    np.testing.assert_allclose(curves.velocity[:, 0], swept.impact_velocity, rtol=1e-14)
    assert list(curves.stable[0]) == [True, False]


def test_a_change_of_stability_is_joined_and_an_end_is_not() -> None:
    grid = np.arange(6.0)
    curves = MotionCurves.empty(grid, 1)
    curves.amplitude[:, 0] = [1, 2, 3, np.nan, 5, 6]
    curves.admissible[:, 0] = np.isfinite(curves.amplitude[:, 0])
    curves.stable[:2, 0] = True
    found = [(piece.stable, list(piece.frequency)) for piece in motion_pieces(curves)]
    assert found == [(True, [0, 1]), (False, [1, 2]), (False, [4, 5])]


def test_unstable_parts_are_dashed_and_explained(case: Case, tmp_path: Path) -> None:
    write_frc(vibeam.run(case), tmp_path / "a.svg")
    groups = list(ElementTree.parse(tmp_path / "a.svg").iter("{http://www.w3.org/2000/svg}g"))
    curves = {group.get("id", ""): ElementTree.tostring(group, "unicode") for group in groups}
    found = {name: text for name, text in curves.items() if "-curve-" in name}
    assert {name.split("-")[0] for name in found} == {"orbit", "averaged"}
    assert {name.split("-")[-1] for name in found} == {"stable", "unstable"}
    for name, text in found.items():
        assert ("stroke-dasharray" in text) == name.endswith("unstable"), name
    assert ">unstable<" in (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_json_has_them(tmp_path: Path) -> None:
    path = tmp_path / "loose.toml"
    path.write_text(LOOSE + METHODS, encoding="utf-8")
    printed = CliRunner().invoke(app, ["run", str(path), "--json", "--out", str(tmp_path)])
    curves = json.loads(printed.stdout)["curves"]
    assert set(curves) == {"orbit", "averaged"}
    assert len(curves["orbit"]["amplitude"]) == 13
    assert {True, False} == {value for row in curves["orbit"]["stable"] for value in row}


THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.1, restitution=0.7,
    outputs={"sensor": [0.6, -0.4, 0.9]},
)  # fmt: skip
DRIVES = np.array([1.75, 1.9, 2.0, 2.1])
SAME = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period", "rest")


def both(system: ImpactSystem, grid: np.ndarray, amplitude: float, output: str) -> list[FrequencyResponse]:
    flight, orbit = FlightSolver(system, grid[0]), OrbitSolver(system, grid[0])
    return [
        solver.steady(grid, amplitude, None, settle, 8, output)[0] for solver, settle in ((flight, 900), (orbit, 0))
    ]


@pytest.mark.parametrize("output", ["contact", "sensor"])
def test_a_response_is_the_one_of_the_flight_solver(output: str) -> None:
    flight, orbit = both(THREE, DRIVES, 0.2, output)
    assert np.all(flight.period == 1)
    for name in SAME:
        np.testing.assert_allclose(getattr(orbit, name), getattr(flight, name), rtol=1e-8, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(orbit.impact_velocities[:, 8:], flight.impact_velocities[:, 8:], rtol=1e-8)
    np.testing.assert_allclose(orbit.mode_energy, flight.mode_energy, rtol=1e-4, atol=1e-6)
    assert np.all(orbit.ended == 0)
    assert np.all(orbit.cpu_seconds > 0)
    other, _ = both(replace(THREE, restitution=0.7001), DRIVES, 0.2, output)
    assert not np.allclose(orbit.reach, other.reach, rtol=1e-6)


def test_where_nothing_is_touched_the_linear_response_is_given() -> None:
    flight, orbit = both(replace(THREE, gap=1.0), np.array([2.0, 3.0]), 0.05, "sensor")
    assert np.all(orbit.period == -1)
    for name in ("amplitude", "reach", "maximum", "minimum"):
        np.testing.assert_allclose(getattr(orbit, name), getattr(flight, name), rtol=1e-7, err_msg=name)


def test_a_point_without_such_a_motion_has_its_reason() -> None:
    solver = OrbitSolver(THREE, 0.7)
    response, last = solver.steady([0.7, 2.0, 0.7], 0.2, None, 0, 4, "contact")
    assert list(response.ended) == [Ended.NO_ORBIT.code, 0, Ended.NO_ORBIT.code]
    assert np.isnan(response.amplitude[[0, 2]]).all()
    assert np.isfinite(response.amplitude[1])
    assert isinstance(last, State)


def test_its_state_is_on_the_motion() -> None:
    _, last = OrbitSolver(THREE, 2.0).steady([2.0], 0.2, None, 0, 4, "contact")
    first, again = FlightSolver(THREE, 2.0).steady([2.0], 0.2, last, 0, 4, "contact")
    assert first.period[0] == 1
    np.testing.assert_allclose(again.displacement, last.displacement, atol=1e-11)


def test_longer_periods_and_wrong_ones() -> None:
    one = ImpactSystem.from_modes([1.0], 0.02, 1.0, 1.0, restitution=0.8)
    response, _ = OrbitSolver(one, 4.0, periods=2).steady([4.0], 1e-3, None, 0, 8, "contact")
    assert response.period[0] == 2
    assert response.impacts_per_period[0] == 0.5
    assert np.isfinite(response.impact_velocities).sum() == 4
    settled, _ = FlightSolver(one, 4.0).steady([4.0], 1e-3, _, 600, 8, "contact")
    assert settled.period[0] == 2
    np.testing.assert_allclose(response.reach, settled.reach, rtol=1e-9)
    with pytest.raises(ValueError, match="periods"):
        OrbitSolver(one, 4.0, periods=0)
    with pytest.raises(KeyError, match="nowhere"):
        OrbitSolver(one, 4.0).steady([4.0], 1e-3, None, 0, 8, "nowhere")
