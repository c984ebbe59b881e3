"""The commands: what they print where, how they exit, and that a mistake leaves a message and no file."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import typer
from stand_in import RIG, SDOF, Solver
from typer.testing import CliRunner

import vibeam
from vibeam import __version__
from vibeam.casefile.read import parse
from vibeam.cli.errors import mistakes
from vibeam.cli.main import app
from vibeam.runs import fidelity_sweep
from vibeam.runs.run import run

TESTS = str(Path(__file__).parents[2] / "support")
HANGS = 600  # seconds: only what never ends takes so long
Command = Callable[..., Any]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, undrawn: None) -> Command:
    """``vibeam …`` in an empty folder, with a solver and figures that take no time."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(fidelity_sweep, "march_blocks", Solver())

    def call(*words: object, expect: int = 0) -> Any:
        result = CliRunner().invoke(app, [str(word) for word in words])
        unexpected = result.exception is not None and not isinstance(result.exception, SystemExit)
        assert not unexpected, repr(result.exception)
        assert result.exit_code == expect, result.output
        assert "Traceback" not in result.output
        return result

    return call


@pytest.fixture
def sdof(tmp_path: Path) -> Path:
    path = tmp_path / "sdof.toml"
    path.write_text(SDOF, encoding="utf-8")
    return path


def test_run_writes_results_and_figures_and_goes_on(command: Command, sdof: Path, tmp_path: Path) -> None:
    first = command("run", sdof)
    assert {path.name for path in tmp_path.iterdir()} == {"sdof.toml", "sdof.h5", "sdof.png", "sdof.svg"}
    assert first.stdout.endswith("\nwrote sdof.h5, sdof.png, sdof.svg\n")
    assert first.stdout.startswith(
        "sdof (1 mode) is all that the case gives, computed exactly; its peak is 0.9512 at 2. "
    )
    again = command("run", sdof)
    assert again.stderr == "all 10 points are there already\n"
    assert again.stdout == first.stdout


OVERVIEW = r"mode 1 at 0\.1592 Hz[^:]*\n"  # the rig and its sweep, before that


def test_run_says_that_it_continues(
    command: Command, sdof: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fidelity_sweep, "march_blocks", Solver(fail_at=4, failure=KeyboardInterrupt()))
    stopped = command("run", sdof, expect=130)
    assert stopped.stderr.endswith(
        "\nstopped: 4 of 10 points are kept in sdof.h5: the same command goes on from there\n"
    )
    assert stopped.stdout == ""
    monkeypatch.setattr(fidelity_sweep, "march_blocks", Solver())
    assert re.fullmatch(rf"{OVERVIEW}continuing: 4 of 10 points are there\n", command("run", sdof).stderr)


