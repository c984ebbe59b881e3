"""A study that a user's module brings, asked for on the command line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from stand_in import SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.case.study_plans import STUDY_PLANS
from vibeam.cli.main import app
from vibeam.report.declaration import STUDIES, StudyDeclaration
from vibeam_models.keys import quantity

MODULE = """
from dataclasses import dataclass
import vibeam

@dataclass(frozen=True)
class Gap:
    fidelity: str
    gap: float

def gaps(case):
    if case.title == "refused":
        raise ValueError("this title is not studied")
    return [Gap(name, case.system(name).gap) for name in case.fidelities]

vibeam.register_study(vibeam.StudyDeclaration("gaps", gaps, "gap of each fidelity"))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "my_gaps.py").write_text(MODULE)
    (tmp_path / "a.toml").write_text(SDOF)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(__import__("sys").modules, "my_gaps", raising=False)
    yield tmp_path
    for name in ("gaps", "narrower"):
        for registry in (STUDIES, STUDY_PLANS):
            if name in registry:
                registry.remove(name)


def test_a_registered_study_runs_from_the_command_line(folder: Path) -> None:
    call = ["--load", "my_gaps", "study", "gaps", "a.toml", "--json", "--out", "gaps.csv"]
    done = CliRunner().invoke(app, call)
    assert done.exit_code == 0, done.output
    system = vibeam.load("a.toml").system("sdof")
    assert json.loads(done.stdout)["rows"] == [{"fidelity": "sdof", "gap": system.gap}]
    assert (folder / "gaps.csv").read_text().splitlines()[0] == "fidelity,gap"
    table = CliRunner().invoke(app, ["study", "gaps", "a.toml"])
    assert "gap of each fidelity" in table.stdout


def test_a_study_that_takes_progress_alone_is_given_the_points(folder: Path) -> None:
    heard: list[tuple[int, ...]] = []
    study = StudyDeclaration("gaps", lambda case, progress: [progress(1, 2)], "gap of each fidelity")
    study.of(vibeam.load("a.toml"), pytest.fail, lambda *told: heard.append(told))
    assert heard == [(1, 2)]
    silent = StudyDeclaration("gaps", list, "gap of each fidelity", sentences=lambda rows: [])
    assert silent.shown([], vibeam.load("a.toml")).answer == ""


def test_what_is_wrong_is_said(folder: Path) -> None:
    nothing = CliRunner().invoke(app, ["study", "gaps", "a.toml"])
    assert (nothing.exit_code, "no study 'gaps'; known here: " in nothing.stderr) == (2, True)
    missing = CliRunner().invoke(app, ["--load", "no_such_module", "keys"])
    assert (missing.exit_code, "--load no_such_module: no such module" in missing.stderr) == (2, True)
    refused = CliRunner().invoke(app, ["--load", "my_gaps", "study", "gaps", "a.toml", "--set", "title=refused"])
    assert (refused.exit_code, "a.toml: this title is not studied" in refused.stderr) == (2, True)


@dataclass(frozen=True)
class Narrower:
    """Gap less a play."""

    play: float = quantity("m", "taken off the gap", "0.1 mm", 1e-4, least=0)


@dataclass(frozen=True)
class Rest:
    fidelity: str
    gap: float


def narrower(case: vibeam.Case) -> list[Rest]:
    return [Rest(name, case.system(name).gap - case.asked["narrower"].play) for name in case.fidelities]


def said(rows: list[Rest]) -> list[str]:
    return [f"{len(rows)} gaps", "the play is a guess: measure it"]


def test_a_declaration_is_table_options_answer_and_files(folder: Path) -> None:
    vibeam.register_study(
        StudyDeclaration("narrower", narrower, "gap", sentences=said, figure=lambda rows: Figure(), asks=Narrower)
    )
    gap = vibeam.load("a.toml").system("sdof").gap
    words = ["study", "narrower", "a.toml", "--out", "n.csv"]
    shown = CliRunner().invoke(app, [*words, "--play", "0.5"])
    assert shown.stdout.splitlines()[0] == "1 gaps"
    assert shown.stdout.splitlines()[-2:] == ["the play is a guess: measure it", "wrote n.csv, n.png, n.svg"]
    (Path("b.toml")).write_text(SDOF + "\n[narrower]\nplay = 0.25\n")
    found = json.loads(CliRunner().invoke(app, ["study", "narrower", "b.toml", "--json", "--out", "n.csv"]).stdout)
    assert (found["schema"], found["answer"]) == ("vibeam.narrower/1", "1 gaps")
    assert found["rows"] == [{"fidelity": "sdof", "gap": gap - 0.25}]
    page = CliRunner().invoke(app, [*words[:-1], "n.html"])
    assert page.stdout.splitlines()[-1] == "wrote n.html"
    assert "the play is a guess: measure it" in Path("n.html").read_text(encoding="utf-8")
    wrong = CliRunner().invoke(app, [*words, "--play", "-1", "--json"])
    assert (wrong.exit_code, json.loads(wrong.stdout)["faults"][0]["file"]) == (2, "--play")
    assert "--play" in CliRunner().invoke(app, ["study", "narrower", "-h"]).stdout
    with pytest.raises(ValueError, match="table of that name"):
        vibeam.register_study(StudyDeclaration("stop", narrower, "a stop", asks=Narrower))
    assert "stop" not in STUDIES
