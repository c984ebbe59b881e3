"""Comparison of two response curves on the page, against that of ``vibeam.runs.comparison``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from stand_in import curve

import vibeam
from vibeam.extensions.explore.payload import payload
from vibeam.periodic.motion_kind import FREE, IRREGULAR, UNKNOWN, SteadyKind, kinds_of
from vibeam.runs.comparison.errors import Asked, ResponseComparison, asked_of
from vibeam.runs.comparison.places import SweptPlace
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.result import Result

Node = Callable[..., Any]
Places = Mapping[str, list[SweptPlace]]
SCRIPT = """
const { compared } = await load("extensions/explore/views/comparison.js");
return given.pairs.map(({ legs, asked }) => compared(legs, asked));
"""
KINDS = [SteadyKind(FREE), SteadyKind(1, 1), SteadyKind(1, 2), SteadyKind(2, 2), SteadyKind(2, -1), SteadyKind(3, 1)]
ODD = [SteadyKind(IRREGULAR), SteadyKind(UNKNOWN)]


def on_page(node: Node, pairs: list[tuple[Places, Places]], asked: Asked) -> list[dict[str, Any]]:
    """The page's comparisons of the first of each two with the second."""
    given = [{"legs": legs(*each), "asked": {"amplitude": asked.amplitude, "frequency": asked.frequency}}
             for each in pairs]  # fmt: skip
    found: list[dict[str, Any]] = node(SCRIPT, {"pairs": given})
    return found


def legs(ours: Places, theirs: Places) -> list[dict[str, Any]]:
    """Both responses as the page has them."""

    def rows(places: list[SweptPlace]) -> list[dict[str, Any]]:
        return [{"frequency": each.frequency, "amplitude": each.amplitude, "kind": str(each.kind)} for each in places]

    return [{"way": way, "ours": rows(ours[way]), "theirs": rows(theirs[way])} for way in ours]


def same(page: Sequence[tuple[float, ...]], python: Sequence[tuple[float, ...]]) -> None:
    """The same rows in any order, to round-off."""
    assert len(page) == len(python)
    if python:
        np.testing.assert_allclose(sorted(page), sorted(python), rtol=1e-9, atol=1e-12)


def agree(page: dict[str, Any], python: ResponseComparison, near: float = 1e-12) -> None:
    """Both have the same errors at the same places."""
    amplitude = python.amplitude
    assert (page.get("amplitude") is None) == (amplitude is None)
    if amplitude is not None:
        assert page["amplitude"]["error"] == pytest.approx(amplitude.error, abs=near)
        assert page["amplitude"]["scatter"] == pytest.approx(amplitude.scatter, abs=near)
        assert page["amplitude"]["frequency"] == amplitude.frequency
    ends = [(each.ours.frequency, each.reference.frequency, each.error, each.open) for each in python.ends]
    there = [(each["ours"]["frequency"], each["reference"]["frequency"], each["error"], each["open"])
             for each in page["ends"]]  # fmt: skip
    same(there, ends)
    kinds = [(each.low, each.high, each.width, each.open, each.alone) for each in python.kinds]
    theirs = [tuple(each[name] for name in ("low", "high", "width", "open", "alone")) for each in page["kinds"]]
    same(theirs, kinds)
    named = {(each.low, *map(str, (each.ours, each.reference))) for each in python.kinds}
    assert {(each["low"], *each["kinds"]) for each in page["kinds"]} == named


def random_response(rng: np.random.Generator, grid: np.ndarray, kinds: list[SteadyKind]) -> Places:
    """Response of random branches, some of which have one place, in both directions."""
    found = {}
    for way, swept in (("up", grid), ("down", grid[::-1])):
        cuts = np.unique(rng.integers(1, len(grid), size=rng.integers(0, 9)))
        places = list[SweptPlace]()
        for first, last in pairwise([0, *cuts.tolist(), len(grid)]):
            kind, size = kinds[rng.integers(len(kinds))], rng.choice([1.0, 0.05, 1.3])
            sizes = size * (1 + 1e-3 * rng.standard_normal(last - first))
            places += [SweptPlace(float(f), kind, float(s), 0.0) for f, s in zip(swept[first:last], sizes, strict=True)]
        found[way] = places
    return found


