"""The number of modes that a case needs: the answer before any flight, beside flights; cases without closed forms."""

from __future__ import annotations

from typing import Any

import pytest
from observed import NEUTRAL

import vibeam
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.report.modes_needed import answer, first_answer, sheet
from vibeam.studies.modes_needed import response
from vibeam.studies.modes_needed.reduction import ReductionProblem
from vibeam.studies.modes_needed.study import before_flight
from vibeam.system.number_text import percent

CASES = NEUTRAL.parent
FEW = {"beam.elements": 8, "sweep.frequency.points": 13, "sweep.direction": "up", "fidelity.all": {"reduction": "full"}}


def neutral(**own: Any) -> Any:
    return vibeam.load(NEUTRAL, set=FEW | own)


def peaks(held: str) -> dict[str, float]:
    """Peaks of flights, each over that of all modes, less 1."""
    result = vibeam.run(neutral(**{"stop.restitution_of": held}))
    return {name: result[name].peak.amplitude / result["all"].peak.amplitude - 1 for name in ("sdof", "two_modes")}


def test_the_first_answer_has_the_errors_of_flights_with_either_restitution_held() -> None:
    case = neutral()
    found = before_flight(ReductionProblem.of(case, ModesNeededPlan()))
    for choice, held in zip(found.choices, ("first mode", "contact"), strict=True):
        flown = peaks(held)
        assert choice.held.restitution_of == held
        assert choice.single.peak == pytest.approx(flown["sdof"], abs=1e-5)
        assert choice.rows[1].peak == pytest.approx(flown["two_modes"], abs=1e-5)
    here, there = found.choices
    said = first_answer(case)
    assert said.startswith("Two modes suffice for 5 % of the amplitude of all 16 modes (")
    assert f"; one degree of freedom is {percent(-here.single.peak)} too low." in said
    assert f"with R held at the contact one degree of freedom would be {percent(there.single.peak)} too high" in said


def test_nothing_is_flown_for_the_first_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def march(*_: object, **__: object) -> None:
        raise AssertionError("flown")

    monkeypatch.setattr(response, "march", march)
    tight = {"stop.gap": "-0.1 mm", "stop.gap_at": "sensor"}
    assert first_answer(neutral(**tight), final=False).endswith("The sweep is flown for the others.")
    stop = {"gap": "0 mm", "law": "linear", "stiffness": "1000 N/mm", "restitution": 0.7}
    said = first_answer(neutral(stop=stop), final=False)
    assert said.startswith(
        'No closed-form motions with the contact law "linear": all 16 modes are flown over the sweep'
    )
    assert "by what one impact loses, which claims nothing of the amplitude" in said


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("sdof_nominal", "Nothing to reduce: this case gives the SDOF model directly, there is no beam."),
        (
            "rigs/two_stops",
            "No closed-form motions with several contacts: all 64 modes are flown over the sweep to tell how many",
        ),
        (
            "matrices/dtu_modes",
            "Both modes of the case are needed for 5 %; one degree of freedom is 9.15 % too",
        ),
        ("paper/eq38", "The case has one mode, and nothing that could be left out."),
    ],
)
def test_a_case_of_another_kind_has_its_sentence(name: str, said: str) -> None:
    assert first_answer(vibeam.load(CASES / f"{name}.toml"), final=False).startswith(said)


def test_a_study_is_its_parts_in_one_sheet() -> None:
    asked: dict[str, Any] = {"accuracy": "1 %", "bases": ["modal", "residual_flexibility"], "most": 4}
    case = neutral()
    found = vibeam.modes_needed(case, **asked, modes=8, frequency="15.2 Hz")
    assert found.reduction == vibeam.reduce(case, **asked)
    assert list(found.limits) == vibeam.limit(case, modes=8, frequency="15.2 Hz")
    shown = sheet(found)
    assert shown.answer == answer(found) == first_answer(case, found.plan)
    (table,) = shown.tables
    assert list(table.columns[0].cells) == ["modal, peak, R₁ held", "modal, peak, R held", *asked["bases"]]
    assert {"plan", "before", "rows", "recommended", "limits"} <= {*shown.data}
    for wrong in (lambda: vibeam.modes_needed(case, modes=12), lambda: first_answer(case, ModesNeededPlan(modes=12))):
        with pytest.raises(ValueError, match="modes: 12 must be a power of two"):
            wrong()


def test_where_another_basis_needs_fewer_coordinates_the_answer_says_so() -> None:
    case = vibeam.load(CASES / "reductions" / "near_clamp.toml")
    said = answer(vibeam.modes_needed(case, bases=["modal", "residual_flexibility"], most=6))
    assert said.startswith("Five modes suffice for 5 % of the amplitude of all 72 modes (")
    assert said.endswith("Fewer coordinates do in another basis: residual_flexibility 2.")