def test_run_takes_overrides_and_a_folder(command: Command, sdof: Path, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    words = ("--set", "sweep.frequency.points=3", "--set", 'sweep.direction="up"', "--out", "there", "--json")
    found = json.loads(command("run", sdof, *words).stdout)
    assert found["files"] == ["there/sdof.h5", "there/sdof.png", "there/sdof.svg"]
    assert (found["total"], found["found"]) == (3, 0)
    assert found["fidelities"][0]["fidelity"] == "sdof"
    other = ("--set", "sdof.damping_ratio=0.5", "--out", "there")
    told = command("run", sdof, *other).stderr.splitlines()[0]
    assert re.fullmatch(
        r"there/sdof\.h5: holds the case as it was \(.* there, .* here\); .* aside as sdof\.1\.h5", told
    )
    assert re.fullmatch(OVERVIEW, command("run", sdof, *other, "--fresh").stderr)


def test_run_says_what_it_keeps_of_a_changed_case(command: Command, sdof: Path) -> None:
    grid = ("--set", "sweep.frequency.from=1 Hz", "--set", "sweep.frequency.to=2 Hz")
    command("run", sdof, *grid)
    more = ("--set", "sweep.frequency.to=2.5 Hz", "--set", "sweep.frequency.points=7")
    told = command("run", sdof, *grid[:2], *more).stderr.splitlines()
    assert told[0] == (
        "sdof.h5: extended: sdof/up (5 of 7 points); swept anew: sdof/down; its results are kept aside as sdof.1.h5"
    )
    assert told[-1] == "continuing: 5 of 14 points are there"
    checked = command("check", with_reference(sdof, curve_of(sdof)), "--out", "sdof.h5", "--fresh")
    assert re.fullmatch(OVERVIEW, checked.stderr)


def test_after_an_edit_the_same_command_works_and_nothing_is_lost(command: Command, sdof: Path) -> None:
    command("run", sdof)
    before = sdof.with_name("sdof.h5").read_bytes()
    sdof.write_text(SDOF.replace("restitution = 0.9", "restitution = 0.8"), encoding="utf-8")
    assert command("run", sdof).stderr.splitlines()[0] == (
        "sdof.h5: holds the case as it was (stop.restitution = 0.9 there, 0.8 here); "
        "its results are kept aside as sdof.1.h5"
    )
    assert sdof.with_name("sdof.1.h5").read_bytes() == before
    assert command("run", sdof).stderr == "all 10 points are there already\n"
    assert json.loads(command("report", "sdof.1.h5", "--csv", "--json").stdout)["files"] == ["sdof.1_curves.csv"]


def test_several_cases_are_run_each_into_its_own_file(command: Command, sdof: Path) -> None:
    other, wrong, built = (sdof.with_name(f"{name}.toml") for name in ("other", "wrong", "built"))
    other.write_text(SDOF, encoding="utf-8")
    wrong.write_text("titl = 1\n", encoding="utf-8")
    built.write_text(SDOF.replace("[fidelity.sdof]", '[fidelity.sdof]\nsolver = "orbit"\ndrag = 1'), encoding="utf-8")
    done = command("run", sdof, wrong, other, built, "--out", "results", expect=2)
    lines = done.stdout.splitlines()
    assert [line.partition(": ")[0] for line in lines] == [str(each) for each in (sdof, wrong, other, built)]
    assert lines[1].startswith(f"{wrong}: no answer: ")
    assert " is all that the case gives" in lines[0]
    places = [done.stderr.index(said) for said in ("titl", "drag", f"{sdof}:\n", f"{other}:\n")]
    assert places == sorted(places), "all faults are told before anything is run"
    assert {each.name for each in (sdof.parent / "results").glob("*.h5")} == {"sdof.h5", "other.h5"}
    unknown = command("run", sdof, other, "--fidelity", "no", expect=2).stderr.splitlines()
    assert unknown == [f"{each}: --fidelity no: no such fidelity; known here: sdof" for each in (sdof, other)]
    data = json.loads(command("run", sdof, wrong, "--out", "results", "--json", expect=2).stdout)
    assert data["schema"] == "vibeam.run/1"
    assert [("error" in each, each.get("found")) for each in data["runs"]] == [(False, 10), (True, None)]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--out", "a.h5"), "--out a.h5: names a folder where there are several cases"),
        ((), "sdof.toml: all write sdof.h5"),
    ],
)
def test_several_cases_need_a_folder_and_names(command: Command, sdof: Path, words: tuple[str, ...], said: str) -> None:
    assert said in command("run", sdof, sdof, *words, expect=2).stderr
    assert list(sdof.parent.iterdir()) == [sdof]


def test_one_fidelity_is_run_and_the_others_are_added_to_its_file(command: Command, sdof: Path) -> None:
    table = '[reference.it]\nfile = "it.csv"\nfidelity = "two"\nquantity = "amplitude"\ntolerance = 1\n'
    sdof.write_text(f'{SDOF}[fidelity.two]\nsolver = "mapping"\n{table}', encoding="utf-8")
    sdof.with_name("it.csv").write_text("no curve\n", encoding="utf-8")
    command("run", sdof, "--fidelity", "sdof")
    command("check", sdof, "--fidelity", "sdof")
    assert list(vibeam.read(sdof.with_name("sdof.h5"))) == ["sdof"]
    sdof.with_name("it.csv").write_text("frequency_hz,direction,amplitude\n0.2387,up,1\n", encoding="utf-8")
    added = command("run", sdof).stderr
    assert "sdof.h5: kept: sdof/up, sdof/down; added: two/up, two/down" in added
    before = sdof.with_name("sdof.h5").read_bytes()
    assert command("run", sdof, "--fidelity", "two").stderr == "all 10 points are there already\n"
    assert sdof.with_name("sdof.h5").read_bytes() == before, "records of all fidelities stay"
    assert command("run", sdof).stderr == "all 20 points are there already\n"
    assert (
        "--fidelity tow: no such fidelity; did you mean 'two'?"
        in command("run", sdof, "--fidelity", "tow", expect=2).stderr
    )


def test_all_curves_are_written_as_a_table_with_units(command: Command, sdof: Path) -> None:
    command("run", sdof, "--set", "fidelity.exact.solver=orbit")
    assert command("report", "sdof.h5", "--csv").stdout.splitlines() == ["sdof_curves.csv", "sdof_motions.csv"]
    rows = list(csv.DictReader(sdof.with_name("sdof_curves.csv").read_text("utf-8").splitlines()))
    assert [(row["fidelity"], row["direction"]) for row in rows[::5]] == [
        (name, way) for name in ("sdof", "exact") for way in ("up", "down")
    ]
    curve = vibeam.read(sdof.with_name("sdof.h5"))["sdof"].up
    assert curve is not None
    assert [float(row["amplitude"]) for row in rows[:5]] == curve.amplitude.tolist()
    assert {"frequency (Hz)", "impact_velocity (1/s)", "ended", "mode_energy_1 (1/s²)"} <= set(rows[0])
    known = list(csv.DictReader(sdof.with_name("sdof_motions.csv").read_text("utf-8").splitlines()))
    assert {row["fidelity"] for row in known} == {"exact"}
    assert ".csv" in command("report", "sdof.h5", "--csv", "--out", "a.html", expect=2).stderr


