"""The report of the torture: sums, ranges of numbers counted once, findings that are mended."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from report import Span, cpu_seconds, left, machine, record, record_again, spans
from torture import PARTS
from verdict import Verdict


def span(first: int, count: int, commit: str = "a", **more: object) -> Span:
    return Span(1, first, count, commit, "m", 2.0, {"impacts": 10 * count}, {"energy": float(first)}, **more)  # type: ignore[arg-type]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "report.json"


def test_adjacent_spans_of_a_commit_are_one_and_others_are_not(file: Path) -> None:
    for each in (span(0, 5), span(10, 5), span(5, 5), span(15, 5, commit="b")):
        record("rigs", each, file)
    assert [(each.first, each.count, each.commit) for each in spans("rigs", file)] == [
        (0, 15, "a"), (15, 5, "b")
    ]  # fmt: skip
    summary = json.loads(file.read_text())["rigs"]
    assert summary["count"] == 20
    assert summary["cpu_seconds"] == 8.0
    assert summary["counts"] == {"impacts": 200}
    assert summary["worst"] == {"energy": 15.0}


def test_no_number_counts_twice(file: Path) -> None:
    record("rigs", span(0, 5), file)
    with pytest.raises(ValueError, match="already"):
        record("rigs", span(4, 5, commit="b"), file)
    record("mutants", span(4, 5), file)
    assert left("rigs", 1, range(8), file) == [5, 6, 7]
    assert left("rigs", 2, range(3), file) == [0, 1, 2]


def test_a_finding_that_no_longer_shows_is_mended(file: Path) -> None:
    record("rigs", span(0, 5, findings={"2": "hangs", "3": "NaN"}), file)
    record_again("rigs", 1, 2, "", "c", file)
    record_again("rigs", 1, 3, "inf", "c", file)
    (held,) = spans("rigs", file)
    assert held.findings == {"3": "inf"}
    assert held.mended == {"2": "hangs (not at c)"}


def test_time_and_machine_are_stated() -> None:
    assert cpu_seconds() > 0
    assert "Python" in machine()


def test_every_part_of_the_torture_is_recorded(file: Path) -> None:
    for name in PARTS:
        record(name, span(0, 1), file)
    assert list(json.loads(file.read_text())) == list(PARTS)


def test_a_finding_names_files_without_their_folders() -> None:
    verdict = Verdict()
    verdict.find('/somewhere/at/all/fig27.toml:3: stop.gap: File "/else/where/fields.py", line 7, 1/2 m/s')
    assert verdict.findings == ['fig27.toml:3: stop.gap: File "fields.py", line 7, 1/2 m/s']