def moved(rng: np.random.Generator, places: Places) -> Places:
    """The response with ends of branches elsewhere, and other amplitudes."""
    found = {}
    for way, own in places.items():
        shift = int(rng.integers(-3, 4))
        at = np.clip(np.arange(len(own)) + shift, 0, len(own) - 1)
        found[way] = [
            SweptPlace(here.frequency, own[k].kind, own[k].amplitude * float(1 + 0.03 * rng.standard_normal()), 0.0)
            for here, k in zip(own, at.tolist(), strict=True)
        ]
    return found


@pytest.mark.parametrize("kinds", [KINDS, [*KINDS, *2 * ODD[:1]], [*KINDS, *ODD]], ids=["known", "odd", "failed"])
@pytest.mark.parametrize("asked", [Asked(), Asked(0.2, 0.1)], ids=["usual", "coarse"])
def test_random_responses_are_compared_as_python_does(node: Node, asked: Asked, kinds: list[SteadyKind]) -> None:
    """Amplitudes, ends and differences in kind, both ways, and the verdict: never more than is known."""
    rng, verdicts, pairs = np.random.default_rng(47), set[bool | None](), []
    for _ in range(150):
        grid = np.sort(rng.uniform(90, 110, size=rng.integers(2, 80)))
        one = random_response(rng, grid, kinds)
        pairs.append((one, moved(rng, one) if rng.random() < 0.7 else random_response(rng, grid, kinds)))
    for (ours, theirs), page in zip(pairs, on_page(node, pairs, asked), strict=True):
        python = compared(Response(dict(ours)), Response(dict(theirs)), asked.frequency)
        agree(page, python)
        known = python.suffices(asked)
        assert page["suffices"] is (None if known and python.unknown else known)  # no point may have failed
        verdicts.add(page["suffices"])
    assert verdicts == {True, False, None}


def test_one_frequency_is_a_sweep_too(node: Node) -> None:
    """Another motion there, or a larger one of the same kind."""
    one = {"up": [SweptPlace(100.0, KINDS[1], 1.0, 0.0)]}
    others = [{"up": [SweptPlace(100.0, kind, size, 0.0)]} for kind, size in ((KINDS[2], 1.0), (KINDS[1], 1.2))]
    pages = on_page(node, [(each, one) for each in (*others, one)], Asked())
    pythons = [compared(Response(dict(each)), Response(dict(one))).suffices(Asked()) for each in (*others, one)]
    assert [page["suffices"] for page in pages] == pythons == [False, False, True]


@pytest.mark.parametrize(
    ("period", "impacts", "kind"),
    [
        (-1, 0.0, SteadyKind(FREE)), (0, 1.2, SteadyKind(IRREGULAR)), (5, 1.0, SteadyKind(IRREGULAR)),
        (1, 1.0, SteadyKind(1, 1)), (2, 1.5, SteadyKind(2, 3)), (1, 8.1, SteadyKind(1, -1)), (1, 0.0, SteadyKind(1, 0)),
    ],
)  # fmt: skip
def test_a_motion_has_the_kind_that_python_gives_it(node: Node, period: int, impacts: float, kind: SteadyKind) -> None:
    found = curve([1.0], 1.0, period)
    found.impacts_per_period[:] = impacts
    assert kinds_of(found) == [kind]
    script = "return (await load('extensions/explore/views/branches.js')).kindOf(given.known, given);"
    given = {"period": period, "impactsPerPeriod": impacts}
    assert node(script, {"known": True, **given}) == str(kind)
    assert node(script, {"known": False, **given}) == str(SteadyKind(UNKNOWN))