def curve_of(case: Path, columns: str = "amplitude") -> str:
    branch = run(parse(case.read_text(encoding="utf-8"), case))["sdof"].up
    assert branch is not None
    rows = zip(branch.frequency, getattr(branch, columns), strict=True)
    return "\n".join([f"frequency_hz,direction,{columns}", *(f"{float(f)!r},up,{float(a)!r}" for f, a in rows)]) + "\n"


def with_reference(case: Path, text: str) -> Path:
    case.with_name("curve.csv").write_text(text, encoding="utf-8")
    table = '\n[reference.exact]\nfile = "curve.csv"\nfidelity = "sdof"\nquantity = "amplitude"\ntolerance = "0.1 %"\n'
    case.write_text(case.read_text(encoding="utf-8") + table, encoding="utf-8")
    return case


def test_check_passes_misses_and_says_which(command: Command, sdof: Path) -> None:
    checked = with_reference(sdof, curve_of(sdof))
    assert "passed" in command("check", checked).stdout
    assert json.loads(command("check", checked, "--json").stdout)["rows"][0]["passed"] is True
    curve = sdof.with_name("curve.csv")
    curve.write_text(curve.read_text(encoding="utf-8").replace("up,0.", "up,0.9"), encoding="utf-8")
    assert "missed" in command("check", checked, expect=1).stdout
    assert json.loads(command("check", checked, "--json", expect=1).stdout)["rows"][0]["passed"] is False
    assert not list(sdof.parent.glob("*.h5"))


@pytest.mark.parametrize("name", ["run", "check"])
def test_references_that_are_none_are_told_before_anything_is_computed(command: Command, sdof: Path, name: str) -> None:
    with_reference(sdof, "1,up,2\n")
    sdof.with_name("other.csv").write_text("frequency_hz,direction,amplitude\n1,left,2\n", encoding="utf-8")
    table = '[reference.other]\nfile = "other.csv"\nfidelity = "sdof"\nquantity = "amplitude"\ntolerance = 1\n'
    sdof.write_text(sdof.read_text(encoding="utf-8") + table, encoding="utf-8")
    assert command(name, sdof, "--out", "new/", expect=2).stderr.splitlines() == [
        "curve.csv:1: does not begin with the names of its columns: write frequency_hz,direction,amplitude, or "
        'name its own in the case, columns = { frequency = "…", amplitude = "…" } (numbers from 1 where it has none)',
        "other.csv:2: direction 'left' is neither up nor down",
    ]
    assert not (sdof.parent / "new").exists()


def test_check_with_another_grid_says_how_much_it_compared(command: Command, sdof: Path) -> None:
    checked = with_reference(sdof, curve_of(sdof))
    done = command("check", checked, "--set", "sweep.frequency.points=3", "--json", expect=1)
    (row,) = json.loads(done.stdout)["rows"]
    assert (row["points"], row["total"]) == (3, 5)
    assert "2 of 5 reference points are not in the sweep's grid" in row["notes"]


def test_check_keeps_what_it_computes_where_it_is_told(command: Command, sdof: Path) -> None:
    checked = with_reference(sdof, curve_of(sdof))
    command("check", checked, "--out", "kept.h5")
    assert command("check", checked, "--out", "kept.h5").stderr == "all 10 points are there already\n"


def test_a_measured_number_is_shown_and_decides_nothing(command: Command, sdof: Path) -> None:
    table = '\n[measured.top]\nfidelity = "sdof"\nquantity = "peak"\nvalue = 9\nuncertainty = 0.1\nsource = "Fig. 3"\n'
    sdof.write_text(sdof.read_text(encoding="utf-8") + table, encoding="utf-8")
    shown = command("check", sdof, "-v").stdout
    assert shown.startswith("1 measured number is beside the model's, 0 of 1 within the uncertainty.\n")
    assert all(word in shown for word in ("Measured", "predicted", "no", "Fig. 3"))
    assert "References" not in shown
    row = json.loads(command("check", sdof, "--json").stdout)["rows"][0]
    assert (row["kind"], row["within"], row["value"]) == ("measured", False, 9)


