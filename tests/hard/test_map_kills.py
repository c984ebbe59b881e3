"""A few maps killed and continued; that the check can fail."""

from __future__ import annotations

from pathlib import Path

import h5py
import map_kills
import pytest


def nothing(stage: str) -> None:
    """Nobody listens."""


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    case = map_kills.CASE.replace("points = 100", "points = 12").replace("settle = 200", "settle = 60")
    monkeypatch.setattr(map_kills, "CASE", case)
    monkeypatch.setattr(map_kills, "NAMES", ("plane",))
    map_kills.undisturbed.cache_clear()


def test_a_map_that_is_killed_goes_on_where_it_was() -> None:
    """Once, after some of its blocks; ``torture.py map_kills`` kills up to three times."""
    assert map_kills.judge(2, 11, nothing).findings == []


@pytest.mark.slow
def test_other_numbers_are_seen(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(map_kills.CASE, encoding="utf-8")
    assert map_kills.completed("plane", tmp_path, False) == ""
    with h5py.File(tmp_path / "rig_plane.h5", "r+") as file:
        file["sdof/amplitude"][0, 0, 0] += 1e-9
    assert "1 data differ: sdof/amplitude" in map_kills.completed("plane", tmp_path, False)