SWEPT = """
const { open } = await load("extensions/explore/engine/engine.js");
const { compared } = await load("extensions/explore/views/comparison.js");
const { kindOf } = await load("extensions/explore/views/branches.js");
const { payload } = given, engine = await open(payload);
const { frequency: swept, direction, settle, hold } = payload.sweep, up = [...swept].sort((a, b) => a - b);
const ways = { up: [up], down: [[...up].reverse()], both: [up, [...up].reverse()] }[direction];
function legsOf(name) {
  let states = [];
  return ways.map((order) => {
    const found = engine.response(name, {}, order, { settle, hold, carried: true, states });
    states = found.states.slice(-1);
    return order.map((frequency, at) => ({ frequency, amplitude: found.amplitude[at],
      kind: kindOf(found.ended[at] === payload.ended[0],
        { period: found.period[at], impactsPerPeriod: found.impactsPerPeriod[at] }) }));
  });
}
const legs = Object.fromEntries(payload.models.map(({ name }) => [name, legsOf(name)]));
return Object.fromEntries(payload.models.filter(({ name, finest }) => name !== finest).map(({ name, finest }) => {
  const both = legs[name].map((ours, at) => {
    const way = at || direction === "down" ? "down" : "up";
    return { way, ours, theirs: legs[finest][at] };
  });
  return [name, compared(both, payload.asked)];
}));
"""


def swept(low: int, high: int, points: int, direction: str = "both") -> dict[str, Any]:
    """Another sweep of a case, which then expects nothing of a direction that is not swept."""
    grid = {"from": f"{low / 10} Hz", "to": f"{high / 10} Hz", "points": points}
    return {"sweep.frequency": grid, "sweep.direction": direction} | ({} if direction == "both" else {"expect": None})


REGULAR = {  # case, its sweep, what the page says of its fidelities
    "a peak without a jump": ("dtu_neutral", swept(149, 157, 17), [False, True]),
    "jumps, both ways": ("rigs/harvester", swept(560, 710, 41), [False]),
    "a jump, swept up": ("rigs/harvester", swept(560, 680, 97, "up"), [False]),
    "too coarse a grid": ("rigs/relay", swept(1600, 2100, 26, "down"), [None, None]),
    "period doubled": ("rigs/relay", swept(1600, 2100, 51), [False, False]),
}


def both_ways(node: Node, file: str, changes: dict[str, Any]) -> list[tuple[dict[str, Any], ResponseComparison, Any]]:
    """Of each fidelity the page's comparison, Python's on the same grid, and the verdict of a run."""
    case = vibeam.load(f"cases/{file}.toml", changes)
    result, asked = vibeam.run(case, compare=True), asked_of(case)
    assert isinstance(result, Result)
    pages, run = node(SWEPT, {"payload": payload(case)}), {each.fidelity: each for each in result.compare()}
    assert pages.keys() == {name for name, each in run.items() if each.reference}
    found = []
    for name, page in pages.items():
        ours, theirs = (Response.of(result[each]) for each in (name, run[name].reference))
        found.append((page, compared(ours, theirs, asked.frequency), run[name].suffices(asked)))
    return found


@pytest.mark.parametrize("name", REGULAR)
def test_the_page_says_of_a_case_what_its_run_does(node: Node, name: str) -> None:
    """Amplitudes to 1e-6 and ends to the grid; a run, which brackets the ends of branches, never says the contrary."""
    file, changes, expected = REGULAR[name]
    found = both_ways(node, file, changes)
    assert [page["suffices"] for page, _, _ in found] == expected
    for page, python, verdict in found:
        agree(page, python, 1e-6)
        assert {page["suffices"], verdict} != {True, False}


@pytest.mark.slow
@pytest.mark.parametrize(
    "file", ["dtu_neutral", "dtu_loose", "rigs/harvester", "rigs/relay", "rigs/mems_switch", "rigs/tube"]
)
def test_the_page_contradicts_no_run(node: Node, file: str) -> None:
    """Where motions do not repeat too, of which chance gives other readings to each."""
    for page, _, verdict in both_ways(node, file, {}):
        assert {page["suffices"], verdict} != {True, False}
