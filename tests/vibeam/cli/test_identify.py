"""``vibeam identify``: of signals in files and of cases; mistakes are one message."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from vibeam.cli.main import app

CASE = Path(__file__).parents[3] / "cases" / "synthetic" / "modes.toml"


def identify(*words: str | Path, code: int = 0) -> Any:
    done = CliRunner().invoke(app, ["identify", *map(str, words)])
    assert done.exit_code == code, done.output
    return done


@pytest.fixture
def decay(tmp_path: Path) -> Path:
    """A decay of 7.6 Hz and 1.7 % in milliseconds and micrometres, as a spreadsheet with decimal commas has it."""
    time, omega = np.linspace(0, 3, 600), 2 * pi * 7.6
    x = np.exp(-0.017 * omega * time) * np.cos(omega * sqrt(1 - 0.017**2) * time)
    rows = [f"{1e3 * t:.9f};{1e3 * each:.9f}".replace(".", ",") for t, each in zip(time, x, strict=True)]
    file = tmp_path / "decay.csv"
    file.write_text("Zeit [ms];Weg [µm]\n" + "\n".join(rows) + "\n", encoding="cp1252")
    return file


def test_a_decay_in_a_file(decay: Path) -> None:
    found = json.loads(identify(decay, "--of", "decay", "--x", "Zeit", "--y", "2", "--json").stdout)
    frequency, ratio = found["rows"]
    assert frequency["value"] == pytest.approx(7.6, rel=1e-6)
    assert ratio["value"] == pytest.approx(0.017, rel=1e-5)
    out = decay.parent / "table.csv"
    said = identify(decay, "--of", "decay", "--x", "1", "--y", "Weg", "--out", out).output
    assert "the slope of the envelope alone gives a damping ratio of 0.017" in said
    assert out.read_text(encoding="utf-8").startswith("name,value,low,high,unit,determined")


def test_keys_of_a_case() -> None:
    """The synthetic frequencies are those of another section, inertia and rigid zone: they come back."""
    words = [
        word for key in ("beam.thickness", "mass.rotary_inertia", "mass.rigid_half_width") for word in ("--key", key)
    ]
    rows = json.loads(identify(CASE, *words, "--json").stdout)["rows"]
    assert [row["value"] for row in rows] == pytest.approx([1.034e-3, 2.988e-5, 11.7e-3], rel=1e-3)
    assert all(row["low"] < row["value"] < row["high"] for row in rows)


def test_mistakes_are_told(decay: Path) -> None:
    for words, said in (
        ((decay,), "which it is, --of decay, spectrum or response"),
        ((decay, "--of", "deca"), "--of deca: did you mean 'decay'?"),
        ((decay, "--of", "decay"), "there are 'Zeit [ms]', 'Weg [µm]'; name them: --x HEAD --y HEAD"),
        ((decay, "--of", "spectrum", "--x", "Zeit", "--y", "Weg"), "column 'Zeit': the unit 'ms' is not one of Hz"),
        ((decay, "--of", "decay", "--key", "beam.length"), "are of a case (.toml)"),
        ((CASE, "--of", "decay"), "is of a signal, and"),
        ((CASE,), "no key to identify: name one, such as beam.thickness"),
        ((CASE, "--key", "beam.thicknes"), "beam.thicknes is not in the case"),
        ((CASE.with_name("none.csv"), "--of", "decay"), "no such file"),
    ):
        assert said in identify(*words, code=2).output
