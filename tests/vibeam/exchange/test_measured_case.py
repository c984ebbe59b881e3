"""Files of ``cases/measured``: what was put into them is found, and the case takes the modes that are found."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.cli.main import main

FOLDER = Path(__file__).parents[3] / "cases" / "measured"
MADE = runpy.run_path(str(FOLDER / "make_files.py"))


def fitted(name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> tuple[str, str]:
    """What ``vibeam fit`` prints of a file, and what it says it took."""
    monkeypatch.setattr("sys.argv", ["vibeam", "fit", str(FOLDER / name), "-v"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    found = capsys.readouterr()
    return found.out, found.err


def test_modes_of_the_hammer_test_are_those_that_it_was_made_of(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    out, told = fitted("hammer.csv", capsys, monkeypatch)
    assert "g/N (from the row below the heads)" in told
    for line in (FOLDER / "reed.toml").read_text(encoding="utf-8").splitlines():
        if line.startswith(("modal_mass", "frequency", "damping_ratio")):
            assert line in out


def test_the_decay_is_taken_from_its_release(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    out, told = fitted("decay.lvm", capsys, monkeypatch)
    assert "mm (from Y_Unit_Label)" in told
    assert "from 0 s on" in out


def test_the_record_begins_at_its_first_sample() -> None:
    drive = vibeam.record_of_file(FOLDER / "table.lvm", start="first sample")
    assert drive.start == 0.0
    at = np.arange(101, 115) / 2000
    pulse = 30 * np.sin(np.pi * (at - 0.05) / 8e-3)
    assert drive.at(at) == pytest.approx(pulse, abs=1e-4)


def test_numbers_of_the_hammer_test_are_within_its_noise() -> None:
    table = np.loadtxt(FOLDER / "hammer.csv", delimiter=",", skiprows=3)
    responses = MADE["GRAVITY"] * np.stack([table[:, 1] + 1j * table[:, 2], table[:, 3] + 1j * table[:, 4]])
    found = vibeam.identify_frequency_response(table[:, 0], responses, of="accelerance")
    assert len(found.rows) == 6
    for k, (frequency, ratio) in enumerate(zip(MADE["FREQUENCY"], MADE["RATIO"], strict=True), 1):
        assert found[f"natural frequency {k}"].value == pytest.approx(frequency, rel=1e-4)
        assert found[f"damping ratio {k}"].value == pytest.approx(ratio, rel=0.02)
