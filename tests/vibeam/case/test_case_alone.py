"""The case of one fidelity alone: the same model and run, and nothing that names another fidelity or an absent key."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.studies.record.plane import record_map
from vibeam.studies.uncertainty.recorded_inputs import record_uncertainty

CASES = Path(__file__).parents[3] / "cases"
SAMPLES = (
    "dtu_neutral", "lodz/cantilever", "experiment/fig27", "experiment/fig28_mass", "matrices/frame", "solid/dtu",
    "matrices/dtu_modes", "stuttgart/two_beams", "inputs/truck", "inputs/tube_noise", "uncertain/neutral",
    "paper/fig03", "synthetic/fit", "sdof_methods",
)  # fmt: skip
ASKED = ("references", "expectations", "measured", "shows", "maps", "uncertain")


@pytest.mark.parametrize("name", SAMPLES)
def test_a_fidelity_alone_computes_the_same(name: str) -> None:
    case = vibeam.load(CASES / f"{name}.toml")
    for fidelity in case.fidelities:
        alone = case.alone(fidelity)
        assert list(alone.fidelities) == [fidelity]
        assert alone.own[fidelity] == case.own[fidelity]
        assert alone.scene_of(fidelity) == alone.scene == case.scene_of(fidelity)
        assert (alone.title, alone.record) == (case.title, case.record)
        if case.record is None:
            np.testing.assert_array_equal(alone.sweep.frequency, case.sweep.frequency)
        assert not any(getattr(alone, each) for each in ASKED)
        assert alone.fit is None


def test_what_a_fidelity_leaves_out_stays_out_of_its_variants() -> None:
    case = vibeam.load(
        CASES / "dtu_neutral.toml",
        {"fidelity.beam.without": ["mass.rotary_inertia"], "fidelity.beam.set": {"stop.gap": "0.1 mm"}},
    )
    alone = case.alone("beam")
    given = alone.with_keys({"mass.rotary_inertia": 3e-5, "stop.gap": 2e-4})
    assert given.system("beam").omega.tolist() == case.system("beam").omega.tolist()
    assert given.scene_of("beam").stop.gap == case.model("beam").at({"stop.gap": 2e-4}).scene().stop.gap == 2e-4
    with pytest.raises(KeyError, match="no fidelity 'beem': there are sdof"):
        case.alone("beem")


MEASURED = {
    "tap": {"fidelity": "sdof", "quantity": "first_impact", "value": "10 ms", "scatter": "1 ms", "source": "a log"},
    "apart": {"fidelity": "beam", "against": "sdof", "quantity": "peak", "value": "3 %", "source": "a log"},
}


NAMING: dict[str, Any] = {
    "measured": MEASURED, "chosen_by": {"mass.mass": ["tap"], "mass.rotary_inertia": ["tap", "apart"]},
    "uncertain": {"mass.rotary_inertia": "± 10 %", "stop.gap": "± 10 %"},
}  # fmt: skip


def shaken(naming: dict[str, Any]) -> vibeam.Case:
    """The beam under a shock; ``naming``: tables that name fidelities, numbers and keys."""
    quick = {
        "record.duration": "0.05 s", "record.values": [1.0], "record.certify": False, "beam.elements": 8,
        "expect": None, "show": None, "fidelity.beam.modes": 3, "fidelity.two_modes.without": ["mass.rotary_inertia"],
    }  # fmt: skip
    return vibeam.load(CASES / "inputs" / "half_sine.toml", quick | naming)


@pytest.mark.parametrize("stage", ["modes", "effects", "map"])
def test_a_record_with_numbers_that_chose_keys_has_each_stage_of_a_verdict(stage: str) -> None:
    found, bare = (vibeam.verdict(shaken(naming), only=[stage])[stage] for naming in (NAMING, {}))
    assert found.case.measured
    told = [[row.worst for row in each.rows] if stage == "modes" else [] for each in (found, bare)]
    if stage == "effects":
        told = [[(row.effect, row.without.worst) for row in each.rows] for each in (found, bare)]
    if stage == "map":
        told = [[each.mean for of in one.comparison.values() for each in of.differences] for one in (found, bare)]
    assert told[0]
    assert told[0] == told[1]


def test_such_a_record_has_maps_and_carries_uncertain_inputs() -> None:
    case = shaken(NAMING | {"uncertain": {"stop.gap": "± 10 %"}})
    found = record_map(case, {"level": [0.5, 1.0]}, "impacts")
    assert list(found.means) == list(case.fidelities)
    assert found.means["beam"].shape == (2,)
    assert record_uncertainty(case, 16, 0).rows
