"""The reach of the output: Q = Δ − min q of the paper, Δ the gap at the sensor (§5, eq. 45)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.case.response_quantities import touching, values_of
from vibeam.casefile.read import parse
from vibeam.report.figures import figure
from vibeam.studies.regression import check as expectations
from vibeam.system.impact_system import ImpactSystem

CASES = Path(__file__).parents[3] / "cases"
SHORT = {"sweep.frequency": ["15 Hz"], "sweep.direction": "up", "sweep.settle": 20, "sweep.hold": 4}


def test_of_one_degree_of_freedom_it_is_the_reach() -> None:
    grid = {"sweep.frequency": ["2 rad/s"], "sweep.direction": "up"}
    case = vibeam.load(CASES / "sdof_nominal.toml", set=grid)
    response = vibeam.run(case, show=False)["sdof"].up
    assert response is not None
    assert values_of(case, "sdof", response, "output_reach") == pytest.approx(response.reach, rel=1e-12)


@pytest.mark.parametrize("name", ["sdof", "two_modes", "beam"])
def test_a_gap_given_at_the_sensor_is_found_there(name: str) -> None:
    """0.1 mm there by the static deflection under a force at the contact; few modes bend a little differently."""
    case = vibeam.load(CASES / "dtu_loose.toml", set={"stop.gap_at": "sensor", **SHORT})
    system = case.system(name)
    near = {"sdof": 1e-9, "two_modes": 3e-3, "beam": 3e-4}[name]
    assert touching(system, "sensor", np.array([system.gap])) == pytest.approx([1e-4], rel=near)
    assert touching(system, "contact", np.array([system.gap])) == pytest.approx([system.gap], rel=1e-12)


def test_of_one_mode_it_is_the_contacts_reach_by_the_modes_shape() -> None:
    case = vibeam.load(CASES / "dtu_loose.toml", set=SHORT)
    response, system = vibeam.run(case, show=False)["sdof"].up, case.system("sdof")
    assert response is not None
    share = float(system.output("sensor")[0] / system.contact[0])
    assert values_of(case, "sdof", response, "output_reach") == pytest.approx(response.reach * share, rel=1e-9)
    assert abs(share - 1) > 0.1


def test_a_constant_load_moves_the_place() -> None:
    """Two springs: 1 and 4 N/m on the modes, outputs (1, 0), contact (1, 1), load (0, 2): by hand."""
    system = ImpactSystem.from_modes(
        [1.0, 2.0], 0.1, [1.0, 1.0], [1.0, 1.0], gap=0.75, static=[0.0, 2.0], outputs={"sensor": [1.0, 0.0]}
    )
    assert touching(system, "sensor", np.array([0.75])) == pytest.approx([0.2])  # 0 + 1/(1 + 1/4) · (0.75 − 2/4)


def test_a_case_can_expect_and_show_it() -> None:
    text = (CASES / "sdof_nominal.toml").read_text(encoding="utf-8").partition("[reference.exact]")[0]
    more = """
[show.reach]
kind = "curve"
quantity = "output_reach"
[expect.reach]
fidelity = "sdof"
quantity = "output_reach"
frequency = "2 rad/s"
value = {value}
tolerance = "0.001 %"
"""
    for value, met in ((1.753002e-2, True), (1.7531e-2, False)):  # the periodic Green's function
        case = parse(text + more.format(value=value))
        result = vibeam.run(case)
        assert [row.passed for row in expectations.check(case, result)] == [met]
    (axes,) = figure(result, case.shows["reach"]).axes
    assert axes.get_ylabel() == "reach Q = Δ − min"
