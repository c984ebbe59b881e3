"""Commands with a record case: what takes it answers, whatever cannot says so in one sentence with its line."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from vibeam.cli.main import app

TRUCK = Path(__file__).parents[3] / "cases" / "inputs" / "truck.toml"
CASE = """[sdof]
natural_frequency = "1 rad/s"
damping_ratio = 0.02
[stop]
gap = 0.5
restitution = 0.8
[drive]
shape = "half_sine"
acceleration = 2
duration = "3 s"
[record]
duration = "20 s"
[fidelity.exact]
"""
OF_A_SWEEP = "record: takes the place of [sweep], and what is asked for goes over drive frequencies"


@pytest.fixture
def shock(tmp_path: Path) -> Path:
    file = tmp_path / "shock.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


@pytest.mark.parametrize("said", [("explore",), ("study", "cost"), ("check", "--write")])
def test_whatever_goes_over_frequencies_says_so(shock: Path, said: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, [*said, str(shock)])
    assert done.exit_code == 2
    assert f"{shock}:11: {OF_A_SWEEP}" in done.stderr.replace("\n", " ")
    assert len(done.stderr.strip().splitlines()) == 1
    assert not done.stdout


def test_modes_are_counted_over_frequencies_alone() -> None:
    done = CliRunner().invoke(app, ["study", "modes_needed", str(TRUCK)])
    assert done.exit_code == 2
    assert OF_A_SWEEP in done.stderr.replace("\n", " ")


def test_a_case_with_nothing_to_check_is_sound(shock: Path) -> None:
    done = CliRunner().invoke(app, ["check", str(shock)])
    assert (done.exit_code, done.stdout.startswith("The case is sound")) == (0, True)
