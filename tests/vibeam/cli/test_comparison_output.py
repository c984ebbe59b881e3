"""What ``vibeam run`` prints and draws of a comparison: what is held, the other choice, the finest one's own limit.

+32.1 % and −10.5 % are the peaks of two runs, of either choice; ``tests/vibeam/runs/test_held_comparison.py`` derives
them and the limit independently.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from stand_in import RIG
from typer.testing import CliRunner

from vibeam.cli.main import app

SHORT = (
    'sweep.frequency={from="14.9 Hz",to="15.7 Hz",points=17}', 'sweep.direction="up"', "sweep.settle=150",
    "sweep.hold=10", 'stop.restitution_of="contact"',
)  # fmt: skip
TURNS = (
    "The verdict on sdof and two_modes turns with what is held: R = 0.72 at the contact here, or R₁ = 0.72 of mode 1."
)


def vibeam_run(*words: str, code: int = 0) -> Any:
    settings = [word for each in SHORT for word in ("--set", each)]
    result = CliRunner().invoke(app, ["run", str(RIG), *settings, *words])
    assert result.exit_code == code, result.output
    return result


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_first_line_says_that_the_verdict_turns() -> None:
    lines = vibeam_run().stdout.splitlines()
    assert lines[0] == TURNS
    tables = lines[: next(i for i, line in enumerate(lines) if line.startswith("beam is off"))]
    assert max(map(len, tables[1:])) <= 100
    row = next(line for line in tables if line.startswith("sdof") and line.count("%") > 1)
    assert "+32.1 %" in row
    assert "-10.5 %" in row
    assert any(line.startswith("beam is off its own limit by +6.3") for line in lines)
    drawn = Path("dtu_neutral.svg").read_text(encoding="utf-8")
    assert "frequency response, R = 0.72 at the contact" in drawn
    assert "held instead: sdof -10.5 %" in drawn


def test_json_has_the_same_as_numbers() -> None:
    found = json.loads(vibeam_run("--json").stdout)["comparisons"]
    assert [(each["finest"], each["held"]["label"]) for each in found] == [("beam", "R = 0.72 at the contact")]
    sdof = found[0]["rows"][0]
    assert sdof["turns"] is True
    assert sdof["held"]["peak"] == pytest.approx(0.321, abs=1e-3)
    assert sdof["other"]["peak"] == pytest.approx(-0.105, abs=1e-3)
    assert found[0]["limit"]["held"]["peak"] == pytest.approx(0.0635, abs=1e-3)
    assert found[0]["turning"] == ["sdof", "two_modes"]


def test_check_says_what_is_held_where_it_compares_fidelities(tmp_path: Path) -> None:
    expected = """
[expect.sdof]
fidelity = "sdof"
against = "beam"
quantity = "amplitude"
frequency = "15.3 Hz"
value = "-10 %"
tolerance = "50 %"
"""
    file = tmp_path / "rig.toml"
    settings = [word for each in SHORT[:-1] for word in ("--set", each)]
    file.write_text(RIG.read_text(encoding="utf-8").split("[reference")[0] + expected, encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(file), *settings])
    assert result.stdout.splitlines()[0] == "Held: R₁ = 0.72 of mode 1."
    alone = file.read_text(encoding="utf-8").replace('against = "beam"\n', "").replace('"-10 %"', '"0.394 mm"')
    file.write_text(alone, encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(file), *settings])
    assert result.exit_code == 0, result.output
    assert "Held" not in result.stdout


def test_an_accuracy_says_which_fidelity_is_taken_with_its_estimate_and_the_others_with_theirs() -> None:
    lines = vibeam_run("--set", "accuracy=6 %").stdout.splitlines()
    assert lines[0].startswith("Taken is beam, 5.")
    assert lines[0].endswith("the cheapest fidelity within 6 % of the full model (64 modes) in amplitude.")
    assert lines[1].startswith("Refused: sdof, 41.")
    assert TURNS in lines
    assert any(line.startswith("beam is off its own limit by +6") for line in lines)  # the full model is off it too
    refused = vibeam_run("--set", "accuracy=1 %", code=2)
    assert "the nearest is beam, 5." in refused.stderr
    assert "add a fidelity with more modes, or allow more than 5." in refused.stderr
