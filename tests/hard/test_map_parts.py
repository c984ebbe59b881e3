"""Maps in parts, by the command: the file of one process to the bit, prices, what is asked for wrongly, signals."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from commands import BEAM, Run, data_of, usual_environment, vibeam

MAP = """[map.plane]
fidelities = ["sdof"]
axes = [
  { key = "drive.voltage", from = "0.2 V", to = "0.7 V", points = 40 },
  { key = "sweep.frequency", from = "14 Hz", to = "17 Hz", points = 20 },
]
direction = "both"
settle = 200
hold = 16
"""


def of(folder: Path, *more: str) -> Run:
    return vibeam(["--load", "small_blocks", "map", "rig.toml", "plane", *more], folder)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rig.toml").write_text(BEAM + MAP, encoding="utf-8")
    return tmp_path


def test_parts_gather_to_the_file_of_one_process(folder: Path) -> None:
    assert of(folder, "--out", "one.h5").code == 0
    ran = of(folder, "--out", "two.h5", "--part", "2/3")
    assert (ran.code, "when all parts are: vibeam --load small_blocks map rig.toml" in ran.out) == (0, True)
    ran = of(folder, "--out", "two.h5", "--gather")
    assert ran.code == 2
    assert "steps are not there, in the files 1, 3 to 4" in ran.err
    for part in "1/3", "3/3":
        assert of(folder, "--out", "two.h5", "--part", part).code == 0
    ran = of(folder, "--out", "two.h5", "--gather")
    assert (ran.code, "wrote two.h5, two.svg" in ran.out) == (0, True)
    assert data_of(folder / "one.h5") == data_of(folder / "two.h5")
    assert (folder / "one.svg").read_bytes() == (folder / "two.svg").read_bytes()
    assert not (folder / "two.h5.parts").exists()
    assert "its 1600 points are there, 1600 were before" in of(folder, "--out", "two.h5", "--part", "1/3").out


def test_what_excludes_each_other_and_is_no_part_is_refused(folder: Path) -> None:
    for words, said in (
        (["--part", "4/3"], "--part: '4/3' is no part"), (["--part", "1/3", "--gather"], "--part and --gather exclude"),
        (["--price", "--fresh"], "--price and --fresh exclude"), (["--part", "1/2", "--cluster", "s"], "--part and"),
    ):  # fmt: skip
        ran = of(folder, *words)
        assert (ran.code, said in ran.err) == (2, True), ran.err
    assert [path.name for path in folder.iterdir()] == ["rig.toml"]


def test_a_price_names_cost_and_lines(folder: Path) -> None:
    ran = of(folder, "--price", "--json")
    assert ran.code == 0, ran.err
    found = json.loads(ran.out)["maps"][0]
    assert found["points"] == 1600
    assert found["parts"] == 1
    assert "--array=1-1" in found["lines"]["slurm"]
    assert found["lines"]["gather"].endswith("--gather")


@pytest.mark.parametrize(("by", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_ends_a_part_with_its_work_kept(folder: Path, by: int, code: int) -> None:
    (folder / "rig.toml").write_text(BEAM + MAP.replace("points = 40", "points = 600"), encoding="utf-8")
    words = ["--load", "small_blocks", "map", "rig.toml", "plane", "--part", "1/2"]
    process = subprocess.Popen(
        [sys.executable, "-m", "vibeam", *words], cwd=folder, env=usual_environment(), stderr=subprocess.PIPE, text=True
    )
    file = folder / "rig_plane.h5.parts" / "00001.steps"
    deadline = time.monotonic() + 120
    while not file.exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(by)
    _, said = process.communicate()
    assert process.returncode == code
    assert "points are kept: the same command goes on with the rest" in said
    assert file.stat().st_size > 0
