"""``vibeam fit`` of signals in files and of modal frequencies; mistakes are one message."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app

CASE = Path(__file__).parents[4] / "cases" / "synthetic" / "modes.toml"


def fit(*words: str | Path, code: int = 0) -> Any:
    done = CliRunner().invoke(app, ["fit", *map(str, words)])
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
    """Found out to be one."""
    found = json.loads(fit(decay, "--json").stdout)
    frequency, ratio = found["rows"]
    assert frequency["value"] == pytest.approx(7.6, rel=1e-6)
    assert ratio["value"] == pytest.approx(0.017, rel=1e-5)
    assert (found["of"], found["why"].partition(",")[0]) == ("decay", "'Zeit' is in ms")
    assert json.loads(fit(decay, "--of", "decay", "--x", "Zeit", "--y", "2", "--json").stdout)["rows"] == found["rows"]
    out = decay.parent / "table.csv"
    said = fit(decay, "--x", "1", "--y", "Weg", "--out", out).output
    assert "the slope of the envelope alone gives a damping ratio of 0.017" in said
    assert out.read_text(encoding="utf-8").startswith("name,value,low,high,unit,determined")
    fit(decay, "--out", out.with_suffix(".html"))
    assert "taken as a decay" in out.with_suffix(".html").read_text(encoding="utf-8")


def test_the_answer_of_a_signal(decay: Path) -> None:
    """One sentence with values, what the file was taken as and why; few lines of 100 characters."""
    first, *lines = fit(decay).stdout.splitlines()
    assert first.startswith("Natural frequency 7.6 Hz (± ")
    assert "describe the 600 points of the decay (± at 95 %; rms residual " in first
    assert first.endswith("taken as a decay, since 'Zeit' is in ms, its values swing about a middle and die away.")
    assert len(lines) < 12
    assert max(map(len, lines)) <= 100


def test_keys_of_a_case() -> None:
    """The synthetic frequencies are those of another section, inertia and rigid zone: they come back."""
    words = [
        word for key in ("beam.thickness", "mass.rotary_inertia", "mass.rigid_half_width") for word in ("--key", key)
    ]
    rows = json.loads(fit(CASE, *words, "--json").stdout)["rows"]
    assert [row["value"] for row in rows] == pytest.approx([1.034e-3, 2.988e-5, 11.7e-3], rel=1e-3)
    assert all(row["low"] < row["value"] < row["high"] for row in rows)
    assert fit(CASE, *words, "-q").stdout.startswith("beam.thickness 1.034 mm (± 0.12 %), mass.rotary_inertia ")


def test_mistakes_are_told(decay: Path) -> None:
    for words, *said in (
        ((decay, "--of", "deca"), "--of deca: did you mean 'decay'?"),
        ((decay, "--of", "spectrum", "--x", "Zeit", "--y", "Weg"), "column 'Zeit': the unit 'ms' is not one of Hz"),
        ((decay, "--x", "Weg", "--y", "Zeit"), "column 'Weg': the unit 'µm' is neither one of time nor one of"),
        ((decay, "--drive", "force"), "cannot tell what it is: 'Zeit' is in ms (of a decay), but"),
        ((CASE, "--of", "decay", "--x", "t"), "--of is of a signal, and this is a case", "--x is of a signal, and"),
        ((CASE, "--level", "0"), "--level is of a signal, and this is a case"),
        ((CASE,), "there is no [fit] in this case", "--key beam.thickness"),
        ((CASE, "--measured", "mode_1"), "--measured: name the keys that they give"),
        ((CASE, "--key", "beam.thicknes"), "beam.thicknes is not in the case"),
        ((CASE.with_name("none.csv"), "--of", "decay"), "no such file"),
    ):  # fmt: skip
        for each in said:
            assert each in fit(*words, code=2).output


def test_all_options_in_vain_are_told_at_once(decay: Path) -> None:
    words = (decay, "--of", "decay", "--key", "beam.length", "--next", "--drive", "shove", "--level", "-1")
    told = fit(*words, code=2).output.splitlines()
    assert [line.removeprefix(f"{decay}: ").split(" ")[0] for line in told] == [
        "--next", "--key", "--drive", "--level", "--drive", "--level",
    ]  # fmt: skip


@pytest.mark.parametrize("size", [1e300, 1e-300, 1e61, 1e-61])
@pytest.mark.parametrize("head", ["time (s),x (m)", "frequency (Hz),amplitude (m)"])
def test_values_whose_squares_no_float_holds_are_refused_in_one_message(tmp_path: Path, size: float, head: str) -> None:
    file = tmp_path / "m.csv"
    rows = (f"{1 + 0.01 * i:.2f},{size * (1 + np.cos(i / 5)):.6g}" for i in range(200))
    file.write_text("\n".join((head, *rows)))
    done = CliRunner().invoke(app, ["fit", str(file)])
    assert (done.exit_code, done.stdout) == (2, "")
    assert "too large or too small; the largest lies between 1e-60 and 1e+60 in its unit" in done.stderr


def test_decays_and_responses_of_any_usual_unit_are_fitted_alike() -> None:
    time = np.linspace(0.0, 2.0, 2001)
    motion = np.exp(-0.5 * time) * np.cos(50.0 * time)
    found = [vibeam.identify_decay(time, size * motion).rows[0].value for size in (1.0, 1e-9, 1e-59, 1e59)]
    assert found == pytest.approx([50 / (2 * np.pi)] * 4, rel=1e-4)
    for size in (1e-61, 1e61):
        with pytest.raises(ValueError, match="the largest lies between"):
            vibeam.identify_decay(time, size * motion)