def test_several_cases_are_checked_each_with_its_head(command: Command, sdof: Path) -> None:
    curve, text = curve_of(sdof), sdof.read_text(encoding="utf-8")
    good = with_reference(sdof, curve)
    (folder := sdof.parent / "b").mkdir()
    bad, plain, wrong = (folder / name for name in ("sdof.toml", "plain.toml", "wrong.toml"))
    bad.write_text(text, encoding="utf-8")
    with_reference(bad, curve.replace("up,0.", "up,0.9"))
    plain.write_text(text, encoding="utf-8")
    wrong.write_text("titl = 1\n", encoding="utf-8")
    done = command("check", good, plain)
    assert [line for line in done.stdout.splitlines() if line.startswith("/")] == [
        f"{good}: 1 reference holds.",
        f"{plain}: The case is sound; it names no reference to check against and no measured number.",
    ]
    assert done.stdout.count("passed") == 1
    heads = command("check", bad, good, "-q", expect=1).stdout.splitlines()
    assert heads == [f"{bad}: 1 of 1 reference missed (exact).", f"{good}: 1 reference holds."]
    both = command("check", wrong, bad, good, expect=2)
    assert both.stderr.index("titl") < both.stderr.index(f"{bad}:\n"), "all faults are told before anything is run"
    assert [line.partition(": ")[0] for line in both.stdout.splitlines() if line.startswith("/")] == [
        str(each) for each in (bad, good, wrong)
    ]
    found = json.loads(command("check", bad, good, "--json", expect=1).stdout)
    assert (found["schema"], [each["missed"] for each in found["checks"]]) == ("vibeam.check/1", [1, 0])
    for words in (("--plot", "a.png"), ("--out", "a.h5")):
        assert "names a folder where there are several cases" in command("check", bad, good, *words, expect=2).stderr
    assert "good" not in [each.stem for each in sdof.parent.iterdir()]


def test_check_without_a_reference_says_so(command: Command, sdof: Path) -> None:
    assert "names no reference" in command("check", sdof).stdout
    found = json.loads(command("check", sdof, "--json").stdout)
    assert (found["schema"], found["rows"], found["missed"]) == ("vibeam.check/1", [], 0)


@pytest.mark.extension
def test_check_refuses_what_run_would(command: Command, sdof: Path) -> None:
    linear = 'stop={law = "linear", stiffness = 100.0, restitution = 0.9, gap = 0.0}'
    words = ("--set", linear, "--set", 'fidelity.sdof.solver="mapping"')
    shown = [command(name, sdof, *words, expect=2).stderr for name in ("check", "run")]
    assert "cannot take" in shown[0]
    assert shown[0] == shown[1]


