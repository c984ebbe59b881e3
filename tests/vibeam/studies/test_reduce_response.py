"""What is recommended of a basis: by the response over the sweep, held against flights of random beams."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from observed import NEUTRAL
from vibeam.studies.modes_needed.losses import Amplitudes, ResponseError, response_error

import vibeam
from tests.benchmarks.recommended_beams import drawn, misses
from vibeam.case.case import Case
from vibeam.casefile.read import parse

CASES = NEUTRAL.parent
RIG = NEUTRAL.read_text(encoding="utf-8").partition("[reference")[0]
GRID = {"sweep.frequency": ["14.5 Hz", "15.3 Hz", "16 Hz"]}


def parsed(own: dict[str, Any]) -> Case:
    """The neutral rig of few elements, R held at the contact, swept up, with all modes as a fidelity."""
    plain = {"beam.elements": 8, "sweep.direction": "up", "fidelity.all": {"reduction": "full"}}
    return parse(RIG, set=plain | ({} if "stop" in own else {"stop.restitution_of": "contact"}) | own)


@pytest.mark.parametrize(("kind", "seed"), [("contact", 2), ("contact", 4), ("first mode", 3), ("linear", 6)])
def test_no_recommendation_is_off_by_more_where_it_repeats_as_all_modes_do(kind: str, seed: int) -> None:
    """Few of the 200 beams of each stop that ``tests/benchmarks/recommended_beams.py`` flies."""
    rows = misses(vibeam.reduce(drawn(kind, seed)))
    assert rows
    for row in rows:
        assert row["struck"] > row["points"] / 2, row
        assert row["worst"] <= 0.05, row


PINNED = """
[beam]
length = "346.17 mm"
width = "16.291 mm"
thickness = "2.7315 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.01747
elements = 6
ends = "clamped-pinned"
[mass]
mass = "137.8 g"
position = "292.28 mm"
[stop]
gap = "0 mm"
restitution = 0.85538
[sensor]
position = "292.28 mm"
[drive]
acceleration = "1 m/s^2"
[sweep]
frequency = { from = "111.536 Hz", to = "135.652 Hz", points = 7 }
direction = "up"
settle = 150
hold = 24
[fidelity.five]
reduction = "modal"
modes = 5
[fidelity.all]
reduction = "full"
"""


def test_a_recommendation_in_closed_form_is_the_error_of_a_run_and_the_losses_stay_beside_it() -> None:
    """R held at the contact: by the losses five modes would do, which are 20.5 % off (a run's own comparison)."""
    case = parse(PINNED)
    study = vibeam.reduce(case, bases=["modal"])
    assert (study.claim.closed, study.claim.struck, study.claim.flown, study.claim.refused) == (7, 7, 0, "")
    flown = vibeam.run(case)
    ours, whole = flown["five"].up, flown["all"].up
    assert ours is not None
    assert whole is not None
    off = np.abs(ours.amplitude / whole.amplitude - 1)
    told = study.of("modal")[4].response
    assert abs(told.worst) == pytest.approx(off.max(), rel=1e-4) == pytest.approx(0.205, abs=5e-4)
    assert told.peak == pytest.approx(ours.peak.amplitude / whole.peak.amplitude - 1, rel=1e-4)
    assert told.rms == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-4)
    (found,) = study.recommended
    assert (found.modes, found.by_losses) == (9, 5)
    assert found.losses is not None
    assert abs(found.losses.response.worst) <= 0.05 < abs(study.of("modal")[7].response.worst)


def test_nothing_is_recommended_where_the_motions_do_not_repeat() -> None:
    """The tight gap below its range of period 1: chaos."""
    grid = ["14 Hz", "14.2 Hz", "14.4 Hz", "14.6 Hz"]
    tight = {"stop.gap": "-0.1 mm", "stop.gap_at": "sensor", "sweep.frequency": grid}
    study = vibeam.reduce(parsed(tight), bases=["modal"])
    assert "do not repeat" in study.claim.refused
    (found,) = study.recommended
    assert found.modes is None
    assert found.by_losses is not None


def test_all_modes_are_flown_at_several_contacts() -> None:
    changes = {"sweep.settle": 4, "sweep.hold": 2, "beam.elements": 4}
    study = vibeam.reduce(vibeam.load(CASES / "rigs" / "two_stops.toml", set=changes), bases=["modal"], most=2)
    assert study.claim.why_flown == "no closed-form motions with several contacts"
    assert study.claim.flown > 0
    assert "ten seconds" not in study.claim.refused


def test_a_flight_is_given_up_where_a_model_is_off() -> None:
    stop = {"gap": "0 mm", "law": "linear", "stiffness": "1000 N/mm", "restitution": 0.7}
    case = parsed({"stop": stop, "sweep.frequency": ["14.5 Hz", "15.3 Hz"]})
    study = vibeam.reduce(case, bases=["residual_flexibility"], most=4)
    assert study.claim.why_flown == 'no closed-form motions with the contact law "linear"'
    assert (study.claim.flown, study.claim.repeating) == (2, 2)
    first, *_, last = (row.response for row in study.of("residual_flexibility"))
    assert first.given_up
    assert abs(first.worst) > 0.05
    assert np.isnan(first.peak)
    assert not last.given_up
    assert (last.points, last.total) == (2, 2)


def test_a_model_that_makes_other_motions_is_not_within() -> None:
    grid = np.arange(20)
    full, ours = np.full((20, 3), np.nan), np.full((20, 3), np.nan)
    full[:, 0], ours[2:, 0], ours[:2, 1] = 1.0, 1.01, 1.0
    ours[7, 0] = 1.04
    found = response_error([tuple(Amplitudes(grid, 10.0 + grid, each, 20) for each in (ours, full))])
    assert (found.worst, found.mu, found.points, found.total) == (pytest.approx(0.04), 17.0, 18, 20)
    assert found.peak == pytest.approx(0.04)
    assert found.rms == pytest.approx(np.sqrt((17 * 0.01**2 + 0.04**2) / 18))
    assert found.within(0.05)
    assert not found.within(0.03)
    assert not ResponseError(0.01, 0.01, 0.01, 17, 20).within(0.05)


def test_a_peak_that_is_off_is_not_within_and_none_is_where_all_modes_are_not_known() -> None:
    """The first point has no motion of all modes; at the second only the model's branch with impacts goes on."""
    nan = np.nan
    full = np.array([[nan, nan], [nan, 0.5], [1.0, nan]])
    ours = np.array([[9.0, nan], [1.2, 0.5], [1.0, nan]])
    found = response_error([tuple(Amplitudes(np.arange(3), np.arange(3.0), each, 3) for each in (ours, full))])
    assert (found.worst, found.points, found.total) == (0.0, 2, 2)
    assert found.peak == pytest.approx(0.2)
    assert found.within(0.2)
    assert not found.within(0.1)


def test_a_flight_that_ends_among_other_motions_is_told_as_such() -> None:
    near = ResponseError(worst=0.01, points=3, total=20, given_up=True)
    assert near.strays(0.05)
    assert ResponseError(total=20, given_up=True).strays(0.05)
    assert not replace(near, worst=-0.06).strays(0.05)
    assert not replace(near, given_up=False).strays(0.05)
