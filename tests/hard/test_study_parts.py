"""Ensembles, realisations, maps of records and fits in parts, by the commands: to the bit what one process answers."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from commands import BEAM, usual_environment, vibeam

from vibeam.studies.stored import read

SYNTHETIC = Path(__file__).parents[2] / "cases" / "synthetic"
SWEPT = BEAM.replace("points = 61", "points = 9") + '[uncertain]\n"stop.restitution" = "± 0.02"\n'
RECORD = """[record]
duration = "100 ms"
realisations = 2
values = [0.5, 1]
"""
SWEEP = SWEPT[SWEPT.index("[sweep]") : SWEPT.index("[fidelity.beam]")]
NOISE = 'density = [["5 Hz", "0.01 g^2/Hz"], ["200 Hz", "0.01 g^2/Hz"]]\nseed = 3'
SHAKEN = SWEPT.replace('voltage = "0.6 V"\ngain = "5.16e-4 1/V"', NOISE).replace(SWEEP, RECORD)
TIMES = ("seconds", "cpu_seconds", "reading_seconds", "files")  # and what follows from times


def answer(words: list[str], folder: Path) -> dict[str, Any]:
    """Object of a command, without times and what follows from them."""
    ran = vibeam([*words, "--json"], folder)
    assert ran.code == 0, ran.err
    found: dict[str, Any] = json.loads(ran.out, object_pairs_hook=lambda pairs: {
        key: value for key, value in pairs if key not in TIMES
    })  # fmt: skip
    return {key: value for key, value in found.items() if key not in ("answer", "notes", "sentences", "found")}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rig.toml").write_text(SWEPT, encoding="utf-8")
    (tmp_path / "shaken.toml").write_text(SHAKEN, encoding="utf-8")
    for name in "linear_stop.toml", "linear_stop.csv":
        shutil.copy(SYNTHETIC / name, tmp_path)
    return tmp_path


UNCERTAIN = ["uncertainty", "rig.toml", "--samples", "16"]
MAP = ["map", "shaken.toml", "--over", "gap,level", "--from", "0 mm,0.5", "--to", "1 mm,2", "--points", "3,2"]


@pytest.mark.parametrize(
    ("words", "out", "rounds", "counts"),
    [
        (UNCERTAIN, "csv", ["1-sweeps"], ["sweeps", 48]),
        pytest.param(
            ["uncertainty", "shaken.toml", "--samples", "16"],
            "csv",
            ["1-motions"],
            ["motions", 98],
            marks=pytest.mark.slow,
        ),
        pytest.param(MAP, "csv", ["1-motions"], ["motions", 24], marks=pytest.mark.slow),
        pytest.param(
            ["fit", "linear_stop.toml"],
            "csv",
            ["1-starts", "2-profiles"],
            ["starts", 49, "profiles", 3],
            marks=pytest.mark.slow,
        ),
        (["run", "shaken.toml"], "h5", ["1-motions", "2-twins"], ["motions", 8, "twins", 2]),
    ],
    ids=["ensemble", "ensemble under a record", "map of a record", "fit", "realisations"],
)
def test_parts_gather_to_the_answer_of_one_process(
    folder: Path, words: list[str], out: str, rounds: list[str], counts: list[Any]
) -> None:
    one = answer([*words, "--out", f"one.{out}"], folder)
    taken = dict.fromkeys(rounds, 0)
    for name in rounds:
        for part in "2/2", "1/2":
            taken[name] += answer([*words, "--out", f"two.{out}", "--part", part], folder)["points"]
            assert (folder / f"two.{out}.{name}.parts").exists()
            if name == "1-sweeps" and part == "2/2":
                ran = vibeam([*words, "--out", f"two.{out}", "--gather"], folder)
                assert ran.code == 2
                assert f"vibeam {words[0]} {words[1]}" in ran.err
                assert "steps are not there, in the files 1, 3, 5" in ran.err
    assert [value for pair in zip(counts[::2], taken.values(), strict=True) for value in pair] == counts
    assert answer([*words, "--out", f"two.{out}", "--gather"], folder) == one
    assert not list(folder.glob("*.parts"))
    if out == "h5":
        one_run, two = (read(folder / f"{name}.h5") for name in ("one", "two"))
        assert {name: one_run[name] for name in one_run} == {name: two[name] for name in two}
    else:
        assert (folder / "one.csv").read_bytes() == (folder / "two.csv").read_bytes()


def test_a_sweep_whose_points_follow_each_other_has_no_parts(folder: Path) -> None:
    for words in ["--price"], ["--part", "1/2"], ["--gather"]:
        ran = vibeam(["run", "rig.toml", *words], folder)
        assert (ran.code, "of a case with [record]" in ran.err) == (2, True), ran.err
    ran = vibeam(["fit", "linear_stop.csv", "--price"], folder)
    assert (ran.code, "--price is of a case" in ran.err) == (2, True), ran.err
    ran = vibeam(["run", "shaken.toml", "--part", "1/2", "--fresh"], folder)
    assert (ran.code, "--part and --fresh exclude each other" in ran.err) == (2, True), ran.err


@pytest.mark.parametrize("words", [UNCERTAIN, MAP, ["run", "shaken.toml"], ["fit", "linear_stop.toml"]])
def test_a_price_leaves_nothing_behind(folder: Path, words: list[str]) -> None:
    before = sorted(folder.iterdir())
    found = answer([*words, "--price"], folder)
    assert found["lines"]["gather"] == f"vibeam {subprocess.list2cmdline(words)} --json --gather".replace('"', "'")
    assert found["points"] in (48, 24, 8, 49)
    assert sorted(folder.iterdir()) == before


def killed(words: list[str], folder: Path, when: Callable[[], bool], by: int) -> int:
    """Exit code of a command that gets a signal as soon as something is so."""
    process = subprocess.Popen([sys.executable, "-m", "vibeam", *words], cwd=folder, env=usual_environment())
    deadline = time.monotonic() + 120
    while not when() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.005)
    process.send_signal(by)
    return process.wait()


@pytest.mark.parametrize(
    ("more", "by", "expected"),
    [
        ([], signal.SIGKILL, -9),
        pytest.param([], signal.SIGINT, 130, marks=pytest.mark.slow),
        pytest.param(["--part", "1/1"], signal.SIGTERM, 143, marks=pytest.mark.slow),
    ],
)
def test_an_ensemble_that_is_killed_goes_on(folder: Path, more: list[str], by: int, expected: int) -> None:
    text = SWEPT.replace("settle = 60", "settle = 2000")
    (folder / "rig.toml").write_text(text, encoding="utf-8")
    steps = folder / "two.csv.1-sweeps.parts"
    code = killed([*UNCERTAIN, "--out", "two.csv", *more], folder, lambda: len(list(steps.glob("*.steps"))) > 5, by)
    assert code == expected
    kept = {path.name: path.read_bytes() for path in steps.glob("*.steps")}
    assert 5 < len(kept) < 48
    ran = vibeam([*UNCERTAIN, "--out", "two.csv", "--part", "1/1"], folder)
    assert ran.code == 0, ran.err
    torn = [name for name, content in kept.items() if (steps / name).read_bytes() != content]
    assert len(torn) <= 2  # what was being written: one a thread
    two = answer([*UNCERTAIN, "--out", "two.csv"], folder)
    assert two == answer([*UNCERTAIN, "--out", "one.csv"], folder)
    assert (folder / "one.csv").read_bytes() == (folder / "two.csv").read_bytes()
    assert not steps.exists()


def test_an_ensemble_of_an_edited_case_keeps_what_was_begun_aside(folder: Path) -> None:
    assert vibeam([*UNCERTAIN, "--part", "1/2"], folder).code == 0
    (folder / "rig.toml").write_text(SWEPT.replace("0.02", "0.03"), encoding="utf-8")
    ran = vibeam([*UNCERTAIN, "--part", "1/2"], folder)
    assert (ran.code, "holds steps of another case, or of this one before it was changed" in ran.err) == (2, True)
    ran = vibeam(UNCERTAIN, folder)
    assert ran.code == 0
    assert "kept aside as rig_uncertainty.csv.1.1-sweeps.parts" in ran.err
    assert [path.name for path in folder.glob("*.parts")] == ["rig_uncertainty.csv.1.1-sweeps.parts"]