def test_derive_prints_and_writes_its_table(command: Command, tmp_path: Path) -> None:
    shown = command("derive", RIG).stdout.splitlines()
    assert shown[0] == (
        "One degree of freedom: k = 1219 N/m, m = 535.5 g, f = 7.593 Hz (0.0488 % below the finite-element value), "
        "ζ = 1.7 %, with R₁ = 0.72 of mode 1."
    )
    assert max(map(len, shown[1:])) <= 100
    rows = json.loads(command("derive", RIG, "--json", "--out", "a.csv").stdout)["rows"]
    assert {"name", "symbol", "unit", "value", "reference", "error", "assumption"} <= set(rows[0])
    assert len((tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()) == len(rows) + 1
    assert "there is no beam" in command("derive", write(tmp_path, SDOF), expect=2).stderr
    assert "--speed: '0 m/s' must be > 0" in command("derive", RIG, "--speed", "0 m/s", expect=2).stderr


def test_modes_prints_its_table_and_writes_shapes(command: Command, tmp_path: Path) -> None:
    """The first lines by the columns below: R = 0.72 at the contact, R₁ by (1 + R) of the share, less 1."""
    held = ("--set", 'stop.restitution_of="contact"')
    alone, both = (command("modes", RIG, *words, "--count", 2).stdout.splitlines()[0] for words in ((), held))
    first, models = "Mode 1, at 7.597 Hz, has 92.1 % of the contact's mobility, ", " in a model cut off after mode 1, "
    assert both.startswith(f"{first}the first 2 modes have 94 %; with ")
    assert alone.endswith(f"; with R₁ = 0.72 of mode 1 held, the contact has R = 0.72{models}0.7566 after mode 2.")
    assert both.endswith(f"R = 0.72 held at the contact, mode 1 sees R₁ = 0.72{models}0.6841 after mode 2.")
    rows = json.loads(command("modes", RIG, *held, "--json", "--count", 4, "--out", "a.vtu").stdout)["rows"]
    assert [row["number"] for row in rows] == [1, 2, 3, 4]
    assert rows[0]["frequency"] == pytest.approx(7.60, abs=0.005)
    assert rows[0]["first_mode_restitution"] == pytest.approx(0.72)
    assert [round(rows[n - 1]["first_mode_restitution"], 2) for n in (1, 2)] == [0.72, 0.68]
    mesh = meshio.read(tmp_path / "a.vtu")
    assert mesh.cells[0].type == "line"
    assert len(mesh.point_data) == 8
    shapes = {name: field for name, field in mesh.point_data.items() if not name.endswith("rotation")}
    assert len(shapes) == 4
    for field in shapes.values():
        assert np.abs(field[:, 2]).max() == 1.0
        assert not field[:, :2].any()
    assert mesh.points[:, 0].max() == pytest.approx(0.18)
    assert "R₁" in command("modes", RIG).stdout
    assert ".vtu" in command("modes", RIG, "--out", "a.png", expect=2).stderr
    assert "there is no beam" in command("modes", write(tmp_path, SDOF), expect=2).stderr
    command("modes", RIG, "--count", 0, expect=2)


def test_all_shares_make_one_in_the_whole_beam(command: Command) -> None:
    rows = json.loads(command("modes", RIG, "--json", "--count", 1000).stdout)["rows"]
    assert rows[-1]["share"] == pytest.approx(1.0)
    first = json.loads(command("modes", RIG, "--json", "--set", 'stop.restitution_of="first mode"').stdout)["rows"]
    assert {row["first_mode_restitution"] for row in first} == {0.72}
    assert first[-1]["contact_restitution"] > first[0]["contact_restitution"]


def test_modes_needed_answers_first_and_writes_its_errors(command: Command, tmp_path: Path) -> None:
    plain = ("--set", "beam.elements=8", "--set", 'figure.format=["svg"]', "--set", "sweep.frequency.points=9")
    words = ("study", "modes_needed", RIG, *plain, "--most", 4, "--out", "found/")
    done = command(*words)
    names = {f"{RIG.stem}_modes_needed{ending}" for ending in (".csv", ".svg", "_times.svg")}
    assert {path.name for path in (tmp_path / "found").iterdir()} == names
    lines = done.stdout.splitlines()
    assert len(lines) <= 40
    assert " suffice for 5 %" in lines[0]
    rows = (tmp_path / "found" / f"{RIG.stem}_modes_needed.csv").read_text("utf-8").splitlines()
    assert rows[0] == "modes,reduction,amplitude_error,frequency_error,kind_width,why"
    assert [row.split(",")[:2] for row in rows[1:3]] == [["1", "static_mode"], ["1", "modal"]]
    data = json.loads(command(*words, "--json", "--accuracy", "20 %", "--frequency-accuracy", "2 %").stdout)
    assert (data["plan"]["accuracy"], data["plan"]["frequency_accuracy"], data["enough"]) == (0.2, 0.02, 1)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--accuracy", "3 Hz"), "is a frequency, not a plain number"),
        (("--accuracy", ""), "--accuracy: '' is not a number"),
        (("--frequency-accuracy", "200 %"), "is outside (0, 1]"),
        (("--most", "0"), "is outside [1, "),
    ],
)
def test_modes_needed_refuses_what_it_cannot_answer(
    command: Command, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    assert said in command("study", "modes_needed", RIG, *words, expect=2).stderr
    assert list(tmp_path.iterdir()) == []


def test_new_writes_a_sound_case_once(command: Command, tmp_path: Path) -> None:
    command("new")
    assert parse((tmp_path / "case.toml").read_text(encoding="utf-8")).fidelities
    before = (tmp_path / "case.toml").read_bytes()
    assert "is there already" in command("new", expect=2).stderr
    assert (tmp_path / "case.toml").read_bytes() == before
    assert json.loads(command("new", "--out", "b.toml", "--json").stdout)["written"] == "b.toml"
    assert "is c.toml already" in command("new", "c.toml", "--out", "d.toml", expect=2).stderr
    command("new", ".", expect=2)
    assert command("new", "a/folder").stdout.startswith("wrote a/folder/case.toml: ")
    assert ".toml, or a folder" in command("new", "case.tml", expect=2).stderr


def test_new_writes_a_case_that_runs(command: Command, tmp_path: Path) -> None:
    command("new", "rig/")
    before = {file: file.read_bytes() for file in (tmp_path / "rig").iterdir()}
    assert "is there already" in command("new", "rig/", expect=2).stderr
    assert {file: file.read_bytes() for file in (tmp_path / "rig").iterdir()} == before
    assert json.loads(command("modes", "rig/case.toml", "--json").stdout)["rows"][0]["frequency"] > 1
    assert command("run", "rig/case.toml").stdout.endswith("case_errors_times.svg\n")


def test_new_knows_its_examples(command: Command) -> None:
    assert "no such example; known here: " in command("new", "--from", "", expect=2).stderr


def test_modes_writes_the_matrices_and_the_table_that_reads_them(command: Command, tmp_path: Path) -> None:
    said = command("modes", RIG, "--matrices", "rig.npz").stderr
    assert 'mass = { file = "rig.npz", name = "M" }' in said
    assert (tmp_path / "rig.npz").exists()
    assert "ends in .npz or .h5" in command("modes", RIG, "--matrices", "rig.xyz", expect=2).stderr
    command("new", "--from", "frame")
    refused = command("modes", "frame.toml", "--out", "shapes.vtu", expect=2).stderr
    assert "no shapes to draw: the case gives no places of its coordinates" in refused
    assert command("derive", "frame.toml", expect=2).stderr.startswith("frame.toml: nothing to derive: this case gives")


def test_keys_wraps_and_cuts_nothing(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    lines = command("keys").stdout.splitlines()
    assert max(map(len, lines)) <= 100
    assert f" {len(json.loads(command('keys', '--json').stdout)['rows'])} keys. " in lines[0]
    assert all(any(line.startswith(head) for line in lines) for head in ("above all", "[stop] ", "[STUDY] "))
    assert command("keys", "-v").stdout == command("keys", "--all").stdout
    for table in ("beam", "section", "stop", "show", "map", "fidelity", "drive"):
        shown = command("keys", table).stdout.splitlines()
        assert max(map(len, shown)) <= 100
        words = " ".join(" ".join(shown).split())
        rows = json.loads(command("keys", table, "--json").stdout)["rows"]
        own = [row["meaning"].partition("; ")[0] + row["unit"] for row in rows if " with [" not in row["table"]]
        assert words.count("…") == "".join(own).count("…")  # of their own: 1, 2 …
        for row in rows:
            assert " with [" in row["table"] or any(f".{row['key']} " in line for line in shown), row
            assert " with [" in row["table"] or row["unit"].split()[-1] in words, row
    assert "linear" in command("keys", "stop.law").stdout
    assert "[stop] with [sdof]" in command("keys", "stop.gap").stdout, (
        "one name is shown in full, of every kind of case"
    )
    assert command("keys", "stop", "-q").stdout.count("\n") == 1


@pytest.mark.parametrize("table", ["beam", "stop", "show", "map", "drive", "sweep.frequency", "record", "fit"])
def test_keys_cuts_nothing_in_a_pipe(command: Command, monkeypatch: pytest.MonkeyPatch, table: str) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    rows = [row for row in json.loads(command("keys", table, "--json").stdout)["rows"] if " with [" not in row["table"]]
    said, *lines = command("keys", table).stdout.rstrip().splitlines()
    assert said.startswith(f"{len(rows)} key")
    for row, line in zip(rows, lines[-len(rows) :], strict=True):
        assert line.split()[0].endswith(row["key"])
        assert line.endswith(f"{row['meaning']} [{row['unit']}]"), line


def test_keys_lists_every_key(command: Command) -> None:
    assert "youngs_modulus" in command("keys", "--all").stdout
    rows = json.loads(command("keys", "--json").stdout)["rows"]
    assert {"table", "key", "unit", "default", "meaning"} <= set(rows[0])
    assert all(isinstance(row["default"], str) for row in rows)


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("clamp", {"stiffness"}),
        ("[clamp]", {"stiffness"}),
        ("stop.gap", {"gap"}),
        ("sweep.frequency", {"frequency", "from", "to", "points"}),
        ("sweep.frequency.from", {"from"}),
        ("fidelity.beam.modes", {"modes"}),
        ("fidelity.modes", {"modes"}),
        ("added_mass.0.mass", {"mass"}),
        ("ends", {"ends"}),
        ("added_mass", {"mass", "position", "rotary_inertia", "rigid_half_width", "on"}),
        ("title", {"title"}),
        ("sdof", {"natural_frequency", "damping_ratio"}),
    ],
)
def test_keys_of_one_table_or_one_name(command: Command, name: str, keys: set[str]) -> None:
    assert {row["key"] for row in json.loads(command("keys", name, "--json").stdout)["rows"]} == keys


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("stpo", "unknown key 'stpo'; did you mean 'stop'?"),
        ("excitation", "unknown key 'excitation'; did you mean 'drive'?"),
        ("clearance", "unknown key 'clearance'; did you mean 'stop.gap'?"),
        ("fidelity.beam.method", "unknown key 'fidelity.beam.method'; did you mean 'reduction' and 'solver'?"),
        ("stop.gpa", "unknown key 'stop.gpa'; did you mean 'gap'?"),
        ("stop.gap.x", "unknown key 'stop.gap.x'; stop.gap holds a value, no keys"),
        ("fidelity.modse", "unknown key 'fidelity.modse'; did you mean 'modes'?"),
        ("fidelity.beam.modse", "unknown key 'fidelity.beam.modse'; did you mean 'modes'?"),
        ("clamp.xyz", "unknown key 'clamp.xyz'; known here: stiffness"),
        ("x\x1b", r"unknown key 'x\x1b'; known here: added_mass,"),
    ],
)
def test_keys_says_what_was_meant(command: Command, name: str, message: str) -> None:
    assert command("keys", name, expect=2).stderr.startswith(message)


