"""What ``import vibeam`` offers to someone at a Python prompt."""

from __future__ import annotations

import ast
import io
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from refusals import other_answers
from rich.console import Console

import vibeam
from tests.vibeam.test_imports import loaded

ROOT = Path(__file__).parents[3]
SMALL = {"sweep.frequency.points": 5, "sweep.settle": 20, "sweep.hold": 10}
SYSTEM = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72, outputs={"sensor": [1.0, 2.0]}
)


def swept(direction: Any = "both") -> Any:
    return vibeam.sweep(
        SYSTEM, omega=[90.0, 95.0, 100.0], amplitude=1e-4, direction=direction, settle=20, hold=10, output="sensor"
    )


@pytest.fixture(scope="module")
def result() -> vibeam.Result:
    return vibeam.run(vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set=SMALL | {"sweep.direction": "both"}))


def test_all_public_names_are_there() -> None:
    wanted = {"CaseError", "StoreError", "cost", "check", "modes", "plot", "load", "run", "Structure", "modal"}
    assert wanted <= set(vibeam.__all__)
    assert dir(vibeam) == vibeam.__all__ == sorted(vibeam.__all__)
    for name in vibeam.__all__:
        assert getattr(vibeam, name) is not None
    names: dict[str, Any] = {}
    exec("from vibeam import *", names)
    assert set(vibeam.__all__) <= set(names)


def listed(stub: Path) -> set[str]:
    """Names that a stub gives a type checker, those of the rooms that it takes whole among them."""
    nodes = [node for node in ast.parse(stub.read_text(encoding="utf-8")).body if isinstance(node, ast.ImportFrom)]
    whole = [node.module or "" for node in nodes if node.names[0].name == "*"]
    own = {alias.asname or "" for node in nodes for alias in node.names if alias.name != "*"}
    return own.union(*(listed(ROOT / room.replace(".", "/") / "__init__.pyi") for room in whole))


def test_the_type_checker_sees_the_same_names() -> None:
    assert listed(ROOT / "vibeam" / "__init__.pyi") == set(vibeam.__all__) - {"__version__"}
    for room in (vibeam.periodic, vibeam.studies, vibeam.observe):
        assert sorted(listed(Path(room.__file__ or "").with_suffix(".pyi"))) == dir(room)


def test_rooms_are_namespaces_of_the_same_functions() -> None:
    import vibeam.studies.cost.study  # a room of the same name as its function

    for room, some in ((vibeam.periodic, {"orbits", "follow", "lyapunov"}), (vibeam.studies, {"cost", "modes", "fit"})):
        assert some < set(dir(room)) <= set(dir(vibeam))
        assert all(getattr(room, name) is getattr(vibeam, name) for name in dir(room))
    assert "find_root" not in dir(vibeam.periodic)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("orbit", "vibeam has no name 'orbit'; did you mean 'orbits'?"), ("xyzzy", "vibeam has no name 'xyzzy'"),
        ("studies.costs", "vibeam.studies has no name 'costs'; did you mean 'cost'?"),
        ("observe.Harmonic", "vibeam.observe has no name 'Harmonic'; did you mean 'Harmonics'?"),
    ],
)  # fmt: skip
def test_a_wrong_name_is_answered_by_the_right_one(wrong: str, message: str) -> None:
    room, _, name = f"vibeam.{wrong}".rpartition(".")
    with pytest.raises(AttributeError) as refused:
        getattr(sys.modules[room], name)
    assert str(refused.value) == message


MORE: dict[str, dict[str, Any]] = {
    "identify_keys": {"keys": ["beam.thickness"]},
    "evaluate": {"fidelity": "sdof", "axes": {"sweep.frequency": [15.0]}},
    "run_map": {"name": "a", "out": "a.h5"},
}  # fmt: skip


