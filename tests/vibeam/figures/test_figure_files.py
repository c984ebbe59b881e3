"""Figures are drawn again where their results, their case or a file changed, and not otherwise."""

from __future__ import annotations

from pathlib import Path

import pytest
from figures import SDOF

from vibeam.casefile.read import parse
from vibeam.figures.files import all_current, figure_files, stamp
from vibeam.report.figures import write_figures
from vibeam.runs.run import run

CASE = SDOF + '[figure]\nformat = ["png", "svg", "pdf"]\n[show.period]\nkind = "curve"\nquantity = "period"\n'


def drawn(text: str, out: Path) -> dict[str, int]:
    """Files of the figures after a run, with their times of writing."""
    result = run(parse(text), out, tell=lambda line: None)
    return {file.name: file.stat().st_mtime_ns for file in write_figures(result, out)}


@pytest.mark.usefixtures("undrawn")
def test_complete_figures_stay(tmp_path: Path) -> None:
    first = drawn(CASE, tmp_path / "a.h5")
    assert sorted(first) == sorted(f"a{part}.{end}" for part in ("", "_period") for end in ("png", "svg", "pdf"))
    assert drawn(CASE, tmp_path / "a.h5") == first


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("change", ["title", "a file is gone", "another picture", "results"])
def test_figures_follow_what_they_show(change: str, tmp_path: Path) -> None:
    out, text = tmp_path / "a.h5", CASE
    first = drawn(text, out)
    if change == "title":
        text = f'title = "another"\n{text}'
    elif change == "a file is gone":
        (tmp_path / "a_period.svg").unlink()
    elif change == "another picture":
        (tmp_path / "a.png").write_bytes(b"\x89PNG")
    else:
        text = text.replace('"2.1 rad/s"', '"2.2 rad/s"')
    again = drawn(text, out)
    assert again.keys() == first.keys()
    assert all(again[name] != first[name] for name in first)


def test_a_stamp_stands_in_every_file(tmp_path: Path) -> None:
    out, case = tmp_path / "a.h5", parse(CASE)
    write_figures(run(case, out), out)
    mark = stamp(out, case)
    assert all_current(figure_files(out, case), mark)
    assert not all_current(figure_files(out, case), mark[:-1] + "x")
