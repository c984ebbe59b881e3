"""Verdict in stages: the first sentence before any flight, one table, one page, one JSON; what a stage cannot say."""

from __future__ import annotations

import json
import re
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import RIG, SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.quantities import dimension, to_si
from vibeam.cli.main import app
from vibeam.report.declaration import STUDIES
from vibeam.report.verdict import first_answer, sheet
from vibeam_models.keys import defaults_of, keys_of

FEW = {"sweep.frequency.points": 5, "sweep.settle": 20, "sweep.hold": 4, "modes_needed.most": 3}


def asked(*words: object) -> Any:
    settings = [each for key, value in FEW.items() for each in ("--set", f"{key}={value}")]
    return CliRunner().invoke(app, ["verdict", str(RIG), *settings, *map(str, words)])


def test_the_first_sentence_is_known_before_any_stage(monkeypatch: pytest.MonkeyPatch) -> None:
    """By few frequencies: the errors are those of orbits in closed form."""

    def asked_for(*given: object, **named: object) -> None:
        raise AssertionError("a stage")

    study = import_module("vibeam.studies.verdict")
    for name in ("modes_needed", "influence", "cost", "fidelity_map"):
        monkeypatch.setattr(study, name, asked_for)
    case = vibeam.load(RIG)
    said = re.fullmatch(
        r"At 7 frequencies two modes suffice for 5 %: amplitudes within ([\d.]+) %\.", first_answer(case)
    )
    assert said
    two, beam = (orbit_amplitudes(case, name, 7) for name in ("two_modes", "beam"))
    assert np.abs(two / beam - 1).max() == pytest.approx(float(said[1]) / 100, abs=2e-3)  # 1e-3 beam, rest rounding


def orbit_amplitudes(case: vibeam.Case, name: str, count: int) -> np.ndarray:
    """Amplitudes of the stable motions with one impact a period, each in closed form by itself."""
    system, grid, found = case.system(name), case.sweep.frequency, list[float]()
    for hertz in np.sort(grid)[np.linspace(0, len(grid) - 1, count).round().astype(int)]:
        drive = vibeam.Drive(omega=2 * np.pi * hertz, amplitude=case.base_amplitude)
        [orbit] = [each for each in vibeam.orbits(system, drive) if each.stable and each.admissible]
        found.append(orbit.amplitude("sensor"))
    return np.array(found)


def test_several_stages_are_one_table_one_page_and_one_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = asked("--only", "modes", "--only", "effects")
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert [each for each in ("How many modes?", "Which effects?", "Which solver?") if each in done.stdout] == [
        "How many modes?", "Which effects?",
    ]  # fmt: skip
    assert len(lines) <= 40
    assert max(len(line) for line in lines[1 : lines.index("")]) <= 100
    assert lines[-1] == f"wrote {RIG.stem}_verdict.html, {RIG.stem}_verdict.csv"
    page = (tmp_path / f"{RIG.stem}_verdict.html").read_text(encoding="utf-8")
    assert lines[0] in page
    assert "http://" not in page.replace("http://www.w3.org/", "")
    found = json.loads(asked("--only", "modes", "--only", "effects", "--json").stdout)
    assert (found["schema"], list(found["stages"])) == ("vibeam.verdict/1", ["modes", "effects"])
    assert found["stages"]["modes"]["answer"] == found["answer"] == lines[0]


YIELDS = {"stop.law": "linear", "stop.stiffness": "20 kN/m", "stop.restitution_of": "contact"}
AT_CONTACT = {"stop.restitution_of": "contact", "stop.gap": "0.3 mm", "sweep.frequency": '["14 Hz", "15.3 Hz"]'}


@pytest.mark.parametrize("further", [{}, YIELDS, AT_CONTACT, {"modes_needed.most": 2}, {"stop.gap": "9 mm"}])
def test_an_answer_stands_there_once_and_nothing_is_promised(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, further: dict[str, str]
) -> None:
    """What is not known before a flight is not said before it: the same sentence, with other numbers, would follow."""
    monkeypatch.chdir(tmp_path)
    given = [each for key, value in further.items() for each in ("--set", f"{key}={value}")]
    done = asked("--only", "modes", "--only", "solvers", "--budget", "2 s", *given)
    assert done.exit_code == 0, done.output
    said = done.stdout.partition("How much model")[0].splitlines()
    assert [len([line for line in said if word in line]) <= 1 for word in (" suffice", "needed for")] == [True, True]
    assert len([line for line in said if line]) == 1
    assert "CPU time" not in done.stderr
    assert re.search(r"^Solvers: up to \d+ runs of \d models?$", done.stderr, re.MULTILINE)


