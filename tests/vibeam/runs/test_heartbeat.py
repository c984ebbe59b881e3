"""Long work says how far it is, however long one piece of it takes."""

from __future__ import annotations

import time

import pytest

from vibeam.runs import parallel
from vibeam.runs.parallel import heartbeat


def test_a_line_comes_every_few_seconds_while_one_piece_lasts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "EVERY", 0.01)
    told: list[str] = []
    with heartbeat(told.append, lambda: "beam: 8 of 61 rows"):
        while len(told) < 3:
            time.sleep(0.001)
    count = len(told)
    time.sleep(0.05)
    assert len(told) == count
    assert told[0].startswith("beam: 8 of 61 rows, 0 s of CPU time")
