"""A few maps damaged and asked for again; that the check can fail."""

from __future__ import annotations

import map_damage
import pytest

from vibeam.maps import gathered


def nothing(stage: str) -> None:
    """Nobody listens."""


@pytest.fixture(autouse=True)
def one_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(map_damage, "NAMES", ("plane",))


def test_a_damaged_map_is_told_or_computed_anew() -> None:
    verdicts = [map_damage.judge(2, number, nothing) for number in range(6)]
    assert [each.findings for each in verdicts if each.findings] == []
    assert {key for each in verdicts for key in each.counts} == {"finished, told", "half done, computed anew"}


def test_numbers_that_are_taken_without_a_word_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gathered, "is_sealed", lambda path: True)
    assert any(map_damage.judge(2, number, nothing).findings for number in range(6))