def test_keys_prints_the_schema_of_a_case(command: Command) -> None:
    from vibeam.casefile.documentation import case_schema

    assert json.loads(command("keys", "--schema").stdout) == case_schema()
    assert "leave NAME and --out away" in command("keys", "stop", "--schema", expect=2).stderr
    assert "leave NAME and --out away" in command("keys", "--schema", "--out", "a.csv", expect=2).stderr


def test_version_and_help(command: Command) -> None:
    assert command("--version").stdout == f"vibeam {__version__}\n"
    text = command("--help").stdout
    assert all(name in text for name in ("run", "derive", "check", "modes", "new", "keys", "doctor"))


def write(folder: Path, text: str) -> Path:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return path


WRONG = {
    "unknown key": ("densty = 1\n[beam]", "[beam]", "unknown key"),
    "wrong unit": ('length = "180 kg"', 'length = "180 mm"', "is a mass, not a length"),
    "negative length": ('length = "-180 mm"', 'length = "180 mm"', "beam.length"),
    "mass beyond the tip": ('position = "190 mm"', 'position = "132 mm"', "beyond the tip"),
    "sensor at the clamp": ('position = "0 mm"', 'position = "100 mm"', "sensor.position"),
    "restitution": ("restitution = 1.2", "restitution = 0.72", "1.2 is outside [0, 1]"),
    "empty sweep": ("points = 0", "points = 121", "sweep.frequency"),
    "NaN": ("width = nan", 'width = "20 mm"', "beam.width"),
}


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("name", ["run", "check", "derive", "modes"])
def test_a_wrong_case_is_a_message_and_no_file(command: Command, tmp_path: Path, name: str, wrong: str) -> None:
    new, old, message = WRONG[wrong]
    text = RIG.read_text(encoding="utf-8").replace(old, new, 1).split("[reference")[0]
    path = write(tmp_path, text)
    result = command(name, path, expect=2)
    assert message in result.stderr
    assert str(path) in result.stderr
    assert result.stdout == ""
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("content", [b"", b"\x00\xff\x89HDF rubbish", b"a = [" * 9000, b"# text\n" * 1_500_000])
def test_a_file_that_is_no_case(command: Command, tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    for name in ("run", "check", "derive", "modes"):
        assert str(path) in command(name, path, expect=2).stderr
        assert str(tmp_path) in command(name, tmp_path, expect=2).stderr
        assert "none.toml" in command(name, tmp_path / "none.toml", expect=2).stderr
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("setting", ["", "=", "stop.gap", "=1", "nonsense.key=1", "stop.gap=1 kg", "stop=1"])
def test_a_wrong_override_is_a_message(command: Command, sdof: Path, setting: str) -> None:
    assert "--set" in command("run", sdof, "--set", setting, expect=2).stderr
    assert list(sdof.parent.iterdir()) == [sdof]


def test_a_place_that_cannot_be_written_is_one_line(command: Command, sdof: Path) -> None:
    for out in ("", "sdof.toml/a.h5", "sdof.toml/below/a.h5", "sdof.toml/", "a.txt", "sdof.toml", "a.h5.txt", "v1.2"):
        assert command("run", sdof, "--out", out, expect=2).stderr.count("\n") == 1
    assert "write v1.2/ for a new folder" in command("run", sdof, "--out", "v1.2", expect=2).stderr
    assert list(sdof.parent.iterdir()) == [sdof]
    sdof.with_name("a.h5").write_text("mine", encoding="utf-8")
    assert "no vibeam result" in command("run", sdof, "--out", "a.h5", expect=2).stderr
    assert sdof.with_name("a.h5").read_text(encoding="utf-8") == "mine"
    assert command("derive", RIG, "--out", "sdof.toml/a.csv", expect=2).stderr.count("\n") == 1
    assert command("modes", RIG, "--out", "a.h5/a.vtu", expect=2).stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("out", "file"),
    [
        ("some/new/folder/x.h5", "some/new/folder/x.h5"),
        ("some/new/folder/", "some/new/folder/sdof.h5"),
        ("some/new/folder", "some/new/folder/sdof.h5"),
        ("v1.2/", "v1.2/sdof.h5"),
        ("x.h5/", "x.h5/sdof.h5"),
        (".", "sdof.h5"),
    ],
)
def test_a_new_folder_is_made_for_what_is_written(command: Command, sdof: Path, out: str, file: str) -> None:
    assert json.loads(command("run", sdof, "--out", out, "--json").stdout)["files"][0] == file
    assert (sdof.parent / file).is_file()