def test_a_stage_without_an_answer_is_a_note_and_no_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    place = RIG.parent / "rigs" / "relay.toml"
    words = ["--only", "modes", "--only", "effects", "--set", "sweep.frequency.points=3", "--set", "sweep.settle=20"]
    done = CliRunner().invoke(app, ["verdict", str(place), *words])
    assert done.exit_code == 0, done.output
    assert "How many modes?" in done.stdout
    assert "Which effects?" not in done.stdout
    assert "\nNot answered: effects (fidelity 'spring' names no effect: " in done.stdout
    found = json.loads(CliRunner().invoke(app, ["verdict", str(place), *words, "--json"]).stdout)
    assert "names no effect" in found["stages"]["effects"]["why"]


def test_one_stage_is_its_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = asked("--only", "modes", "--accuracy", "1 %")
    assert done.stdout.startswith("Three modes suffice for 1 %")
    assert {each.suffix for each in tmp_path.iterdir()} == {".csv", ".png", ".svg"}


def test_a_key_without_a_usual_range_is_refused_with_the_command_that_takes_one() -> None:
    done = asked("--over", "restitution")
    assert (done.exit_code, done.stdout) == (2, "")
    assert "vibeam map CASE --picture verdict --over restitution --from" in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        *((name, str(RIG)) for name in ("reduce", "limit", "influence", "cost", "identify", "record", "stability")),
        ("new", "--rig", "relay"), ("check", str(RIG), "--record"),
    ],
)  # fmt: skip
def test_names_that_no_release_had_are_unknown(
    words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, list(words))
    assert (done.exit_code, done.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert "No such" in done.stderr
    assert "is now" not in done.stderr


def test_the_default_of_an_option_is_shown_as_its_example() -> None:
    for study in STUDIES.values():
        for name, usual in defaults_of(study.asks).items() if study.asks else ():
            key = keys_of(study.asks)[name]
            if isinstance(usual, float):
                assert to_si(key.example, dimension(key.unit)) == usual, f"{study.name}.{name}"
            elif usual is not None and not key.several:
                assert key.example == usual, f"{study.name}.{name}"


def test_a_stage_that_cannot_be_had_says_why_and_the_others_answer(tmp_path: Path) -> None:
    case = tmp_path / "a.toml"
    case.write_text(SDOF, encoding="utf-8")
    found = vibeam.studies.verdict(vibeam.load(case), only=["modes", "solvers"], budget="5 s")
    shown = sheet(found)
    assert found.stages[0].why
    assert shown.rows[0].answer == f"Not answered: {found.stages[0].why}"
    assert shown.answer == shown.rows[1].answer
    with pytest.raises(ValueError, match="there is no beam"):
        found["modes"]
    with pytest.raises(KeyError, match="there are modes, solvers"):
        found["map"]
    with pytest.raises(ValueError, match="there is no beam"):
        vibeam.studies.verdict(vibeam.load(case), only="modes")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--only", "mode"), "--only: 'mode' is not one of"),
        (("--accuracy", "3 Hz"), "--accuracy: '3 Hz' is a frequency, not a plain number"),
        (("--budget", "0 s"), "--budget: '0 s' must be > 0"),
        (("--over", "gapp"), "--over: 'gapp' is no key of the case"),  # at once, not behind the stages before it
        (("--accuracy", "5"), "--accuracy: 5 is outside (0, 1]: if it is a percentage, write '5 %'"),
        (("--set", "modes_needed.frequency_accuracy=0"), "--set modes_needed.frequency_accuracy: 0 is outside (0, 1]"),
    ],
)
def test_a_mistake_is_one_message_and_no_file(
    words: tuple[str, ...], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = asked(*words)
    assert done.exit_code == 2
    assert said in done.stderr
    assert "Traceback" not in done.output
    assert not done.stdout
    assert not list(tmp_path.iterdir())
