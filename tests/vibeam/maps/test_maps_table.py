"""[map.NAME]: what it says becomes a plan; what is wrong with it has a line, a key and a cure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.casefile.read import parse

RIG = 'units = "SI"\n' + Path("cases/dtu_neutral.toml").read_text("utf-8").replace('"references/', '"cases/references/')

GOOD = """
[map.plane]
axes = [
  { key = "stop.gap", values = ["0 mm", "0.1 mm"] },
  { key = "drive.voltage", from = "200 mV", to = "0.6 V", points = 3 },
  { key = "sweep.frequency", from = "14 Hz", to = "17 Hz", points = 4 },
]
fidelities = ["sdof"]
direction = "down"
hold = 20
"""


def case(text: str) -> vibeam.Case:
    return parse(RIG + text, "mine.toml")


def faults(text: str) -> list[str]:
    with pytest.raises(vibeam.CaseError) as error:
        case(text)
    return str(error.value).splitlines()


def test_a_table_is_a_plan_in_si_with_the_sweeps_own_where_it_says_nothing() -> None:
    found = case(GOOD)
    plan = found.maps["plane"]
    assert [(axis.key, axis.unit) for axis in plan.axes] == [
        ("stop.gap", "m"), ("drive.voltage", "V"), ("sweep.frequency", "Hz"),
    ]  # fmt: skip
    assert plan.axes[0].values == (0.0, 1e-4)
    np.testing.assert_allclose(plan.axes[1].values, (0.2, 0.4, 0.6))
    assert (plan.direction, plan.hold, plan.settle, plan.output) == ("down", 20, found.sweep.settle, "sensor")
    assert set(plan.quantities) == {"amplitude", "period", "rest"}
    assert parse(found.text, found.path).maps == found.maps


def test_a_map_is_no_part_of_what_the_sweeps_compute() -> None:
    assert case(GOOD).key == parse(RIG, "mine.toml").key


def axis(text: str, more: str = "") -> str:
    other = '{ key = "sweep.frequency", values = [14, 15] }'
    return f"\n[map.m]\naxes = [\n{text},\n{other}]\n{more}\n"


LINES = RIG.count("\n")


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        (axis('{ key = "stop.gab", values = [1] }'), 4, "axes.0.key: unknown key 'stop.gab'; did you mean 'gap'?"),
        (axis('{ key = "beam.damping", values = [1] }'), 4, "'beam.damping' is no number that an axis"),
        (axis('{ key = "title", values = [1] }'), 4, "title is shared by all fidelities"),
        (axis('{ key = "stop.gap", values = ["1 kg"] }'), 4, "'1 kg' is a mass, not a length"),
        (axis('{ key = "stop.gap", values = [1, 1] }'), 4, "has a value twice"),
        (axis('{ key = "stop.gap", from = 0, to = 1 }'), 4, "points: missing: write points ="),
        (axis('{ key = "stop.gap", from = 0, to = 1, points = 2, values = [1] }'), 4, "goes without values"),
        (axis('{ key = "stop.gap", from = 0, to = 0, points = 2 }'), 4, "2 points from a value to itself"),
        (axis('{ key = "stop.gap", from = 0, to = 1, points = 1 }'), 4, "1 point does not span"),
        (axis('{ key = "beam.elements", from = 10, to = 20, points = 2 }'), 4, "takes whole numbers: list them"),
        (axis('{ key = "stop.restitution", values = [0.5, 1.5] }'), 4, "1.5 is outside [0, 1]"),
        (axis('{ key = "mass.position", values = ["0.1 m", "0.3 m"] }'), 4, "mass.position = 0.3 in fidelity sdof"),
        (axis('{ key = "stop.gap", values = [0] }', 'frequency = "15 Hz"'), 6, "sweep.frequency is an axis already"),
        (axis('{ key = "start.velocity", values = [0, 1] }', 'direction = "up"'), 4, 'write direction = "apart"'),
        (axis('{ key = "stop.gap", values = [0] }', 'starts = 3\npicture = "basins"'), 2, "map.m.spread: missing"),
        (axis('{ key = "stop.gap", values = [0] }', 'spread = "1 mm"'), 6, "goes with starts"),
        (axis('{ key = "stop.gap", values = [0] }', 'picture = "bifurcation"'), 3, "is of one axis, not 2"),
        (axis('{ key = "stop.gap", values = [0] }', 'picture = "basins"'), 6, "starts of their own"),
        (axis('{ key = "stop.gap", values = [0] }', 'quantity = "reach"'), 6, 'goes with picture = "values"'),
        (axis('{ key = "stop.gap", values = [0] }', 'accuracy = "2 %"'), 6, 'goes with picture = "verdict"'),
        (axis('{ key = "stop.gap", values = [0] }', 'picture = "stability"\ndirection = "up"'), 7, "does not go with"),
        (axis('{ key = "stop.gap", values = [0] }', 'picture = "verdict"\nquantity = "energy"'), 7, 'or "reach"'),
        ('\n[map.m]\naxes = [{ key = "sweep.frequency", values = [14] }]\npicture = "verdict"\n', 3, "of two axes"),
        (axis('{ key = "stop.gap", values = [0] }', "strobes = 51"), 6, "51 values need as many periods held"),
        (axis('{ key = "stop.gap", values = [0] }', 'fidelities = ["sdoff"]'), 6, "did you mean 'sdof'?"),
        ('\n[map.m]\naxes = [{ key = "stop.gap", values = [0] }]\npicture = "values"\n', 2, "map.m.frequency: missing"),
        (
            '\n[map.m]\naxes = [{ key = "mass.mass", values = [0.1, 0.2] }]\npicture = "values"\nfrequency = 15\n',
            3, "changes the modes",
        ),
        ("\n[map.m]\naxes = []\n", 3, "has no axis"),
        ("\n[map.m]\n", 2, "map.m.axes: missing (the last is swept"),
    ],
)  # fmt: skip
def test_a_fault_has_its_line_its_key_and_its_cure(text: str, line: int, said: str) -> None:
    found = faults(text)
    assert len(found) == 1, found
    assert found[0].startswith(f"mine.toml:{LINES + line}: map.m")
    assert said in found[0]


ALONE = GOOD.replace("[map.plane]", "[map]")


def test_a_single_map_needs_no_name() -> None:
    found, named = case(ALONE), case(GOOD)
    assert list(found.maps) == ["map"]
    assert replace(found.maps["map"], name="plane") == named.maps["plane"]
    assert parse(found.text, found.path).maps == found.maps


def test_a_map_without_a_name_goes_with_others_and_with_overrides() -> None:
    found = parse(RIG + ALONE + GOOD, "mine.toml", {"map.hold": 21, "map.plane.hold": 22})
    assert {name: plan.hold for name, plan in found.maps.items()} == {"map": 21, "plane": 22}


def test_faults_of_a_map_without_a_name_are_where_they_are_written() -> None:
    assert faults(ALONE.replace("hold = 20", "hold = 0"))[0].startswith(f"mine.toml:{LINES + 10}: map.hold: ")
    assert "map.hodl: unknown key; did you mean 'hold'?" in faults(ALONE.replace("hold", "hodl"))[0]
    with pytest.raises(vibeam.CaseError, match=r"--set.*map\.hold: 0"):
        parse(RIG + ALONE, "mine.toml", {"map.hold": 0})
    assert any("must be a table" in each for each in faults("[map]\nmap = { hold = 3 }\nhold = 2\n"))


def test_all_faults_are_reported_at_once() -> None:
    found = faults(axis('{ key = "stop.gab", values = [1] }', 'starts = 3\nhold = 0\nfidelities = ["x"]'))
    assert len(found) >= 4


def test_a_key_that_the_fidelity_sets_is_judged_there() -> None:
    own = '\n[fidelity.own]\nreduction = "static_mode"\nset = { "stop.restitution" = 0.6 }\n'
    text = axis('{ key = "stop.restitution", values = [0.5, 0.8] }', 'fidelities = ["own"]')
    assert case(own + text).maps["m"].fidelities == ("own",)