@pytest.mark.parametrize(
    "name",
    ["run", "modes", "cost", "fit", "modes_needed", "stability", "uncertainty", "influence", "fidelity_map",
     "derive", "check", "compare_measured", "identify_keys", "evaluate", "run_map"],
)  # fmt: skip
def test_a_study_takes_the_file_of_a_case(name: str, tmp_path: Path) -> None:
    gone, study = tmp_path / "gone.toml", getattr(vibeam, name)
    for given in (gone, str(gone)):
        with pytest.raises(vibeam.CaseError, match=r"gone\.toml: no such file"):
            study(given, **MORE.get(name, {}))
    with pytest.raises(vibeam.CaseError, match="lenght"):
        study({"beam": {"lenght": 1.0}}, **MORE.get(name, {}))


def test_a_case_is_made_of_tables() -> None:
    tables: dict[str, Any] = {
        "sdof": {"natural_frequency": "1 rad/s", "damping_ratio": 0.015}, "stop": {"gap": 0, "restitution": 0.9},
        "drive": {"amplitude": 5e-4}, "fidelity": {"one": {"reduction": "static_mode"}},
        "sweep": {"frequency": ["2 rad/s"], "settle": 5, "hold": 3},
    }  # fmt: skip
    case = vibeam.Case.of(tables, {"sweep.hold": 7})
    assert (case.sweep.hold, list(case.fidelities)) == (7, ["one"])
    assert case == vibeam.load(tables, {"sweep.hold": 7})
    with pytest.raises(vibeam.CaseError, match="gap"):
        vibeam.Case.of(tables | {"stop": {"gap": "wide"}})


def test_progress_is_a_bar_a_function_or_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[int, int]] = []
    case = vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set=SMALL)
    shown = io.StringIO()
    monkeypatch.setattr("vibeam.cli.progress.stderr", lambda: Console(file=shown, force_terminal=True, width=100))
    plain = vibeam.run(case, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (30, 30)
    assert shown.getvalue() == ""
    assert vibeam.run(case, progress=False) == plain
    assert shown.getvalue() == ""
    assert vibeam.run(case, progress=True) == plain
    assert "30/30" in shown.getvalue()
    for wrong in ("yes", 1):
        with pytest.raises(ValueError, match=f"progress: {wrong!r} must be True"):
            vibeam.run(case, progress=wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["CaseError", "StoreError", "ImpactSystem", "State", "Structure", "modal"])
def test_plain_names_load_nothing_heavy(name: str) -> None:
    assert loaded(f"import vibeam\nvibeam.{name}") == []


def test_functions_stay_what_they_are_when_a_module_of_their_name_is_loaded() -> None:
    import vibeam.periodic.orbit
    import vibeam.runs.run

    for name in ("orbits", "run", "check", "cost", "modes", "plot"):
        assert callable(getattr(vibeam, name)), name


def test_a_case_is_checked_and_its_modes_listed() -> None:
    case = vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set=SMALL)
    rows = vibeam.check(case, partial=True)
    assert rows
    assert {row.fidelity for row in rows} <= set(case.fidelities)
    table = vibeam.modes(case, 3)
    assert [row.number for row in table.rows] == [1, 2, 3]
    for count in (0, 1.5, "3", None):
        with pytest.raises(ValueError, match="count"):
            vibeam.modes(case, count)  # type: ignore[arg-type]


def test_errors_of_files_are_caught_by_public_names(tmp_path: Path) -> None:
    with pytest.raises(vibeam.CaseError):
        vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set={"sweep.frequency.points": "many"})
    broken = tmp_path / "broken.h5"
    broken.write_text("no results")
    with pytest.raises(vibeam.StoreError):
        vibeam.run(vibeam.load(ROOT / "cases" / "dtu_neutral.toml", set=SMALL), out=broken)


