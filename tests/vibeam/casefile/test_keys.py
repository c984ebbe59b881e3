"""Models of a case at other values of keys: what the case read anew makes, or a fault that says why not."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

import vibeam

CASES = Path(__file__).parents[3] / "cases"
RIG = CASES / "dtu_neutral.toml"
OWN = {"fidelity.sdof.set": {"stop.restitution": 0.6}, "fidelity.beam.without": ["stop.position"]}


@pytest.mark.parametrize(
    ("file", "name", "values"),
    [
        ("dtu_neutral", "beam", {"mass.position": 0.12, "beam.elements": 20, "stop.gap": 1e-4}),
        ("dtu_neutral", "beam", {"clamp.stiffness": 500.0, "beam.damping_ratio": 0.02}),  # one whose table is not there
        ("dtu_neutral", "beam", {"fidelity.beam.modes": 3, "drive.voltage": 0.5}),
        ("sdof_nominal", "sdof", {"sdof.damping_ratio": 0.02, "stop.restitution": 0.5}),
        ("matrices/frame", "whole", {"matrices.damping_ratio": 0.02, "stop.gap": 1e-4}),
        ("matrices/dtu_modes", "two", {"stop.gap": 1e-4}),
    ],
)
def test_a_model_at_other_values_is_that_of_the_case_read_anew(file: str, name: str, values: dict[str, float]) -> None:
    case = vibeam.load(CASES / f"{file}.toml")
    model, again = case.model(name).at(values).checked(), case.with_keys(values)
    assert (model.scene(), model.fidelity) == (again.scene_of(name), again.fidelities[name])
    assert model.system().moves_as(again.system(name))
    assert (model.scene(), model.fidelity.modes) != (case.scene_of(name), case.fidelities[name].modes)
    sent = pickle.loads(pickle.dumps(model))
    assert sent == model != case.model(name)
    assert sent.system().moves_as(model.system())


def test_a_value_wins_over_what_the_fidelity_sets_and_not_over_what_it_leaves_out() -> None:
    case = vibeam.load(RIG, set=OWN | {"stop.position": "120 mm"})
    values = {"stop.restitution": 0.5, "stop.position": 0.11}
    assert case.model("sdof").at({}).scene().stop.restitution == 0.6
    set_, left = (case.model(name).at(values).scene().stop for name in ("sdof", "beam"))
    assert (set_.restitution, set_.position, left.restitution, left.position) == (0.5, 0.11, 0.5, 0.132)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"stop.restitution": 1.2}, "--set stop.restitution: 1.2 is outside [0, 1]"),
        ({"beam.elements": 7.5}, "--set beam.elements: must be a whole number, not 7.5"),
        ({"beam.lenght": 1.0}, "--set beam.lenght: unknown key; did you mean 'length'?"),
        ({"mass.position": 0.2}, "--set mass.position: 0.2 m is beyond the tip: beam.length is 0.18 m"),
        ({"beam.length": 0.12}, f"{RIG}: mass.position: 0.132 m is beyond the tip: beam.length is 0.12 m"),
        ({"fidelity.beam.modes": 100.0}, "--set fidelity.beam.modes: 100 are more than the model has: beam.elements "
         "gives 72 at most"),
    ],
)  # fmt: skip
def test_what_the_case_may_not_have_is_refused_by_its_key(values: dict[str, float], said: str) -> None:
    with pytest.raises(vibeam.CaseError) as refused:
        vibeam.load(RIG).model("beam").at(values).checked()
    assert said in str(refused.value).splitlines()


def test_a_key_has_its_value_its_unit_and_its_numbers() -> None:
    keys = vibeam.load(RIG, set={"beam.damping_ratio": [0.017]}).keys
    assert [keys.value(key) for key in ("mass.position", "beam.damping_ratio", "drive.force")] == [0.132, 0.017, None]
    assert [keys.unit(key) for key in ("mass.position", "drive.voltage", "beam.elements")] == ["m", "V", ""]
    assert (keys.number("mass.position", "120 mm"), keys.number("mass.position", 0.12)) == (0.12, 0.12)
    assert (keys.number("beam.damping_ratio", "2 %"), keys.number("beam.elements", "20")) == (0.02, 20.0)
    for key in ("beam.lenght", "beam", "stop.law", "sweep.settle"):
        with pytest.raises(ValueError, match=rf"'{key}' is no key of the case that holds a number"):
            keys.unit(key)
    with pytest.raises(ValueError, match="'many' is not a number"):
        keys.number("beam.elements", "many")


def test_a_case_with_other_keys_keeps_its_references() -> None:
    curve = vibeam.ReferenceCurve.of([15.0], [1e-4])
    case = vibeam.load(RIG).with_reference("laser", curve, "beam")
    other = case.with_keys({"stop.gap": "0.1 mm", "figure.title": False})
    assert (other.scene.stop.gap, other.figure.title, other.references["laser"].curve) == (1e-4, False, curve)
    assert other.with_keys({"stop.gap": case.scene.stop.gap, "figure.title": None}).key == case.key
