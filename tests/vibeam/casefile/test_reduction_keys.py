"""Reductions of case files: a fidelity each, with keys of its own; what does not go together is refused."""

# ruff: noqa: E501  (a message stays on its line)

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from observed import NEUTRAL

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError

COUNTING = {
    "residual_flexibility": {"modes": 3},
    "craig_bampton": {"modes": 5},
    "pod": {"modes": 3, "frequency": "15 Hz", "periods": 20},
}


def case(**own: Any) -> Case:
    return vibeam.load(NEUTRAL, set={"fidelity.own": own, "beam.elements": 6, "fidelity.beam.modes": 6})


@pytest.mark.parametrize("name", COUNTING)
def test_every_basis_runs_from_a_case_file(name: str) -> None:
    given = case(reduction=name, **COUNTING[name])
    own, whole = given.system("own"), given.system("beam")
    assert own.size == COUNTING[name]["modes"]
    assert own.omega[0] == pytest.approx(whole.omega[0], rel=0.02)
    again = parse(given.text, NEUTRAL)
    assert np.array_equal(again.system("own").contact, own.contact)


def test_a_massless_boundary_runs_with_a_spring_as_stop() -> None:
    stop = {
        "stop.law": "linear",
        "stop.stiffness": "1e6 N/m",
        "stop.damping": "0 N s/m",
        "stop.restitution_of": "contact",
    }
    text = NEUTRAL.read_text("utf-8").replace("restitution = 0.72", "")
    changed = parse(text, NEUTRAL, {**stop, "fidelity.own": {"reduction": "massless_boundary", "modes": 2}})
    assert changed.system("own").law.stiffness < changed.system("two_modes").law.stiffness == 1e6
    with pytest.raises(ValueError, match="its mobility is infinite"):
        case(reduction="massless_boundary", modes=2).system("own")


def test_parameters_decide_the_key_and_the_basis() -> None:
    one, other = (case(reduction="pod", modes=2, frequency=f"{f} Hz") for f in (5, 90))
    assert one.key != other.key
    assert one.system("own").omega[1] != pytest.approx(other.system("own").omega[1], rel=1e-3)
    held = [case(reduction="craig_bampton", modes=4, boundary=rows) for rows in (["contact"], ["contact", "tip"])]
    assert abs(held[0].system("own").omega[3] / held[1].system("own").omega[3] - 1) > 1e-6


@pytest.mark.parametrize(
    ("own", "said"),
    [
        ({"reduction": "modal", "modes": 2, "frequency": "3 Hz"}, 'frequency: goes with reduction = "pod" alone, not "modal"'),
        ({"reduction": "residual_flexibility", "modes": 2, "boundary": ["contact"]}, 'boundary: goes with reduction = "craig_bampton" alone'),
        ({"reduction": "pod", "modes": 2}, 'frequency: missing: reduction = "pod" needs it; write frequency = "… Hz"'),
        ({"reduction": "pod", "modes": 2, "frequency": "15 Hz", "inner_product": "enrgy"}, "did you mean 'energy'?"),
        ({"reduction": "pod", "modes": 2, "frequency": 0}, "frequency: 0 must be > 0"),
        ({"reduction": "residual_flexibility"}, 'modes: missing: reduction = "residual_flexibility" needs how many; write modes = 8'),
        ({"reduction": "residual_flexibility", "modes": 13}, "modes: 13 are more than the model has"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_refused(own: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(**own)
    assert f"fidelity.own.{said}" in str(caught.value) or said in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_pod_is_made_of_the_flight_at_its_own_frequency() -> None:
    """Of a flight whose n snapshots span the model, all vectors give the full model back."""
    whole = case(reduction="full").system("own")
    own = case(reduction="pod", modes=10, frequency="15 Hz").system("own")
    assert whole.size == own.size
    np.testing.assert_allclose(own.omega, whole.omega, rtol=1e-8)
    fewer = [case(reduction="pod", modes=2, frequency=f"{f} Hz").system("own").omega[1] for f in (15, 45)]
    assert fewer[0] != pytest.approx(fewer[1], rel=1e-6)


def test_pod_on_a_platform_is_refused() -> None:
    platform = {
        "mass": "5 kg", "frequency": "3.25 Hz", "damping_ratio": 0.05, "coupling": "one-way", "calibrated_at": "15.5 Hz",
    }  # fmt: skip
    own = {"reduction": "pod", "modes": 2, "frequency": "15 Hz"}
    with pytest.raises(ValueError, match="pod: its flight is over a base that moves as prescribed"):
        vibeam.load(NEUTRAL, set={"fidelity.own": own, "platform": platform}).system("own")


def test_fidelities_of_other_bases_are_swept_and_compared() -> None:
    given = vibeam.load(
        NEUTRAL,
        set={
            "fidelity.rubin": {"reduction": "residual_flexibility", "modes": 4},
            "sweep.frequency": ["15 Hz"], "sweep.direction": "up",
        },
    )  # fmt: skip
    result = vibeam.run(given)
    rubin, beam = result["rubin"].up, result["beam"].up
    assert rubin is not None
    assert beam is not None
    assert rubin.amplitude[0] == pytest.approx(beam.amplitude[0], rel=0.05)
