"""Table [[further_stop]]: contacts of a system from a case, and its messages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam_models.laws.compliant import LinearStop

CASE = Path(__file__).parents[3] / "cases/rigs/two_stops.toml"


def test_each_table_is_a_contact_with_its_own_row_gap_and_restitution() -> None:
    case = vibeam.load(CASE, set={"further_stop.0.restitution": 0.5})
    system = case.system("four_modes")
    assert system.further is not None
    (contact,) = system.further
    assert (contact.gap, contact.restitution) == (3e-4, 0.5)
    assert contact.row == pytest.approx(-system.outputs["tip"], rel=0.1)  # 2 mm from the tip, on the other side
    assert case.system("one_stop").further is None
    above = vibeam.load(CASE, set={"further_stop.0.side": "above"}).system("four_modes")
    assert above.further is not None
    assert np.array_equal(above.further[0].row, -contact.row)


def test_on_a_platform_that_moves_the_contacts_are_those_of_the_beam() -> None:
    platform = {"mass": "2 kg", "stiffness": "20 kN/m", "damping_ratio": 0.01, "coupling": "two-way"}
    changes: dict[str, Any] = {"platform": platform, "drive": {"force": "1 N"}}
    system = vibeam.load(CASE, set=changes).system("four_modes")
    assert system.further is not None
    assert system.size == 5
    (contact,) = system.further
    assert np.array_equal(contact.row, system.outputs["toward the stop below at 178 mm"])


def test_each_stop_has_a_law_of_its_own() -> None:
    own = {"further_stop.0.law": "linear", "further_stop.0.stiffness": "50 kN/m"}
    system = vibeam.load(CASE, set={**own, "stop.restitution": 0.6}).system("four_modes")
    assert system.law is None
    assert system.further is not None
    (contact,) = system.further
    assert contact.law == LinearStop.matched(5e4, 0.72, 1 / float(contact.row @ contact.row))
    hertz = {"law": "hertz", "hertz_stiffness": 1e8, "position": "178 mm", "gap": "0.3 mm", "side": "below"}
    both = vibeam.load(CASE, set={"further_stop": [hertz], "stop.law": "linear", "stop.stiffness": "1 MN/m"})
    mixed = both.system("four_modes")
    assert mixed.further is not None
    assert (mixed.contact_law.name, mixed.further[0].contact_law.name) == ("linear", "hertz")
    path = vibeam.simulate(mixed, vibeam.Drive(2 * np.pi * 12, 5e-4), 0.5)
    assert {0, 1} <= set(path.impact_contacts.tolist())
    assert len(path.contacts) > 3


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"further_stop.0.position": "0.2 m"}, "further_stop.0.position: 0.2 m is beyond the tip"),
        ({"further_stop.0.side": "left"}, "further_stop.0.side: 'left' is not one of"),
        ({"further_stop.0.restitution": 1.2}, "further_stop.0.restitution: 1.2 is outside [0, 1]"),
        ({"further_stop.0.law": "linear"}, 'further_stop.0.stiffness: missing: law = "linear" needs it'),
        ({"further_stop.0.stiffness": "1 kN/m"}, 'stiffness: does not go with law = "restitution": take it out'),
        ({"further_stop.0.law": "steel"}, "further_stop.0.law: 'steel' is not one of"),
    ],
)
def test_messages(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(vibeam.CaseError) as told:
        vibeam.load(CASE, set=changes)
    assert message in str(told.value)


def test_a_solver_that_cannot_take_it_says_so() -> None:
    case = vibeam.load(CASE, set={"fidelity.sdof.solver": "direct", "sweep.frequency": ["10 Hz"]})
    with pytest.raises(ValueError, match="solver 'direct' cannot take several contacts"):
        vibeam.run(case)
