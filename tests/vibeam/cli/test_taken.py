"""What commands say of the measured files that they read, and the stretch and the start that they take of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app

CASE = """[beam]
length = "180 mm"
width = "20 mm"
thickness = "1 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.01
[stop]
position = "180 mm"
gap = "1 mm"
restitution = 0.7
[sensor]
position = "180 mm"
[drive]
file = "shock.csv"
[record]
duration = "0.1 s"
[fidelity.one]
reduction = "modal"
modes = 1
[fidelity.two]
reduction = "modal"
modes = 2
"""
AT = np.arange(201) / 10_000
SHOCK = -300 * np.sin(np.pi * AT / AT[-1])


def run(*said: object) -> Any:
    return CliRunner().invoke(app, [str(each) for each in said])


def rig(folder: Path, start: float = 0.0, unit: str = "m/s^2") -> Path:
    rows = (f"{start + at:.4f},{value:.6f}\n" for at, value in zip(AT, SHOCK, strict=True))
    (folder / "shock.csv").write_text(f"#time,accel_x [{unit}]\n" + "".join(rows))
    (folder / "rig.toml").write_text(CASE)
    return folder / "rig.toml"


def impacts(file: Path, folder: Path, *said: str) -> Any:
    done = run("run", file, "--fresh", "--json", "--out", folder / "r.h5", *said)
    assert done.exit_code == 0, done.stderr
    return json.loads(done.stdout)["answer"]


LINE = (
    "shock.csv: taken: column 2 'accel_x', m/s^2, column 1 'time', s (no unit in the file: taken so), 10 000 Hz from "
)


def test_a_line_on_stderr_once_a_file_and_in_json(tmp_path: Path) -> None:
    file = rig(tmp_path)
    done = run("run", file, "--fresh", "--out", tmp_path / "r.h5")
    assert done.stderr.count("taken: ") == 1
    assert f"{LINE}0 s\n" in done.stderr
    assert "taken: " not in run("run", file, "--fresh", "--out", tmp_path / "r.h5", "-q").stderr
    found = json.loads(run("run", file, "--fresh", "--out", tmp_path / "r.h5", "--json").stdout)["taken"]
    assert [(each["file"], each["samples"], each["columns"][0]["unit"]) for each in found] == [
        ("shock.csv", 201, "m/s^2")
    ]


def test_a_recorders_clock_begins_at_the_first_sample(tmp_path: Path) -> None:
    """Printers count from when they were switched on, oscilloscopes from the trigger."""
    expected = impacts(rig(tmp_path), tmp_path)
    for start, said in ((9000.0, "9 000 s, which is taken as 0"), (-0.004, "-0.004 s, which is taken as 0")):
        file = rig(tmp_path, start)
        assert impacts(file, tmp_path) == expected
        assert f"{LINE}{said}" in run("run", file, "--fresh", "--out", tmp_path / "r.h5").stderr
    late = impacts(rig(tmp_path, 0.05), tmp_path, "--set", 'drive.start="0.05 s"')
    assert late == expected
    told = run("run", rig(tmp_path, 9000.0), "--fresh", "--set", 'drive.start="0 s"', "--out", tmp_path / "r.h5").stderr
    assert "the input begins at 9000 s, when the motion is over: say drive.start or record.duration" in told


def test_keys_of_a_start_and_of_a_stretch(tmp_path: Path) -> None:
    def record(**keys: Any) -> vibeam.Record:
        return vibeam.load(rig(tmp_path, 9000.0), {f"drive.{name}": value for name, value in keys.items()}).input("one")

    assert (record().start, record(start="9000.004 s").start) == (0.0, pytest.approx(-0.004))
    cut = record(**{"from": "9000.005 s", "to": "9000.015 s", "start": "first sample"})
    assert (cut.start, cut.duration) == (0.0, pytest.approx(0.01, rel=1e-9))
    assert cut.at(0.005) == pytest.approx(SHOCK[100], rel=1e-6)
    assert vibeam.load(rig(tmp_path, 9000.0), {"record": {}}).record.duration == pytest.approx(0.02)
    for keys, message in (({"start": "x"}, "'x' is not a number with a unit"), ({"from": "1 Hz"}, "not a time"),
                          ({"from": "1 s", "to": "2 s"}, "its clock goes from 9000 to 9000.02 s")):  # fmt: skip
        with pytest.raises(vibeam.CaseError, match=message):
            record(**keys)


@pytest.fixture
def decay(tmp_path: Path) -> Path:
    """Held for 0.5 s, then let go at 20 Hz with 2 % damping."""
    at = np.arange(3000) / 1000
    free = np.exp(-0.02 * 40 * np.pi * (at - 0.5)) * np.cos(40 * np.pi * (at - 0.5))
    rows = (f"{1e3 * t:.1f},{x:.9f}\n" for t, x in zip(at, np.where(at < 0.5, 1.0, free), strict=True))
    (tmp_path / "decay.csv").write_text("t [ms],x [mm]\n" + "".join(rows))
    return tmp_path / "decay.csv"


@pytest.mark.parametrize("ends", [("--from", "500 ms"), ("--from", "0.5"), ("--from", "0.5 s", "--to", "2500 ms")])
def test_a_stretch_of_a_signal_is_fitted(decay: Path, ends: tuple[str, ...]) -> None:
    done = run("fit", decay, "--json", *ends)
    rows = {each["name"]: each["value"] for each in json.loads(done.stdout)["rows"]}
    assert rows["damping ratio"] == pytest.approx(0.02, rel=1e-3)
    assert f"{500 if len(ends) == 2 else 999} of 3000 points left out by --from and --to" in done.stderr


@pytest.mark.parametrize(
    ("ends", "message"),
    [(("--from", "1 Hz"), "--from in Hz, and it is a decay: say another unit"), (("--from", "9 s"), "nothing lies from 9"),
     (("--to", "x"), "'x' is not a number with a unit"), (("--from", "50 %"), "is a plain number, not a time")],
)  # fmt: skip
def test_a_stretch_that_is_none_says_why(decay: Path, ends: tuple[str, ...], message: str) -> None:
    done = run("fit", decay, *ends)
    assert done.exit_code == 2
    assert message in done.stderr
