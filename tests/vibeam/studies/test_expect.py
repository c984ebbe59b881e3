"""Single numbers that a case expects: met, missed, absent."""

from __future__ import annotations

import numpy as np
import pytest
from stand_in import curve, one_mode

from vibeam.case.plans import Expectation
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.runs.result import Result
from vibeam.studies.regression.check import check_expectations as check
from vibeam.studies.regression.references import CheckRow
from vibeam.system.response import Branches, Ended

GRID = np.array([14.0, 15.0, 16.0])
EXPECTING = ("[fidelity.ours]", "[fidelity.theirs]", "[expect.it]", 'fidelity = "ours"')
CASE = one_mode("[14.0, 15.0, 16.0]", 1, 1, *EXPECTING, direction="both")
OURS = Branches(curve(GRID, [1.0, 3.0, 2.0], [1, 1, 2]), curve(GRID[::-1], [2.0, 3.0, 1.0], [2, 1, 1]))
THEIRS = Branches(curve(GRID, [1.0, 2.0, 2.0]), curve(GRID[::-1], [2.0, 2.0, 1.0]))


def row(*lines: str, ours: Branches = OURS, partial: bool = False) -> CheckRow:
    case = parse(CASE + "\n".join(lines) + "\n")
    (found,) = check(case, Result(case, {"ours": ours, "theirs": THEIRS}), partial=partial)
    return found


def test_a_case_reads_what_it_expects() -> None:
    case = parse(CASE + 'quantity = "peak_frequency"\nvalue = "100 rad/s"\ntolerance = "1 %"\n')
    expected = Expectation(
        name="it",
        fidelity="ours",
        quantity="peak_frequency",
        frequency=None,
        against=None,
        direction="both",
        value=100 / (2 * np.pi),
        tolerance=0.01,
    )
    assert case.expectations == {"it": expected}
    assert case.key == parse(CASE.split("[expect")[0]).key


@pytest.mark.parametrize(
    ("quantity", "value", "tolerance", "passed"),
    [
        ("amplitude", 3.0, "0.1 %", True),
        ("amplitude", 3.1, "4 %", True),
        ("amplitude", 3.1, "3 %", False),
        ("peak", 3.0, "0.1 %", True),
        ("peak_frequency", 15.0, "0.1 %", True),
        ("peak_frequency", 15.1, "0.1 %", False),
        ("period_one_from", 14.0, "0.1 %", True),
        ("period_one_to", 15.0, "0.1 %", True),
        ("period_one_to", 16.0, "0.1 %", False),
        ("period", 1, "0.1 %", True),
        ("period", 2, "0.1 %", False),
    ],
)
def test_a_number(quantity: str, value: float, tolerance: str, passed: bool) -> None:
    where = [] if quantity.startswith(("peak", "period_")) else ["frequency = 15.0"]
    found = row(f'quantity = "{quantity}"\nvalue = {value}\ntolerance = "{tolerance}"', *where)
    assert (found.passed, found.points, found.total) == (passed, 2, 2)


@pytest.mark.parametrize(("value", "passed"), [("50 %", True), ("52 %", False), ("-33 %", False)])
def test_a_number_against_another_fidelity(value: str, passed: bool) -> None:
    text = f'quantity = "amplitude"\nfrequency = 15.0\nagainst = "theirs"\nvalue = "{value}"\ntolerance = "1 %"'
    found = row(text)
    assert found.passed is passed
    assert found.notes[0].startswith("+50.00 % against theirs, expected")


def test_nothing_expected_is_a_number_too() -> None:
    text = 'quantity = "amplitude"\nfrequency = 14.0\nagainst = "theirs"\nvalue = 0\ntolerance = "1 %"'
    assert row(text).passed


def test_a_failed_point_is_missed_with_its_reason() -> None:
    failed = Branches(curve(GRID, 1.0, ended=Ended.NO_ORBIT.code), OURS.down)
    found = row('quantity = "amplitude"\nfrequency = 15.0\nvalue = 3.0\ntolerance = "1 %"', ours=failed)
    assert not found.passed
    assert "no stable motion" in found.notes[0]
    assert found.notes[1:] == ("3, expected 3",)  # of the other branch alone


def test_a_share_of_nothing_is_missed_with_its_reason() -> None:
    text = 'quantity = "amplitude"\nfrequency = 15.0\nagainst = "theirs"\nvalue = 0\ntolerance = "1 %"'
    case = parse(CASE + text + "\n")
    still = Branches(curve(GRID, 0.0), curve(GRID[::-1], 0.0))
    (found,) = check(case, Result(case, {"ours": OURS, "theirs": still}))
    assert not found.passed
    assert found.notes == tuple(f"{way}: theirs is 0 there: nothing to compare with" for way in ("up", "down"))


def test_a_frequency_beside_the_grid_is_missed_unless_the_grid_was_overridden() -> None:
    text = 'quantity = "amplitude"\nfrequency = 15.5\nvalue = 3.0\ntolerance = "1 %"'
    found = row(text)
    assert (found.passed, found.points) == (False, 0)
    assert found.notes == ("15.5 Hz is not in the sweep's grid",)
    assert row(text, partial=True).passed


def test_one_direction_alone() -> None:
    text = 'quantity = "amplitude"\nfrequency = 15.0\nvalue = 3.0\ntolerance = "1 %"\ndirection = "up"'
    other = Branches(OURS.up, curve(GRID[::-1], 9.0))
    assert row(text, ours=other).passed
    assert not row(text.replace('"up"', '"both"'), ours=other).passed


@pytest.mark.parametrize(
    ("lines", "key", "fault"),
    [
        ('quantity = "peak"\nfrequency = 15.0', "frequency", '"peak" is of a whole branch: leave the frequency away'),
        ('quantity = "reach"', "frequency", 'missing: "reach" is read at one frequency'),
        ('quantity = "peak"\nagainst = "their"', "against", "no fidelity 'their'; did you mean 'theirs'?"),
    ],
)
def test_wrong_tables_are_told(lines: str, key: str, fault: str) -> None:
    with pytest.raises(CaseError) as caught:
        parse(CASE + lines + '\nvalue = 1\ntolerance = "1 %"\n')
    assert [(each.key, each.message) for each in caught.value.faults] == [(f"expect.it.{key}", fault)]


def test_a_value_is_a_number_a_percentage_or_a_frequency() -> None:
    with pytest.raises(CaseError, match="'3 kg' is a mass, not a plain number"):
        parse(CASE + 'quantity = "peak"\nvalue = "3 kg"\ntolerance = "1 %"\n')
