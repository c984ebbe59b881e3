"""Stability maps: axes, units, what the fidelities share, averaging beside it, files and faults."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import RIG, one_mode
from typer.testing import CliRunner

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.report.maps.labels import shown_axis
from vibeam.report.maps.page import map_figure
from vibeam.report.maps.stability import kinds_of_points
from vibeam.studies.stability import Stability, stability

FIDELITIES = ("[fidelity.flown]", "[fidelity.averaged]", 'solver = "averaging"')
GRID = '{ from = "1.6 rad/s", to = "2.9 rad/s", points = 5 }'
NOMINAL = 'title = "nominal"\n' + one_mode(GRID, 20, 5, *FIDELITIES, gap=0.2e-3)
FEW = {"points": 21, "frequencies": 27}
Command = Callable[..., Any]


@pytest.fixture(scope="module")
def nominal() -> Case:
    return parse(NOMINAL)


def columns(found: Stability) -> np.ndarray[Any, Any]:
    """Frequencies of a map, rad/s."""
    return 2 * np.pi * np.array(found.plan.axes[-1].values)


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nominal.toml").write_text(NOMINAL, encoding="utf-8")

    def call(*words: object, expect: int = 0) -> Any:
        result = CliRunner().invoke(app, ["map", "--picture", "stability", *map(str, words)])
        assert result.exit_code == expect, result.output + repr(result.exception)
        return result

    return call


def test_fidelities_of_one_model_share_a_map(nominal: Case) -> None:
    found = stability(nominal, **FEW)
    assert [one.fidelities for one in found.maps] == [("flown", "averaged")]
    assert len(map_figure(found).axes) == 1
    kinds = kinds_of_points(found.maps[0])
    assert kinds.shape == (21, 27)
    assert {0, 2, 3} <= set(np.unique(kinds))


def test_the_own_line_meets_the_boundaries_that_the_library_finds(nominal: Case) -> None:
    (crossing,) = stability(nominal, **FEW).crossings
    system = nominal.system("flown")
    wanted = [b for b in vibeam.boundaries(system, 0.5e-3, (1.6, 2.9)) if b.kind is vibeam.Kind.DOUBLING and b.clear]
    assert crossing.boundary == "period doubling"
    assert crossing.frequency == wanted[0].omega / (2 * np.pi)
    assert crossing.multipliers == "-1"
    sides = [vibeam.orbits(system, vibeam.Drive(wanted[0].omega * share, 0.5e-3))[0].stable for share in (0.999, 1.001)]
    assert sides == [True, False]


def test_averaging_lies_beside_it(nominal: Case) -> None:
    """Δ_MAX = Ω²B/3 √(1 + σ²/β₁²), β₁ = (β + (1 − R)/π)/2, where the branch leans to; Ω²B/3 on the other side."""
    found = stability(nominal, **FEW)
    omega, averaged = columns(found), found.maps[0].averaged
    assert averaged is not None
    sigma, decay = omega / 2 - 1, (0.015 + 0.1 / np.pi) / 2
    force = omega**2 * 0.5e-3 / 3
    fold = force * np.hypot(1, sigma / decay)
    np.testing.assert_allclose(averaged[:, 1], np.where(sigma < 0, fold, force), rtol=1e-12)
    np.testing.assert_allclose(averaged[:, 0], np.where(sigma < 0, -force, -fold), rtol=1e-12)
    drive = stability(nominal, "drive", **FEW).maps[0].averaged
    assert drive is not None
    np.testing.assert_allclose(drive[:, 0], 0.5e-3 * 0.2e-3 / averaged[:, 1], rtol=1e-12)


def test_exact_and_averaged_folds_meet_as_the_losses_vanish() -> None:
    misses = []
    for small in (0.04, 0.02):
        settings = {"stop.restitution": 1 - small, "sdof.damping_ratio": 0.15 * small, "stop.gap": 0.8e-3}
        settings["sweep.frequency"] = {
            "from": f"{2 * (1 - small)} rad/s",
            "to": f"{2 * (1 - small / 4)} rad/s",
            "points": 3,
        }
        found = stability(parse(NOMINAL, set=settings), low=0.5e-3, high=3e-3, points=40, frequencies=81)
        one = found.maps[0]
        fold = next(curve for curve in one.boundaries if curve.kind is vibeam.Kind.FOLD)
        assert one.averaged is not None
        across = columns(found)
        at = [(gap, averaged) for hertz, gap in zip(fold.frequency, fold.value, strict=True)
              for averaged in one.averaged[np.isclose(across, 2 * np.pi * hertz, rtol=1e-12), 1]]  # fmt: skip
        assert len(at) >= 5
        misses.append(max(abs(gap / averaged - 1) for gap, averaged in at))
    assert misses[1] < 0.75 * misses[0] < 0.1


def test_axes_of_a_beam_are_in_volts_and_metres() -> None:
    case = vibeam.load(RIG)
    few = {"points": 3, "frequencies": 3, "fidelities": ["sdof"]}
    volts = stability(case, "drive", "0.3 V", "900 mV", **few)
    axis = volts.plan.axes[0]
    assert (axis.unit, volts.own) == ("V", 0.6)
    np.testing.assert_allclose(axis.values, [0.3, 0.6, 0.9], rtol=1e-12)
    gaps = stability(case, "gap", "-0.2 mm", "0.1 mm", **few)
    np.testing.assert_allclose(gaps.plan.axes[0].values, [-2e-4, -0.5e-4, 1e-4], rtol=1e-12)
    usual = stability(case, **few)
    assert min(usual.plan.axes[0].values) < usual.own < max(usual.plan.axes[0].values)


def nominal_by(**drive: Any) -> Case:
    return parse(NOMINAL, set={"drive.amplitude": None} | {f"drive.{key}": value for key, value in drive.items()})


@pytest.mark.parametrize(
    ("drive", "power"), [({"acceleration": 2e-3}, 2), ({"velocity": 1e-3}, 1), ({"amplitude": 0.5e-3}, 0)]
)
def test_boundaries_of_any_drive_are_those_of_its_amplitude_at_each_frequency(
    drive: dict[str, Any], power: int
) -> None:
    """B = V/Ω = A/Ω²: the boundary lies where one over the amplitude, the frequency held, has that amplitude."""
    case = nominal_by(**drive)
    (level,) = drive.values()
    (crossing,) = stability(case, points=3, frequencies=3).crossings
    omega = 2 * np.pi * crossing.frequency
    held = vibeam.boundaries(case.system("flown"), (1e-4, 1e-3), omega, kinds=(vibeam.Kind.DOUBLING,))
    assert min(abs(each.amplitude * omega**power / level - 1) for each in held) < 1e-9
    rows = stability(case, "drive", **FEW)
    curve = next(each for each in rows.maps[0].boundaries if each.kind is vibeam.Kind.DOUBLING and each.clear.all())
    omega = 2 * np.pi * curve.frequency[1]
    held = vibeam.boundaries(case.system("flown"), (1e-5, 2e-3), omega, kinds=(vibeam.Kind.DOUBLING,))
    assert min(abs(each.amplitude * omega**power / curve.value[1] - 1) for each in held) < 1e-9
    assert {point.value for point in rows.points} >= {*curve.value.tolist()}


def by_force() -> Case:
    stop = {"stop.gap": "0.1 mm", "stop.restitution": 0.59}
    return vibeam.load(RIG, set=stop | {"drive": {"force": "0.3 N", "at": "132 mm"}})


@pytest.mark.parametrize(("made", "size"), [(lambda: nominal_by(acceleration=2e-3), 2e-3), (by_force, 0.3)])
def test_flown_motions_change_where_the_exact_boundary_says(made: Callable[[], Case], size: float) -> None:
    """Period 1 before the doubling and 2 after it, flown with the amplitude size/Ω² that each frequency has."""
    case = made()
    name = next(iter(case.fidelities))
    found = stability(case, points=3, frequencies=3, fidelities=[name]).crossings
    (crossing,) = (each for each in found if each.boundary == "period doubling")
    omega = 2 * np.pi * crossing.frequency * np.array([0.9, 0.94, 0.97, 0.985, 0.997, 1.002])
    flown = vibeam.sweep(case.system(name), omega=omega, amplitude=size / omega**2, settle=600, hold=16)
    assert flown.period.tolist() == [1, 1, 1, 1, 1, 2]


@pytest.mark.parametrize(
    ("drive", "label", "own"),
    [
        ({"acceleration": "1 g"}, "base acceleration (m/s²)", "base acceleration 9.807 m/s²"),
        ({"velocity": "5 mm/s"}, "base velocity (mm/s)", "base velocity 5 mm/s"),
        ({"force": "0.3 N", "at": "132 mm"}, "drive force (N)", "drive force 0.3 N"),
    ],
)
def test_the_axis_has_the_unit_of_what_says_the_drive(drive: dict[str, Any], label: str, own: str) -> None:
    case = vibeam.load(RIG, set={"drive": drive})
    found = stability(case, "drive", points=3, frequencies=3, fidelities=["sdof"])
    assert map_figure(found).get_supylabel() == label
    assert shown_axis(case, found.plan.axes[0]).text(found.own) == own


def test_fidelities_whose_drive_is_said_otherwise_have_no_map_over_it() -> None:
    otherwise = {"reduction": "static_mode", "without": ["drive.amplitude"], "set": {"drive.velocity": 1e-3}}
    case = parse(NOMINAL, set={"fidelity.otherwise": otherwise})
    assert [one.fidelities for one in stability(case, **FEW).maps] == [("flown", "averaged"), ("otherwise",)]
    found = stability(case, "drive", **FEW)
    assert [one.fidelities for one in found.maps] == [("flown", "averaged")]
    assert found.notes[0] == "otherwise: no map, for its drive is not said by drive.amplitude"


def test_fidelities_of_one_model_under_other_drives_share_no_map() -> None:
    case = parse(NOMINAL, set={"fidelity.louder": {"reduction": "static_mode", "set": {"drive.amplitude": 1e-3}}})
    found = stability(case, "drive", **FEW)
    assert [one.fidelities for one in found.maps] == [("flown", "averaged"), ("louder",)]
    quiet, loud = (one.averaged for one in stability(case, **FEW).maps)
    np.testing.assert_allclose(loud, 2 * np.asarray(quiet), rtol=1e-12)


def test_a_list_over_frequency_is_scaled_as_it_is() -> None:
    grid = {"drive": {"amplitude": ["0.04 mm", "0.05 mm"], "frequency": ["14 Hz", "17 Hz"]}}
    found = stability(vibeam.load(RIG, set=grid), "drive", points=3, frequencies=3, fidelities=["sdof"])
    assert (found.plan.axes[0].key, found.plan.axes[0].values, found.own) == ("drive.share", (0.2, 1.1, 2.0), 1.0)
    doubled = {"drive": grid["drive"] | {"amplitude": ["0.08 mm", "0.1 mm"]}}
    whole, more = (vibeam.load(RIG, set=each) for each in (grid, doubled))
    rows = {"drive.share": [0.5, 2.0], "sweep.frequency": [14.0, 15.5, 17.0]}
    twice = vibeam.evaluate(whole, "sdof", rows, quantities=("amplitude",))["amplitude"][1]
    given = vibeam.evaluate(more, "sdof", {"sweep.frequency": rows["sweep.frequency"]}, quantities=("amplitude",))
    np.testing.assert_allclose(twice, given["amplitude"], rtol=1e-6)


def test_a_model_without_closed_forms_is_mapped_by_shooting(command: Command, tmp_path: Path) -> None:
    stop = 'law = "linear"\nstiffness = 100\nrestitution = 0.9'
    text = NOMINAL.replace("restitution = 0.9", stop).partition("[fidelity.averaged]")[0]
    (tmp_path / "law.toml").write_text(text, encoding="utf-8")
    shown = command("law.toml", "--points", "2,3").stdout
    assert 'flown: by shooting, for no closed form knows the contact law "linear"' in shown


def test_the_command_writes_what_it_says(command: Command, tmp_path: Path) -> None:
    words = ("nominal.toml", "--points", "21,27")
    shown = command(*words)
    names = [f"nominal_stability.{ending}" for ending in ("csv", "h5", "svg", "png")]
    assert {*shown.stdout.splitlines()[-1].removeprefix("wrote ").split(", ")} == {*names}
    assert "of the plane of frequency and gap Δ (flown and averaged)" in shown.stdout.splitlines()[0]
    assert "period doubling" in shown.stdout
    assert {path.name for path in tmp_path.iterdir()} == {"nominal.toml", *names}
    with (tmp_path / names[0]).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["boundary"] for row in rows} >= {"fold", "grazing", "period doubling"}
    svg = (tmp_path / names[2]).read_text(encoding="utf-8")
    for word in ("stable", "unstable", "fold", "grazing", "period doubling", "averaging", "gap Δ", "Ω/ω"):
        assert word in svg
    found = json.loads(command(*words, "--json", "--out", "other.h5").stdout)
    assert found["files"][:2] == ["other.h5", "other.csv"]
    (found,) = found["maps"]
    assert found["crossings"][0]["boundary"] == "period doubling"
    assert 0 < found["shares"][0]["stable"] < found["shares"][0]["admissible"] <= found["shares"][0]["exists"] < 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--over", "speed"), "is no key of the case"),
        (("--fidelity", "none"), "there are flown, averaged"),
        (("--from", "1 mm"), "--from: '1 mm' is a length"),
        (("--from", "2", "--to", "1"), "must ascend"),
        (("--accuracy", "1 %"), "--accuracy: goes with --picture verdict"),
        (("--out", "a.png"), "ends in .h5"),
        (("--set", "sweep.frequency=[0.3]"), "needs a range of frequencies"),
    ],
)
def test_a_wrong_question_is_a_message_and_no_file(
    command: Command, tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    result = command("nominal.toml", *words, expect=2)
    assert message in result.stderr
    assert result.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["nominal.toml"]


def test_longer_periods(nominal: Case) -> None:
    """One impact in two periods near Ω = 4: the averaged resonance k = 2, Δ_MAX = Ω²B/15 where σ is 0."""
    settings = {"sweep.frequency": {"from": "3.6 rad/s", "to": "4.4 rad/s", "points": 3}}
    found = stability(parse(NOMINAL, set=settings), periods=2, **FEW)
    (one,) = found.maps
    assert one.averaged is not None
    assert one.averaged[13, 1] == pytest.approx(16 * 0.5e-3 / 15, rel=1e-9)
    assert columns(found)[13] == pytest.approx(4.0)
    there = [vibeam.orbits(nominal.system("flown"), vibeam.Drive(4.0, 0.5e-3), periods=2)]
    assert [orbit.stable for orbits in there for orbit in orbits][:1] == [True]
    assert one.stable[:, :, 13].any()
