"""Numbers that were measured: beside the model's, within the uncertainty or not, never a verdict."""

from __future__ import annotations

import json
from dataclasses import replace
from io import StringIO
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from stand_in import curve, one_mode

from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.report.checks import measurements
from vibeam.report.output import to_json
from vibeam.runs.result import Result
from vibeam.studies.regression.check import check_expectations as check
from vibeam.studies.regression.readings import MeasuredRow, compare
from vibeam.system.response import Branches

GRID = np.array([14.0, 15.0, 16.0])
CASE = one_mode("[14.0, 15.0, 16.0]", 1, 1, "[fidelity.ours]", "[fidelity.theirs]", direction="both")
MEASURED = '[measured.it]\nfidelity = "ours"\nsource = "Fig. 3"\n'
SAME = Branches(curve(GRID, [1.0, 3.0, 2.0]), curve(GRID[::-1], [2.0, 3.0, 1.0]))
APART = Branches(curve(GRID, [1.0, 3.0, 2.0]), curve(GRID[::-1], [2.0, 2.5, 1.0]))
THEIRS = Branches(curve(GRID, [1.0, 2.0, 2.0]), curve(GRID[::-1], [2.0, 2.0, 1.0]))


def rows(lines: str, ours: Branches = SAME) -> list[MeasuredRow]:
    case = parse(f"{CASE}{MEASURED}{lines}\n")
    return compare(case, Result(case, {"ours": ours, "theirs": THEIRS}))


@pytest.mark.parametrize(
    ("uncertainty", "within"),
    [
        ("uncertainty = 0.51", True),
        ("uncertainty = 0.49", False),
        ('uncertainty = "20.1 %"', True),
        ('uncertainty = "19 %"', False),
        ("", None),
    ],
)
def test_a_number_within_the_scatter_or_not(uncertainty: str, within: bool | None) -> None:
    """The model's 3.0 is 0.5 above the measured 2.5, which is 20 % of 2.5."""
    (row,) = rows(f'quantity = "peak"\nvalue = 2.5\n{uncertainty}')
    assert (row.model, row.difference, row.within) == (3.0, 0.5, within)
    assert not row.chose


def test_branches_that_differ_have_a_row_each() -> None:
    chosen = '[chosen_by]\n"stop.gap" = ["it"]\n'
    up, down = rows(f'quantity = "peak"\nvalue = 2.8\n{chosen}', APART)
    assert [(row.direction, row.model, row.chose) for row in (up, down)] == [
        ("up", 3.0, ("stop.gap",)),
        ("down", 2.5, ("stop.gap",)),
    ]


def test_a_difference_of_two_fidelities() -> None:
    (row,) = rows('quantity = "peak"\nagainst = "theirs"\nvalue = "40 %"\nuncertainty = "11 %"')
    assert (row.unit, row.model, row.within) == ("1", 0.5, True)


def test_a_number_that_the_model_does_not_have_says_why_once() -> None:
    (row,) = rows('quantity = "amplitude"\nfrequency = 15.5\nvalue = 2.8\nuncertainty = 0.1')
    assert np.isnan(row.model)
    assert np.isnan(row.difference)
    assert (row.within, row.notes) == (None, ("15.5 Hz is not in the sweep's grid",))


def test_a_measured_number_changes_no_key_and_is_no_expectation() -> None:
    case = parse(f'{CASE}{MEASURED}quantity = "peak"\nvalue = 2.8\n')
    assert case.key == parse(CASE).key
    assert not case.expectations
    assert parse(case.text).text == case.text


@pytest.mark.parametrize("uncertainty", ["7 %", "0.07 %", "12.5 %", "1e-3 %"])
def test_a_percentage_is_written_back_as_it_was_read(uncertainty: str) -> None:
    case = parse(f'{CASE}{MEASURED}quantity = "peak_frequency"\nvalue = "15.3 Hz"\nuncertainty = "{uncertainty}"\n')
    assert parse(case.text).measured == case.measured


@pytest.mark.parametrize(
    ("lines", "fault"),
    [
        ('quantity = "peak_frequency"\nvalue = "3 mm"', 'value: a length, but "peak_frequency" is a frequency'),
        ('quantity = "peak"\nvalue = "3 mm"', 'value: a length, but "peak" is a plain number'),
        (
            'quantity = "period"\nvalue = 2\nuncertainty = "3 Hz"',
            'uncertainty: a frequency, but "period" is a plain number',
        ),
        ('quantity = "peak_frequency"\nvalue = "3 %"', 'value: a percentage, but "peak_frequency" is a frequency'),
        ('quantity = "peak"\nvalue = 3\nuncertainty = 0', "uncertainty: 0 must be > 0"),
        ('quantity = "peak"\nvalue = "3 kg"', "value: '3 kg' is a mass, not a plain number"),
        ('quantity = "reach"\nvalue = 3', 'frequency: missing: "reach" is read at one frequency'),
        ('quantity = "peak"\nvalue = 3\nagainst = "their"', "against: no fidelity 'their'; did you mean 'theirs'?"),
    ],
)
def test_wrong_tables_are_told(lines: str, fault: str) -> None:
    with pytest.raises(CaseError) as caught:
        parse(f"{CASE}{MEASURED}{lines}\n")
    assert fault in str(caught.value)


def test_a_source_is_required() -> None:
    with pytest.raises(CaseError, match=r"measured\.it\.source: missing"):
        parse(f'{CASE}[measured.it]\nfidelity = "ours"\nquantity = "peak"\nvalue = 3\n')


def test_an_expected_number_without_a_source_is_a_regression_value() -> None:
    table = '[expect.{0}]\nfidelity = "ours"\nquantity = "peak"\nvalue = 3\ntolerance = "1 %"\n'
    case = parse(CASE + table.format("own") + table.format("known") + 'source = "closed form"\n')
    found = check(case, Result(case, {"ours": SAME, "theirs": THEIRS}))
    assert [(row.reference, row.kind) for row in found] == [("own", "regression value"), ("known", "reference")]


ROW = MeasuredRow(
    "it", "beam", "ringing_frequency", None, None, 15.0, "both", "Hz", 103.0, 0.5, 101.0, -2.0, False, (), "Fig. 27"
)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ["103 Hz", "0.5 Hz", "101 Hz", "-2 Hz (-1.94 %)", "no", "predicted", "Fig. 27"]),
        ({"chose": ("beam.width", "beam.length"), "within": True}, ["yes", "calibrated", "beam.width, beam.length"]),
        ({"uncertainty": None, "within": None}, ["nothing where that is not given"]),
        (
            {"unit": "m/s", "value": 0.035, "model": 0.0223, "difference": -0.0127},
            ["35 mm/s", "22.3 mm/s", "-12.7 mm/s"],
        ),
        ({"unit": "m", "value": 5e-5, "model": 4e-5, "difference": -1e-5}, ["0.05 mm", "-0.01 mm (-20 %)"]),
        ({"number": 2.0, "direction": "up"}, ["ringing_frequency 2 ↑"]),
        ({"notes": ("there is none",), "model": np.nan, "difference": np.nan}, ["there is none"]),
    ],
)
def test_the_table_says(change: dict[str, Any], words: list[str]) -> None:
    console = Console(file=StringIO(), width=250)
    console.print(measurements([replace(ROW, **change)]))
    text = console.file.getvalue()  # type: ignore[attr-defined]
    assert all(word in text for word in words), text


def test_json_names_the_kind_and_has_no_verdict() -> None:
    row = json.loads(to_json([ROW]))[0]
    assert (row["kind"], row["value"], row["model"]) == ("measured", 103.0, 101.0)
    assert "passed" not in row
