"""Completion by the shell of what options and arguments may hold, as bash asks for it."""

from __future__ import annotations

from pathlib import Path

import pytest
from stand_in import RIG
from typer.testing import CliRunner

from vibeam.cli.main import app

FIG18 = RIG.parent / "maps" / "fig18.toml"


def completed(*words: str) -> list[str]:
    """Words that the shell offers for the last one."""
    typed = {
        "_VIBEAM_COMPLETE": "complete_bash",
        "COMP_WORDS": " ".join(("vibeam", *words)),
        "COMP_CWORD": str(len(words)),
    }
    return CliRunner().invoke(app, [], prog_name="vibeam", env=typed).stdout.split()


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (("map", "x.toml", "--picture", "s"), ["stability"]),
        (("map", "x.toml", "--quantity", "im"), ["impacts_per_period", "impact_velocity"]),
        (("map", "x.toml", "--over", "stop.ga"), ["stop.gap", "stop.gap_at"]),
        (("map", "x.toml", "--from", ""), []),
        (("verdict", "x.toml", "--only", "s"), ["solvers", "solid"]),
        (("study", "verdict", "x.toml", "--only", "mo"), ["modes"]),
        (("study", "ve"), ["verdict"]),
        (("new", "--from", "tu"), ["tube", "tube-noise"]),
        (("fit", "x.csv", "--of", "d"), ["decay"]),
        (("fit", "x.toml", "--key", "stop.gap_"), ["stop.gap_at"]),
        (("run", "x.toml", "--set", "stop.gap_"), ["stop.gap_at="]),
        (("run", str(RIG), "--fidelity", ""), ["sdof", "two_modes", "beam"]),
        (("modes", str(RIG), "--fidelity", "t"), ["two_modes"]),
        (("check", str(RIG), "-q", "--fidelity", "b"), ["beam"]),
        (("map", str(FIG18), ""), ["period"]),
        (("keys", "stop.gap"), ["stop.gap", "stop.gap_at"]),
    ],
)
def test_values_are_completed(words: tuple[str, ...], offered: list[str]) -> None:
    assert completed(*words) == offered


@pytest.mark.parametrize("text", [None, "", "[fidelity", "fidelity = 3\n", "[sweep]\n"])
def test_a_case_that_cannot_be_read_offers_nothing(tmp_path: Path, text: str | None) -> None:
    case = tmp_path / "case.toml"
    if text is not None:
        case.write_text(text, encoding="utf-8")
    assert completed("run", str(case), "--fidelity", "") == []
