"""The stored book of scenes: all there, vibeam as stored when flown again, scipy's counts too; tables that can fail.

The other peers need packages that the gate has not: ``python -m tests.others.book --run scenes`` runs them.
"""

from __future__ import annotations

import json
from copy import deepcopy
from functools import cache
from typing import Any

import pytest

from tests.others.scenes.attempt import attempt
from tests.others.scenes.chosen import CHOSEN, flown, judged
from tests.others.scenes.told import Told, told
from tests.others.scenes_book import PATIENCE, PEERS, RESULTS, cell, duration, row_of, said, significant, table

STORED = json.loads(RESULTS.read_text(encoding="utf-8"))
ROWS = {each["title"]: each for each in STORED["scenes"]}
ROUND_OFF = 2.3e-16
scene_of = cache(lambda title: CHOSEN[title]())
CHEAP = ("grazing touch: 1e-8 beyond a crest of the drive", "rest and release: the force changes sign")


def test_the_book_has_twelve_scenes_and_six_programs() -> None:
    assert list(ROWS) == list(CHOSEN)
    assert len(ROWS) == 12
    packages = {told["package"] for told in STORED["settings"].values()}
    assert packages == {"vibeam", "scipy", "heyoka", "diffrax", "siconos", "scikit-sundae", "mujoco"}
    assert all(set(row["peers"]) == set(STORED["settings"]) for row in ROWS.values())
    assert len(PEERS) == len(STORED["settings"])


@pytest.mark.parametrize("title", CHOSEN)
def test_vibeam_is_as_stored(title: str) -> None:
    """Nothing missed or invented, proved, times as exact as the book has them, but for another machine's round-off."""
    scene, stored = scene_of(title), ROWS[title]["peers"]["vibeam"]
    found, [path] = flown(scene, certify=True)
    verdict = judged(scene, found)
    assert verdict.fine
    assert stored["fine"]
    assert verdict.timed == stored["timed"] == len(scene.firm) == ROWS[title]["impacts"]
    assert verdict.late <= 10 * max(stored["late"], ROUND_OFF)
    assert verdict.off <= 10 * max(stored["off"], ROUND_OFF)
    assert path.certificate is not None
    assert path.certificate.complete == ROWS[title]["proof"]["complete"]


@pytest.mark.parametrize("title", CHEAP)
def test_scipy_misses_and_invents_what_the_book_says(title: str) -> None:
    """The first scene it misses, the second it has."""
    scene, stored = scene_of(title), ROWS[title]["peers"]["scipy"]
    found = row_of(scene, attempt("scipy_events", 0, told(scene), PATIENCE))
    assert [found[name] for name in ("ended", "fine", "missed", "invented", "words")] == [
        stored[name] for name in ("ended", "fine", "missed", "invented", "words")
    ]
    assert found["missed"] == (title == CHEAP[0])
    assert found["late"] <= 10 * stored["late"]


def test_a_peer_that_does_not_end_or_breaks_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.others.scenes import scipy_events

    scene = scene_of(CHEAP[0])
    monkeypatch.setattr(scipy_events, "solve_ivp", lambda *_, **__: 1 / 0)
    broken = row_of(scene, attempt("scipy_events", 0, told(scene), PATIENCE))
    assert said(broken) == "ZeroDivisionError: division by zero"
    assert not broken["fine"]

    def never(*_: Any, **__: Any) -> None:
        while True:
            pass

    monkeypatch.setattr(scipy_events, "solve_ivp", never)
    assert said(row_of(scene, attempt("scipy_events", 0, told(scene), 1))) == "not within 1 s"


def test_a_peer_that_is_right_and_faster_stands_in_bold() -> None:
    scene = deepcopy(ROWS[CHEAP[1]])
    ours, theirs = scene["peers"]["vibeam"], scene["peers"]["scipy"]
    theirs |= {"seconds": ours["seconds"] / 2, "late": ours["late"] / 4}
    assert cell(scene, "scipy").startswith("**ok; ")
    assert cell(scene, "scipy").endswith("(0.5 ×) †**")
    theirs |= {"fine": False, "missed": 1}
    assert cell(scene, "scipy").startswith("1 missed; ")
    theirs |= {"seconds": ours["seconds"] * 1234, "missed": 0, "fine": True, "late": ours["late"]}
    assert cell(scene, "scipy").endswith("(1 200 ×)")


def test_the_table_is_of_the_results() -> None:
    other = deepcopy(STORED)
    other["scenes"][0]["peers"]["heyoka"]["missed"] = 7
    assert "7 missed" in table(other)
    assert table(other) != table(STORED)
    rows = [row for row in table(STORED).splitlines() if row.startswith("| ")]
    assert len(rows) == (1 + 1 + len(CHOSEN) + 1) + (1 + 1 + len(CHOSEN)) + (1 + 1 + len(PEERS))


@pytest.mark.parametrize(("seconds", "text"), [(21.2, "21 s"), (0.0415, "42 ms"), (9.96e-4, "1 ms"), (8.2e-5, "82 µs")])
def test_durations_have_two_digits(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_thousands_stand_apart() -> None:
    assert [significant(value) for value in (81_234, 1000, 10.4, 0.684)] == ["81 000", "1 000", "10", "0.68"]


def test_what_peers_are_told_is_the_scene() -> None:
    scene = scene_of("clearance on both sides: three modes from rest")
    given: Told = told(scene)
    assert [stop.gap for stop in given.stops] == [scene.case.system.gap, scene.case.system.second_gap]
    assert (given.stops[0].row == -given.stops[1].row).all()
    assert given.stops[0].row @ given.stops[0].kick == pytest.approx(-1.7)
    assert told(scene_of("rest and release: the force changes sign")).held == 0