def test_every_command_makes_its_folder(command: Command, tmp_path: Path) -> None:
    command("derive", RIG, "--out", "a/b/")
    command("modes", RIG, "--count", 1, "--out", "a/c/shapes.vtu")
    command("keys", "--out", "a/d/keys.csv")
    files = {str(path.relative_to(tmp_path / "a")) for path in (tmp_path / "a").rglob("*.*")}
    assert files == {"b/dtu_neutral_derive.csv", "c/shapes.vtu", "d/keys.csv"}


def test_a_fidelity_that_cannot_be_built_is_a_message(command: Command, tmp_path: Path) -> None:
    settings = ("--set", "stop.restitution=1", "--set", 'stop.restitution_of="first mode"')
    result = command("run", RIG, *settings, expect=2)
    assert "fidelity.beam" in result.stderr
    assert not list(tmp_path.iterdir())


STOPPED = """
import importlib, os, signal, sys
sys.path[:0] = {path!r}
from stand_in import Solver
from vibeam.runs import fidelity_sweep
from vibeam.cli.main import main

signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job inherits it as ignored

def march(*given, **options):
    for i, block in enumerate(Solver(pause=0.05)(*given, **options)):
        yield block
        if i == 3:
            os.kill(os.getpid(), signal.SIGINT)  # four points are taken by now

fidelity_sweep.march_blocks = march
importlib.import_module("vibeam.runs.run")._warm_up = lambda case, job: None
sys.argv = ["vibeam", "run", {case!r}, "--set", "sweep.frequency.points=100000"]
main()
"""


