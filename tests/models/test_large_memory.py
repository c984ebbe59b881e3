"""Memory of 2 GiB or more is refused before it is taken, and taken where that was confirmed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.runs.transient import memory as of_runs
from vibeam_models import memory
from vibeam_models.memory import LARGE, check_room, large_memory

CASE: dict[str, Any] = {
    "sdof": {"natural_frequency": "1 rad/s", "damping_ratio": 0.02},
    "stop": {"gap": 1, "restitution": 0.7},
    "drive": {"shape": "half_sine", "acceleration": 2.0, "duration": "3 s"},
    "record": {"duration": "30 s"},
    "fidelity": {"one": {}},
}


@pytest.fixture(autouse=True)
def _much_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_bytes", lambda: 1e15)


def test_what_is_large_is_confirmed() -> None:
    check_room("a mesh", LARGE - 1, "take a coarser one")
    with pytest.raises(ValueError, match=r"a mesh: needs 2\.1 GB of memory: take a coarser one, or go on: --yes"):
        check_room("a mesh", LARGE, "take a coarser one")
    with large_memory():
        check_room("a mesh", LARGE, "take a coarser one")
    with pytest.raises(ValueError, match="--yes"):
        check_room("a mesh", LARGE, "take a coarser one")


def test_what_does_not_fit_is_refused_though_it_was_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_bytes", lambda: 1e9)
    with large_memory(), pytest.raises(ValueError, match="1 GB are free: take a coarser one"):
        check_room("a mesh", LARGE, "take a coarser one")


def test_a_run_with_histories_of_millions_of_bins_is_refused_before_it_begins(tmp_path: Path) -> None:
    case = vibeam.Case.of(CASE | {"record": {"duration": "3000 s", "rate": "5 kHz"}})
    with pytest.raises(vibeam.CaseError, match=r"1 motion under .* needs \d\.\d GB of memory.*record\.rate"):
        vibeam.run(case, out=tmp_path / "run.h5")
    assert not list(tmp_path.glob("*.h5"))


def test_a_small_run_needs_no_confirmation(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[float] = []
    monkeypatch.setattr(of_runs, "check_room", lambda what, needed, cure: seen.append(needed))
    vibeam.run(vibeam.Case.of(CASE))
    assert seen
    assert max(seen) < 1e8


@pytest.mark.extension
def test_a_fit_to_millions_of_points_is_refused() -> None:
    time = np.broadcast_to(0.0, (7_000_000,))
    with pytest.raises(ValueError, match=r"a fit to 7000000 points: needs 8\.4 GB of memory"):
        vibeam.identify_decay(time, time)