def test_reprs_are_short_and_say_what_there_is(result: vibeam.Result) -> None:
    path = vibeam.simulate(SYSTEM, vibeam.Drive(95.0, 1e-4), 1.0)
    many = vibeam.ImpactSystem.from_modes(np.arange(1, 200.0), 0.0, 1.0, 1.0, coupling=np.eye(199), second_gap=1.0)
    texts = [repr(each) for each in (SYSTEM, many, path, swept("up"), swept(), result, result.case)]
    assert texts[0] == "ImpactSystem(2 modes, omega 47.7, 635 rad/s, gap=0, restitution=0.72, outputs sensor)"
    assert "199 modes, omega 1, 2, 3, 4, … rad/s" in texts[1]
    assert "second_gap=1" in texts[1]
    assert re.fullmatch(r"Trajectory\(0 … 1 s, 2 modes, \d+ impacts, \d+ rests?, COMPLETE\)", texts[2])
    assert texts[3] == "FrequencyResponse(3 points, 14.3239 … 15.9155 Hz, 2 modes)"
    assert texts[4].startswith("Branches(up=FrequencyResponse(3 points")
    for name in result:
        assert f"  {name}: Branches(up=" in texts[5]
    assert "dtu_neutral.toml" in texts[6]
    for text in texts:
        assert all(len(line) < 200 for line in text.splitlines())
        assert "array" not in text
        assert len(text.splitlines()) <= 1 + len(result)


def test_a_response_says_how_many_points_failed() -> None:
    blank = vibeam.FrequencyResponse.empty(np.array([10.0]), 1)
    assert repr(blank) == "FrequencyResponse(1 point, 10 … 10 Hz, 1 mode, 1 not complete)"


def test_an_unknown_fidelity_is_answered_by_the_known_ones(result: vibeam.Result) -> None:
    name = next(iter(result))
    with pytest.raises(KeyError, match=f"did you mean '{name}'"):
        result[name + "s"]
    with pytest.raises(KeyError, match="known here"):
        result["xyzzy"]
    assert result.get("xyzzy") is None
    assert "xyzzy" not in result


def test_responses_become_data_sets_with_units(result: vibeam.Result) -> None:
    both = swept()
    one, two, all_ = both.up.to_xarray(), both.to_xarray(), result.to_xarray()
    np.testing.assert_array_equal(one.amplitude, both.up.amplitude)
    assert dict(one.sizes) == {"frequency": 3, "mode": 2, "impact": 16}
    assert (one.amplitude.attrs["units"], one.frequency.attrs["units"]) == ("m", "Hz")
    assert one.impact_velocity.attrs["units"] == "m s-1"
    assert one.ended.attrs["flag_meanings"].split()[int(one.ended[0])] == "COMPLETE"
    for direction, response in both.items():
        found = two.sel(direction=direction, frequency=response.frequency)
        np.testing.assert_array_equal(found.amplitude, response.amplitude)
        np.testing.assert_array_equal(found.mode_energy, response.mode_energy)
    for name, branches in result.items():
        for direction, response in branches.items():
            found = all_.sel(fidelity=name, direction=direction, frequency=response.frequency)
            np.testing.assert_array_equal(found.amplitude, response.amplitude)
    assert all_.amplitude.attrs["units"] == "m"
    assert isinstance(all_, xarray.Dataset)


def test_responses_become_tables_with_units(result: vibeam.Result) -> None:
    both = swept()
    one, two, all_ = both.up.to_dataframe(), both.to_dataframe(), result.to_dataframe()
    assert one["amplitude"].tolist() == both.up.amplitude.tolist()
    assert one["mode_energy_2"].tolist() == both.up.mode_energy[:, 1].tolist()
    assert set(one["ended"]) == {"COMPLETE"}
    assert one.attrs["units"]["mode_energy_2"] == "J"
    assert two[two["direction"] == "down"]["reach"].tolist() == both.down.reach.tolist()
    assert len(all_) == result.total
    assert set(all_["fidelity"]) == set(result)
    assert all_.attrs["units"]["impact_velocity"] == "m s-1"
    assert "direction" not in all_.attrs["units"]


