"""A study that a user's module brings, asked for on the command line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from stand_in import RIG, SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app
from vibeam.studies.declaration import STUDIES

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
    if "gaps" in STUDIES:
        STUDIES.remove("gaps")


def test_a_registered_study_runs_from_the_command_line(folder: Path) -> None:
    call = ["--load", "my_gaps", "study", "gaps", "a.toml", "--json", "--out", "gaps.csv"]
    done = CliRunner().invoke(app, call)
    assert done.exit_code == 0, done.output
    system = vibeam.load("a.toml").system("sdof")
    assert json.loads(done.stdout) == [{"fidelity": "sdof", "gap": system.gap}]
    assert (folder / "gaps.csv").read_text().splitlines()[0] == "fidelity,gap"
    table = CliRunner().invoke(app, ["study", "gaps", "a.toml"])
    assert "gap of each fidelity" in table.stdout


def test_a_built_in_study_is_declared_like_a_registered_one(folder: Path) -> None:
    rig = vibeam.load(RIG)
    assert list(STUDIES["derive"].of(rig)) == list(vibeam.derive(rig))
    named = {str(study.run).partition(":")[2] for study in STUDIES.values() if study.own_command}
    assert named <= set(vibeam.__all__)


def test_what_is_wrong_is_said(folder: Path) -> None:
    nothing = CliRunner().invoke(app, ["study", "gaps", "a.toml"])
    assert (nothing.exit_code, "no study 'gaps'; none is registered" in nothing.stderr) == (2, True)
    own = CliRunner().invoke(app, ["study", "cost", "a.toml"])
    assert (own.exit_code, "vibeam cost is a command of its own" in own.stderr) == (2, True)
    missing = CliRunner().invoke(app, ["--load", "no_such_module", "keys"])
    assert (missing.exit_code, "--load no_such_module: no such module" in missing.stderr) == (2, True)
    refused = CliRunner().invoke(app, ["--load", "my_gaps", "study", "gaps", "a.toml", "--set", "title=refused"])
    assert (refused.exit_code, "a.toml: this title is not studied" in refused.stderr) == (2, True)
