"""Stuttgart's two beams: modes of the case against transfer matrices."""

from __future__ import annotations

import json
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
