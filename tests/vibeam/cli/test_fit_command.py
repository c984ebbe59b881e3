"""``vibeam fit``: what it prints and writes, what the data cannot separate, what to measure next, mistakes."""

from __future__ import annotations

import csv
import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app

pytestmark = pytest.mark.usefixtures("undrawn")

CASES = Path(__file__).parents[3] / "cases"

EXACT = CASES / "references" / "dtu_neutral_sdof.csv"  # by Taylor series, 30 digits; made with the values below

GAIN, RESTITUTION = 5.16e-4, 0.72

TABLES = """
[fidelity.sdof]
reduction = "static_mode"

[reference.sheet]
file = "sheet.csv"
columns = { frequency = "Frequenz", amplitude = "Weg" }
uncertainty = "0.5 %"
fidelity = "sdof"
quantity = "amplitude"
measured = true

[fit]
references = ["sheet"]

[fit.keys]
"drive.gain" = ["3e-4 1/V", "9e-4 1/V"]
"stop.restitution" = [0.5, 0.9]
"""


def fit(*words: str | Path, code: int = 0) -> Any:
    done = CliRunner().invoke(app, ["fit", *map(str, words)])
    assert done.exit_code == code, done.output
    return done


def sheet(file: Path, frequencies: tuple[float, ...]) -> None:
    """Points of the reference as a spreadsheet with decimal commas writes them, alternately 0.4 % high and low."""
    lines = [line for line in EXACT.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    rows = [row for row in csv.DictReader(lines) if row["direction"] == "up"]
    kept = [row for row in rows if float(row["frequency_hz"]) in frequencies]
    assert len(kept) == len(frequencies)
    values = [1e3 * float(row["amplitude"]) * (1 + 0.004 * (-1) ** k) for k, row in enumerate(kept)]
    text = [f"{row['frequency_hz']};{value:.6f}" for row, value in zip(kept, values, strict=True)]
    file.write_text("\n".join(["Frequenz [Hz];Weg [mm]", *text]).replace(".", ",") + "\n", encoding="utf-8")


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """The neutral rig with one mode, from another gain, and a spreadsheet beside it."""
    text = (CASES / "synthetic" / "fit.toml").read_text(encoding="utf-8")
    text = text[: text.index("[fidelity.beam]")].replace("damping_ratio = 0.02", "damping_ratio = 0.017")
    file = tmp_path / "rig.toml"
    file.write_text(text.replace("gap =", "  gap  =") + TABLES, encoding="utf-8")
    sheet(tmp_path / "sheet.csv", (14.25, 14.75, 15.0, 15.25, 15.5, 16.0, 16.5, 17.0))
    return file


def test_values_intervals_and_files(rig: Path) -> None:
    """Printed table, CSV and figure; the case with the estimates in it, which loads and is otherwise the old one."""
    written = rig.parent / "fitted.toml"
    said = fit(rig, "--out", rig.parent / "found.csv", "--write", written, "--next").stdout
    assert "Estimated keys\n" in said
    assert said.startswith("drive.gain 0.0005158 1/V (± 0.")
    assert "describe the 8 points (± at 95 %; rms residual 0." in said.splitlines()[0]
    assert said.splitlines()[0].endswith("of their uncertainty); stop.restitution is R₁ of mode 1.")
    assert "\nNext: " in said
    assert "What to measure next" in said
    rows = {row["key"]: row for row in csv.DictReader((rig.parent / "found.csv").read_text().splitlines())}
    assert list(rows) == ["drive.gain", "stop.restitution"]
    for (key, row), truth in zip(rows.items(), (GAIN, RESTITUTION), strict=True):
        assert float(row["low"]) < truth < float(row["high"])
        assert float(row["high"]) - float(row["low"]) < 0.03 * truth
        assert key in said
        assert f"{float(row['value']):.5g}" in said
    assert (rig.parent / "found.png").read_bytes().startswith(b"\x89PNG")
    old, new = (tomllib.loads(file.read_text(encoding="utf-8")) for file in (rig, written))
    assert new["drive"].pop("gain") == f"{float(rows['drive.gain']['value']):.6g} 1/V"
    assert new["stop"].pop("restitution") == float(f"{float(rows['stop.restitution']['value']):.6g}")
    del old["drive"]["gain"], old["stop"]["restitution"]
    assert new == old
    assert vibeam.load(written).scene.stop.restitution == pytest.approx(RESTITUTION, rel=0.01)
    assert written.read_text().count("#") == rig.read_text().count("#") + 1
    assert "is there already: name another file" in fit(rig, "--write", written, code=2).output


def test_what_one_point_cannot_separate(rig: Path) -> None:
    """At the peak gain and restitution make up for each other: no value, one sentence, in JSON too."""
    sheet(rig.parent / "sheet.csv", (15.25,))
    found = json.loads(fit(rig, "--json", "--out", rig.parent / "found.csv").stdout)
    assert [row["value"] for row in found["rows"]] == [None, None]
    assert [row["determined"] for row in found["rows"]] == [False, False]
    assert found["answer"].startswith(
        "The 1 point cannot separate drive.gain and stop.restitution within the bounds: what "
    )
    (told,) = (line for line in found["sentences"] if "not separated" in line)
    assert told.startswith("drive.gain and stop.restitution are not separated by these points within the bounds")
    assert any("what they share is drive.gain/(ζ₁ − ln R₁/π) = " in line for line in found["sentences"])


def test_a_bad_table_tells_all_faults_with_line_key_and_cure(rig: Path) -> None:
    text = rig.read_text(encoding="utf-8")
    changes = {
        'references = ["sheet"]': 'references = ["shet"]',
        '"drive.gain" = ["3e-4 1/V", "9e-4 1/V"]': '"drive.gian" = ["3e-4 1/V", "9e-4 1/V"]',
        '"stop.restitution" = [0.5, 0.9]': '"stop.restitution" = [0.5, 1.9]\n"beam.elements" = [2, 5]',
    }
    for old, new in changes.items():
        text = text.replace(old, new)
    rig.write_text(text, encoding="utf-8")
    lines = [line.strip() for line in text.splitlines()]
    told = fit(rig, code=2).output.splitlines()
    for begin, key, cure in (
        ("references", "fit.references", "did you mean 'sheet'?"),
        ('"drive.gian"', 'fit.keys."drive.gian"', "did you mean 'gain'?"),
        ('"stop.restitution"', 'fit.keys."stop.restitution"', "outside [0, 1]"),
        ('"beam.elements"', 'fit.keys."beam.elements"', "no single number"),
    ):
        number = next(k for k, line in enumerate(lines, 1) if line.startswith(begin) and k > lines.index("[fit]"))
        (said,) = (line for line in told if key in line)
        assert said.startswith(f"{rig}:{number}: ")
        assert cure in said


def test_a_file_that_cannot_be_written_is_refused_before_anything_is_computed(rig: Path, tmp_path: Path) -> None:
    for words, said in (
        (("--write", tmp_path / "other" / "fitted.toml"), "--write names a file beside the case"),
        (("--write", rig.parent / "fitted.txt"), "which ends in .toml"),
        (("--write", rig.parent / "fitted.toml", "--set", "drive.gain=5e-4 1/V"), "is written without --set"),
    ):
        done = fit(rig, *words, code=2)
        assert said in done.output
        assert "Least squares" not in done.output


def test_a_case_without_the_table_says_what_to_write(rig: Path) -> None:
    text = rig.read_text(encoding="utf-8")
    rig.write_text(text[: text.index("[fit]")], encoding="utf-8")
    assert "there is no [fit] in this case: say keys = " in fit(rig, code=2).output
