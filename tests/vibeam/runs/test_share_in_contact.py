"""Share of a motion's time in contact, under a record: rigid and yielding stops, one place of contact and several."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.runs.transient.signals import share_in_contact
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

BASE = vibeam.ImpactSystem.from_modes([100.0, 900.0], 0.05, [1.0, 0.5], [1.0, 0.3], gap=-1e-3)
GENTLE = vibeam.Record.half_sine(1.0, 0.011)
HARD = vibeam.Record.half_sine(400.0, 0.011)
LAWS = {"rigid": None, "linear": LinearStop(1e4, 10.0), "hertz": HuntCrossley(1e7)}


def system(law: str, gap: float, second: float | None = None) -> vibeam.ImpactSystem:
    own = LAWS[law]
    made = replace(BASE, gap=gap, second_gap=second)
    return made if own is None else replace(made, law=own)


@pytest.mark.parametrize("law", LAWS)
def test_a_stop_that_stays_closed_is_in_contact_all_the_time(law: str) -> None:
    path = vibeam.simulate(system(law, -1e-3), GENTLE, t_end=0.1)
    assert share_in_contact(path) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_a_stop_that_is_never_met_is_not_in_contact(law: str) -> None:
    assert share_in_contact(vibeam.simulate(system(law, 1.0), GENTLE, t_end=0.1)) == 0.0


@pytest.mark.parametrize("second", [None, 2e-3])
def test_a_yielding_stop_is_in_contact_while_it_is_pushed(second: float | None) -> None:
    made = replace(system("linear", 1e-3, second), law=LinearStop(1e4, 0.0))  # a damped one lets go before it is left
    path = vibeam.simulate(made, HARD, t_end=0.2)
    times = np.linspace(0.0, 0.2, 200_001)
    place = path.at(times)
    touching = (place > made.gap) | ((place < -made.second_gap) if second else False)
    assert 0.02 < touching.mean() < 0.9
    assert share_in_contact(path) == pytest.approx(touching.mean(), abs=2e-4)
