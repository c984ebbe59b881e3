"""Tables at every width: no number is cut, every row keeps its name, and 80 columns hold the main table."""

from __future__ import annotations

from dataclasses import replace

import pytest
from rich.cells import cell_len
from rich.text import Text
from stand_in import case, curve

from vibeam.casefile.documentation import reference_table
from vibeam.periodic.motion_kind import FREE, SteadyKind
from vibeam.report import tables as table
from vibeam.report.checks import checks
from vibeam.report.derive import derivation
from vibeam.report.run_report import details, fidelities
from vibeam.report.tables import ReportTable, fitted
from vibeam.runs.comparison.ends import SweptEnd
from vibeam.runs.comparison.errors import AmplitudeError, ComparedFidelity, EndError, KindDifference, ResponseComparison
from vibeam.runs.result import Result
from vibeam.runs.summary import Summary, compare
from vibeam.studies.derive import DerivedParameter
from vibeam.studies.regression.references import CheckRow
from vibeam.system.response import Branches, Difference, Peak


def summary(name: str, modes: int) -> Summary:
    """The widest numbers that the main table of the neutral rig has."""
    ends = (14.125, 16.675)
    return Summary(
        name, modes, Peak(0.3866e-3, 15.525, "down", 1, True), {"up": ends, "down": ends},
        Difference(-0.1, 0.2121, 0.315, 60, 61), 0.01234, 123.4, 123456, 12, 0.7212, -0.6041,
    )  # fmt: skip


def compared_with(reference: str, name: str) -> ComparedFidelity:
    """Errors as wide as the neutral rig's with R held at the contact."""
    end = SweptEnd(15.3, 0.0, SteadyKind(1, 1), SteadyKind(FREE), "up", -0.9)
    kind = KindDifference(14.1, 16.2, 0.0, "up", SteadyKind(1, 1), SteadyKind(2, 2))
    found = ResponseComparison(
        AmplitudeError(0.321, 15.3, "up", 1.0, 1.0), None, (EndError(0.096, 0.0, end, end),), (kind,)
    )
    return ComparedFidelity(name, reference, found, 8)


SUMMARIES = [summary("sdof", 1), summary("two_modes", 2), summary("beam", 8)]
COMPARED = {each.fidelity: compared_with("beam" if each.modes < 8 else "", each.fidelity) for each in SUMMARIES}
MISSED = CheckRow("exact", "two_modes", "amplitude", 3, 4, 0.0123, 15.2, 0.01, False, ("one is off by much",))
TABLES = {
    "fidelities": lambda: fidelities(SUMMARIES, COMPARED, finest=["beam"]),
    "details": lambda: details(SUMMARIES),
    "checks": lambda: checks([MISSED]),
    "keys": lambda: table.keys(reference_table()),
    "derivation": lambda: derivation(
        [DerivedParameter("mass, massless beam", "M_S", "kg", 0.41321, 0.40011, "point mass")]
    ),
}


def cells(shown: ReportTable, right: bool) -> list[str]:
    return [str(cell) for column in shown.columns if (column.justify == "right") is right for cell in column.cells]


def printed(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, name: str, width: int) -> str:
    """What a terminal of that width shows."""
    for key, value in {"FORCE_COLOR": "1", "COLUMNS": str(width), "NO_COLOR": "1", "TERM": "xterm"}.items():
        monkeypatch.setenv(key, value)
    table.print_table(TABLES[name]())
    return Text.from_ansi(capsys.readouterr().out).plain


@pytest.mark.parametrize("width", [40, 60, 80, 120])
@pytest.mark.parametrize("name", TABLES)
def test_no_number_is_cut_and_nothing_is_wider_than_the_terminal(
    name: str, width: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = printed(capsys, monkeypatch, name, width)
    for number in cells(TABLES[name](), right=True):
        assert number in text
    ours = sum(cell.count("…") for right in (True, False) for cell in cells(TABLES[name](), right))
    assert text.count("…") == ours  # of the cells themselves
    assert width < 60 or max(map(cell_len, text.splitlines())) <= width


def test_eighty_columns_hold_the_main_tables() -> None:
    assert len(fitted(TABLES["fidelities"](), 80)) == 1
    assert len(fitted(TABLES["fidelities"](), 50)) == 2


def test_every_further_table_says_what_its_rows_are_about() -> None:
    first, second = fitted(TABLES["fidelities"](), 50)
    assert list(second.columns[0].cells) == list(first.columns[0].cells) == ["sdof", "two_modes", "beam"]
    assert second.title == "Fidelities, continued"
    shown = [str(column.header) for column in [*first.columns, *second.columns[second.heads :]]]
    assert shown == [str(column.header) for column in TABLES["fidelities"]().columns]


def test_a_column_that_says_nothing_is_left_out() -> None:
    passed = replace(MISSED, passed=True, notes=())
    headers = [[str(column.header) for column in fitted(checks(rows), 160)[0].columns] for rows in ([passed], [])]
    assert "why" not in headers[0]
    assert "why" in headers[1]  # of no rows at all the head is all there is
    assert "why" in [str(column.header) for column in fitted(checks([passed, MISSED]), 160)[0].columns]


def test_what_goes_into_a_file_is_a_hundred_columns_wide_at_most(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    for made in TABLES.values():
        table.print_table(made())
        assert max(map(cell_len, capsys.readouterr().out.splitlines())) <= table.USUAL


def test_a_long_table_is_cut_and_says_so() -> None:
    whole = TABLES["keys"]()
    short = table.cut(whole, 20)
    assert table.height(short) <= 20
    assert f"(first {len(short.rows)} of {len(whole.rows)} rows, all with -v)" in str(short.title)
    assert table.cut(short, 20) is short


def test_columns_of_details_are_left_out_of_the_brief_table() -> None:
    whole = table.blank("A", "name", "value|")
    whole.add("why", detail=True)
    whole.add("unit")
    whole.add_row("a", "1", "because", "m")
    brief = whole.brief()
    assert [str(column.header) for column in brief.columns] == ["name", "value", "unit"]
    assert [list(column.cells) for column in brief.columns] == [["a"], ["1"], ["m"]]


def test_a_terminal_narrower_than_a_number_gets_the_number() -> None:
    pieces = fitted(TABLES["details"](), 5)
    assert all(len(piece.columns) == 2 for piece in pieces)
    assert all(
        column.width == len("period") + 7
        for piece in pieces
        for column in piece.columns
        if "14" in str(list(column.cells))
    )


def test_the_direction_of_the_peak_is_told_by_an_arrow() -> None:
    one = Branches(curve([14, 15], [1e-3, 2e-3]), curve([15, 14], [1e-3, 3e-3]))
    rows = compare(Result(case(), {"one": one}, None, 0, {}))
    assert list(fidelities(rows, {}).columns[3].cells) == ["14 ↓"]
