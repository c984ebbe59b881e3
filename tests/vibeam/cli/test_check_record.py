"""``vibeam check``: ``--write`` writes regression values, and never over a file unasked; ``--plot`` draws."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from stand_in import SDOF
from typer.testing import CliRunner

from vibeam.cli.main import app
from vibeam.exchange.curves.reference import read_curve

TABLE = '[reference.sdof_before]\nfile = "references/rig_sdof.csv"\nfidelity = "sdof"\nquantity = "amplitude"\n'


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    file = tmp_path / "rig.toml"
    file.write_text(SDOF, encoding="utf-8")
    return file


def vibeam(*words: str | Path, code: int = 0) -> Any:
    done = CliRunner().invoke(app, list(map(str, words)))
    assert done.exit_code == code, done.output
    return done


def changed(rig: Path, change: Callable[[str], str]) -> None:
    rig.write_text(change(rig.read_text(encoding="utf-8")), encoding="utf-8")


def test_a_recorded_curve_is_a_regression_value_and_met(rig: Path) -> None:
    said = vibeam("check", rig, "--write").output
    file = rig.parent / "references" / "rig_sdof.csv"
    head = [line for line in file.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    assert head[0] == "# Regression values: recorded by vibeam, which is no reference"
    assert any("case rig.toml, one degree of freedom; key " in line for line in head)
    assert any("solver flight" in line for line in head)
    assert any(line.startswith("# vibeam ") and "; numpy " in line for line in head)
    assert TABLE in said
    changed(rig, lambda text: text + TABLE + 'tolerance = "0.001 %"\n')
    (row,) = json.loads(vibeam("check", rig, "--json").stdout)["rows"]
    assert (row["kind"], row["passed"], row["points"], row["worst"]) == ("regression value", True, 10, 0.0)
    changed(rig, lambda text: text.replace("restitution = 0.9", "restitution = 0.8"))
    (row,) = json.loads(vibeam("check", rig, "--json", code=1).stdout)["rows"]
    assert row["passed"] is False


def test_a_file_that_is_there_stays_unless_it_is_forced(rig: Path) -> None:
    vibeam("check", rig, "--write")
    file = rig.parent / "references" / "rig_sdof.csv"
    file.write_text("kept\n", encoding="utf-8")
    said = vibeam("check", rig, "--write", code=2).output
    assert "is there already: --force replaces it, --out FOLDER writes elsewhere" in said
    assert file.read_text(encoding="utf-8") == "kept\n"
    vibeam("check", rig, "--write", "--out", rig.parent / "new")
    assert len(read_curve(rig.parent / "new" / "rig_sdof.csv").points) == 10
    vibeam("check", rig, "--write", "--force")
    assert "--write, which is not asked for" in vibeam("check", rig, "--force", code=2).output
    assert read_curve(file).recorded
    said = vibeam("check", rig, "--write", "--fresh", "--plot", "x.png", code=2).output
    assert "--plot: of a check, and --write makes none" in said
    assert "--fresh: of a check, and --write makes none" in said
    assert "this one has none: write a [reference.NAME]" in vibeam("check", rig, "--plot", "x.png", code=2).output
    assert "no such fidelity; known here: sdof" in vibeam("check", rig, "--write", "--fidelity", "beam", code=2).output


def test_check_draws_references_and_model(rig: Path) -> None:
    vibeam("check", rig, "--write")
    changed(rig, lambda text: text.replace("restitution = 0.9", "restitution = 0.8") + TABLE + "tolerance = 1e-6\n")
    said = vibeam("check", rig, "--plot", rig.parent / "figure.svg", code=1)
    assert f"wrote {rig.parent / 'figure.svg'}" in said.output
    drawn = (rig.parent / "figure.svg").read_text(encoding="utf-8")
    for words in ("sdof_before, sdof: missed", "reference, missed", "model, up", "model, down"):
        assert words in drawn
    assert "ends in .png" in vibeam("check", rig, "--plot", "figure.txt", code=2).output
