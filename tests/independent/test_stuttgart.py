"""Stuttgart's two beams: modes of the case against transfer matrices."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import vibeam
from tests.independent import stuttgart

CASE = Path(__file__).parents[2] / "cases" / "stuttgart" / "two_beams.toml"
PREDICTED = json.loads(Path(stuttgart.__file__).with_suffix(".json").read_text())


@pytest.mark.parametrize(("name", "stiffens"), [("stiffen", True), ("weigh", False)])
def test_modes_of_both_beams(name: str, stiffens: bool) -> None:
    changes = {"plate.0.stiffens": stiffens, "plate.1.stiffens": stiffens}
    system = vibeam.load(CASE, set=changes).system("high")
    expected = np.sort([*PREDICTED[name]["left"], *PREDICTED[name]["right"]])
    assert system.omega[:6] / (2 * np.pi) == pytest.approx(expected, rel=2e-6)


def test_the_stored_frequencies_are_those_of_the_program() -> None:
    left = stuttgart.frequencies(stuttgart.with_plates(0.001, 1, True), 0.0427, [(0.381, 0.0133, 0.0)], 1)
    assert left == pytest.approx(PREDICTED["stiffen"]["left"][:1], rel=1e-12)


def test_the_leaf_is_that_of_the_drawing() -> None:
    system = vibeam.load(CASE).system("high")
    assert system.law is not None
    assert system.law.stiffness == pytest.approx(1e3 * PREDICTED["leaf_stiffness_kN_per_m"], rel=1e-12)


LEAF = CASE.with_name("massive_leaf.toml")
BESIDE = json.loads(Path(stuttgart.__file__).with_name("stuttgart_measured.json").read_text())


def test_modes_with_the_leaf_are_those_assembled_in_numpy() -> None:
    """To 1e-5: two meshes, whose ninth mode has that error by (βh)⁴/1440."""
    system = vibeam.load(LEAF).system("high")
    stored = list(BESIDE["frequencies"].values())
    assert system.omega[:9] / (2 * np.pi) == pytest.approx(stored, rel=1e-5)
    assert stuttgart.with_leaf() == pytest.approx(stored, rel=1e-9)
    assert BESIDE["percent_off"]["left_fourth"] == pytest.approx(3.7, abs=0.05)


def test_measured_frequencies_are_those_of_the_case() -> None:
    measured = tomllib.loads(LEAF.read_text())["measured"]
    assert {name: float(each["value"].removesuffix(" Hz")) for name, each in measured.items()} == stuttgart.MEASURED


def test_how_nut_and_leaf_touch_hardly_matters() -> None:
    """Rigid without and with rebound, a spring, Hertz's contact of steel: 2 % of the amplitude at 27.7 Hz."""
    bodies = {"stop.radius": "8 mm", "stop.youngs_modulus": "210 GPa", "stop.poissons_ratio": 0.3}
    bodies |= {"beam.poissons_ratio": 0.3, "stop.velocity": "0.03 m/s", "stop.restitution": 0.8}
    rigid = {"stop.law": "restitution", "stop.stiffness": None}
    touches = [
        rigid | {"stop.restitution": 0.0},
        rigid | {"stop.restitution": 0.5},
        {},
        {"stop.law": "hunt-crossley", "stop.stiffness": None} | bodies,
    ]
    short = {"sweep.frequency": {"from": "27.4 Hz", "to": "27.7 Hz", "points": 4}, "sweep.direction": "up"} | {
        "fidelity.spring.set": None
    }
    found = [vibeam.run(vibeam.load(LEAF, touch | short), fidelities=["high"])["high"].up for touch in touches]
    heights = np.array([each.amplitude[-1] for each in found])
    assert np.ptp(heights) < 0.02 * heights.mean()
    assert 1.3 < heights.mean() / 1.7e-4 < 1.45
