"""Length of answers: remarks of one sentence, tables without columns by the dozen, all of it with ``-v``."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest
from stand_in import RIG
from typer.testing import CliRunner

from vibeam.cli.main import app

LOW = ("--set", "stop.restitution=0.1", "--set", "stop.restitution_of=contact")  # R₁ < 0 in models of many modes
FEW = ("--set", "sweep.frequency.points=2", "--set", "sweep.settle=5", "--set", "sweep.hold=2")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def vibeam(*words: object, code: int = 0) -> Any:
    done = CliRunner().invoke(app, list(map(str, words)))
    assert done.exit_code == code, done.output
    return done


@pytest.mark.parametrize(
    ("command", "further"),
    [
        ("modes", ("--count", "20")),
        ("run", (*FEW, "--fidelity", "beam")),
        ("check", FEW),
    ],
)
def test_a_table_to_paste_is_shown_on_request_alone(undrawn: None, command: str, further: tuple[str, ...]) -> None:
    place, low = ("mass.mass=1 g", "0.05")
    asked = (command, RIG, *LOW, "--set", place, "--set", f"stop.restitution={low}", *further)
    expected = 1 if command == "check" else 0
    brief, whole = vibeam(*asked, code=expected).stdout, vibeam(*asked, "-v", code=expected).stdout
    assert "R₁ < 0" in brief
    assert "more: -v" in brief.splitlines()
    assert ("[stop]" in brief, "youngs_modulus" in brief) == (False, False)
    assert "In place of [stop] as it is:\n[stop]\n" in whole
    assert "youngs_modulus" in whole


@pytest.mark.parametrize(("modes", "written"), [(3, True), (8, True), (9, False), (40, False)])
def test_energies_of_many_modes_are_columns_on_request_alone(undrawn: None, modes: int, written: bool) -> None:
    vibeam("run", RIG, *FEW, "--fidelity", "beam", "--set", f"fidelity.beam.modes={modes}", "--out", "a.h5", "-q")
    done = vibeam("report", "a.h5", "--csv", "--out", "brief.csv")
    vibeam("report", "a.h5", "--csv", "--out", "whole.csv", "-v")
    brief, whole = (
        list(csv.DictReader(Path(name).read_text("utf-8").splitlines())) for name in ("brief.csv", "whole.csv")
    )
    energies = [name for name in whole[0] if name.startswith("mode_energy_")]
    assert energies == [f"mode_energy_{number} (J)" for number in range(1, modes + 1)]
    assert [name for name in whole[0] if written or name not in energies] == list(brief[0])
    assert [row["amplitude (m)"] for row in brief] == [row["amplitude (m)"] for row in whole]
    assert ("mode_energy_1 to " in done.stderr) is not written


def test_the_tables_of_regression_values_are_the_answer(undrawn: None) -> None:
    said = vibeam("check", RIG, *FEW, "--write", "--out", "values", "-q").stdout
    assert said.count("\n[reference.") == 3
    assert said.count('tolerance = "0.001 %"') == 3
