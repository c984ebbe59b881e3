"""Frequencies and damping ratios of modes as numbers of a case, without a figure that they would be read off."""

from __future__ import annotations

from typing import Any

import pytest
from stand_in import RIG

import vibeam
from vibeam.exchange.faults import CaseError
from vibeam.runs.result import Result
from vibeam.studies.regression.check import check_expectations
from vibeam.studies.regression.readings import compare


def case(number: dict[str, Any], kind: str = "expect", **further: Any) -> vibeam.Case:
    own = {"expect": {"tolerance": "1 %"}, "measured": {"source": "a decay", "uncertainty": "1 %"}}[kind]
    read = {"fidelity": "beam", "quantity": "mode_frequency", "number": 2} | own | number
    return vibeam.load(RIG, {f"{kind}.it": read, **further})


@pytest.mark.parametrize(
    ("number", "passed"),
    [
        ({"value": "101.1 Hz"}, True),
        ({"value": "98.75 Hz"}, False),
        ({"value": "7.6 Hz", "number": 1, "fidelity": "sdof"}, True),
        ({"value": "1.7 %", "quantity": "mode_damping"}, True),
        ({"value": 0.018, "quantity": "mode_damping"}, False),
        ({"value": 0, "number": 1, "against": "two_modes"}, True),
    ],
)
def test_a_mode_is_checked_without_a_figure(number: dict[str, Any], passed: bool) -> None:
    made = case(number)
    (row,) = [each for each in check_expectations(made, Result(made, {})) if each.reference == "it"]
    assert row.passed is passed


@pytest.mark.parametrize("quantity", ["mode_frequency", "mode_damping"])
def test_with_a_figure_it_is_the_same_number(quantity: str) -> None:
    number = {"quantity": quantity, "value": "100 Hz" if quantity == "mode_frequency" else "1 %"}
    alone = case(number, "measured")
    shown = case(number | {"show": "table"}, "measured", **{"show.table.kind": "modal"})
    (own,), (read,) = (compare(each, Result(each, {})) for each in (alone, shown))
    assert (own.model, own.direction, own.within) == (read.model, read.direction, False)
    assert own.model == pytest.approx({"mode_frequency": 101.1, "mode_damping": 0.017}[quantity], rel=1e-3)


@pytest.mark.parametrize(
    ("number", "further", "said"),
    [
        ({"number": None}, {}, 'it.number: missing: which mode of kind = "modal" is meant'),
        ({"frequency": "15 Hz"}, {}, 'it.frequency: kind = "modal" has no use for it: leave it away'),
        ({"value": "1 mm"}, {}, 'value: a length, but "mode_frequency" is a frequency'),
        ({"show": "gone"}, {}, "it.show: no [show.gone]"),
        ({"quantity": "energy_share", "value": 1}, {}, "missing: name the [show.NAME] that 'energy_share' is read off"),
        ({"show": "other"}, {"show.other.kind": "harmonics"}, 'it.quantity: kind = "harmonics" has "harmonic"'),
    ],
)
def test_what_is_missing_or_too_much_is_named(number: dict[str, Any], further: dict[str, Any], said: str) -> None:
    given = {name: value for name, value in ({"value": "100 Hz", "number": 2} | number).items() if value is not None}
    read = {"fidelity": "beam", "quantity": "mode_frequency", "tolerance": "1 %"} | given
    with pytest.raises(CaseError) as caught:
        vibeam.load(RIG, {"expect.it": read, **further})
    assert said in str(caught.value)


def test_a_mode_that_the_model_has_not_is_a_miss_with_its_reason() -> None:
    made = case({"value": "7.6 Hz", "fidelity": "sdof"})
    (row,) = [each for each in check_expectations(made, Result(made, {})) if each.reference == "it"]
    assert (row.passed, [note for note in row.notes if "there is none" in note] != []) == (False, True)


def test_the_table_of_modes_is_of_the_fidelity_that_is_named() -> None:
    further = {"fidelity.heavy": {"reduction": "modal", "modes": 2, "set": {"mass.mass": "0.9 kg"}}}
    made = vibeam.load(RIG, further)
    own, usual = vibeam.modes(made, 2, fidelity="heavy"), vibeam.modes(made, 2)
    assert own.rows[0].frequency < 0.9 * usual.rows[0].frequency
    assert vibeam.modes(made, 2, fidelity="beam") == usual
    with pytest.raises(KeyError, match="no fidelity 'gone': there are sdof, two_modes, beam, heavy"):
        vibeam.modes(made, fidelity="gone")