def test_a_model_without_dimensions_has_no_metres() -> None:
    case = vibeam.load(ROOT / "cases" / "sdof_nominal.toml", set={"sweep.settle": 2, "sweep.hold": 2})
    short = vibeam.run(case)
    assert short.to_dataframe().attrs["units"]["amplitude"] == "1"
    assert short.to_xarray().reach.attrs["units"] == "1"


@pytest.mark.parametrize(("package", "method"), [("xarray", "to_xarray"), ("pandas", "to_dataframe")])
def test_a_missing_package_is_named(package: str, method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=f"{method} needs the package {package}: pip install {package}"):
        getattr(swept("up"), method)()


def test_responses_and_results_are_drawn(result: vibeam.Result, tmp_path: Path) -> None:
    both = swept()
    figure = both.plot(tmp_path / "both.png", quantity="impact_velocity")
    drawn = [line.get_ydata() for line in figure.axes[0].lines]
    assert sum(map(len, drawn)) == 6
    assert sorted(np.concatenate(drawn)) == sorted([*both.up.impact_velocity, *both.down.impact_velocity])
    assert (tmp_path / "both.png").stat().st_size > 5000
    assert vibeam.plot(both.up).axes[0].get_ylabel().startswith("amplitude")
    assert result.plot(tmp_path / "result.svg").axes
    assert (tmp_path / "result.svg").exists()
    for wrong in ("amplitudes", "mode_energy", 3):
        with pytest.raises(ValueError, match="quantity"):
            both.up.plot(quantity=wrong)
    with pytest.raises(ValueError, match="quantity"):
        vibeam.plot(result, quantity="reach")
    with pytest.raises(ValueError, match="plot"):
        vibeam.plot([1.0, 2.0])  # type: ignore[arg-type]


def test_the_page_of_systems_shows_own_matrices_as_they_run() -> None:
    text = (ROOT / "vibeam" / "system" / "README.md").read_text(encoding="utf-8")
    start = text.index("own = vibeam.Structure(")
    names: dict[str, Any] = {"vibeam": vibeam}
    exec(text[start : text.index("```", start)], names)
    assert names["system"].size == 1


M, C, K = np.diag([1.0, 0.2]), np.array([[0.5, -0.2], [-0.2, 0.2]]), np.array([[5e3, -2e3], [-2e3, 2e3]])


def test_matrices_that_are_no_structure_are_refused() -> None:
    given: dict[str, Any] = {"M": M, "C": C, "K": K, "load": [-1.0, -0.2], "static": [0.0, 0.0], "contact": [0.0, 1.0]}
    wrong: dict[str, dict[str, Any]] = {
        "M: must be symmetric": {"M": [[1.0, 0.5], [0.0, 1.0]]}, "C: must be 2 × 2": {"C": np.eye(3)},
        "K: must be 2 × 2": {"K": "stiff"}, "load": {"load": [1.0]},
        "contact: must be 2 finite": {"contact": [[1.0, 0.0]]}, "static": {"static": [np.nan, 0.0]},
        r"outputs\['tip'\]": {"outputs": {"tip": [1.0]}},
        "M: must be positive definite": {"M": np.diag([1.0, 0.0])}, "K: must be positive semidefinite": {"K": -K},
        "coupling|zeta": {"C": -C}, "contact: no mode moves": {"contact": [0.0, 0.0]},
    }  # fmt: skip

    def made(change: dict[str, Any]) -> vibeam.ImpactSystem:
        return vibeam.ImpactSystem.from_structure(vibeam.Structure(**given | change), gap=0.0)

    assert other_answers(made, wrong) == []


def test_all_faults_of_a_structure_are_told_at_once() -> None:
    with pytest.raises(ValueError, match=r"M: .*; .*C: .*; .*load: "):
        vibeam.Structure(np.ones((2, 3)), np.eye(4), K, [1.0], [0.0, 0.0], [0.0, 1.0])