def test_ctrl_c_stops_keeps_and_says_how_to_go_on(sdof: Path, tmp_path: Path) -> None:
    """The program interrupts itself; were it not to stop, it would go on for hours."""
    script = STOPPED.format(path=[TESTS, *sys.path], case=str(sdof))
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=HANGS, check=False)
    assert done.returncode == 130
    kept = re.search(r"stopped: (\d+) of 200000 points are kept in sdof.h5: the same command goes on", done.stderr)
    assert kept
    assert int(kept[1]) >= 4
    assert "Traceback" not in done.stderr


IMPORTING = """
import sys
class Interrupted:
    def find_spec(self, name, *given):
        if name == {at!r}:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupted())
sys.argv = ["vibeam", "keys"]
from vibeam.__main__ import main
main()
"""


@pytest.mark.parametrize("at", ["vibeam.cli.streams", "typer", "vibeam.casefile.documentation"])
def test_ctrl_c_while_the_command_is_imported_is_no_traceback(tmp_path: Path, at: str) -> None:
    script = f"import sys\nsys.path[:0] = {sys.path!r}\n{IMPORTING.format(at=at)}"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 130
    assert "Traceback" not in done.stderr


SWALLOWED = """
import os, signal, sys, time
class Interrupted:
    def find_spec(self, name, *given):
        if name == "vibeam.cli.streams":
            try:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(60)
            except BaseException:
                pass
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job inherits it as ignored
sys.meta_path.insert(0, Interrupted())
sys.argv = ["vibeam", "--version"]
from vibeam.__main__ import main
main()
"""


def test_ctrl_c_ends_the_process_where_imported_code_would_swallow_it(tmp_path: Path) -> None:
    script = f"import sys\nsys.path[:0] = {sys.path!r}\n{SWALLOWED}"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


@pytest.mark.parametrize("given", [None, "3"])
def test_linear_algebra_has_one_thread_unless_more_are_asked_for(
    given: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    seen = list[str]()
    monkeypatch.setattr("vibeam.cli.entry.main", lambda: seen.append(os.environ["OPENBLAS_NUM_THREADS"]))
    import_module("vibeam.__main__").main()
    assert seen == [given or "1"]


def test_the_package_imports_next_to_nothing_before_the_first_line_of_the_command(tmp_path: Path) -> None:
    """Until then Ctrl-C is the interpreter's, which prints a traceback: ``runpy`` is what it runs modules with."""
    script = f"""import sys
sys.path[:0] = {sys.path!r}
import runpy
before = set(sys.modules)
import vibeam
print(sorted(set(sys.modules) - before))"""
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "['__future__', 'vibeam', 'vibeam.system', 'vibeam.system.public_names']\n"


def test_libraries_without_room_are_a_message_and_other_imports_a_defect(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit) as end, mistakes():
        raise ImportError("/a/_x.so: failed to map segment from shared object")
    assert end.value.exit_code == 2
    assert "not enough memory to load" in capsys.readouterr().err
    with pytest.raises(ImportError, match="no name"), mistakes():
        raise ImportError("no name x in y")


def test_the_module_is_the_command(tmp_path: Path) -> None:
    places = os.pathsep.join(path for path in sys.path if path)
    command = [sys.executable, "-m", "vibeam", "run", "none.toml"]
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | {"PYTHONPATH": places}, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "none.toml: no such file\n")
