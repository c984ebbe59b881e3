"""Completion: what a shell is offered behind a beginning."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer
from stand_in import RIG

from vibeam.cli import completion
from vibeam.cli.main import app


def offered(command: str, parameter: str, begun: str) -> list[str]:
    whole = typer.main.get_command(app)
    context = whole.make_context("vibeam", [], resilient_parsing=True)
    chosen = whole.get_command(context, command)
    wanted = next(each for each in chosen.params if each.name == parameter)
    return [
        item.value for item in wanted.shell_complete(chosen.make_context(command, [], resilient_parsing=True), begun)
    ]


def test_rigs_examples_and_keys_are_offered() -> None:
    assert offered("new", "rig", "t") == ["tube", "two-beams"]
    assert offered("new", "example", "t") == ["tube", "two-beams"]
    assert offered("keys", "name", "sto") == ["stop"]
    assert {"stop.gap", "stop.gap_at"} == set(offered("keys", "name", "stop.ga"))
    assert "sweep.frequency.points=" in completion.settings("sweep.f")
    assert not [each for each in completion.settings("fidelity.") if each.startswith("fidelity.")]


def test_case_files_and_folders_are_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a.toml", "b.h5", "below/c.toml", ".hidden/d.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert offered("new", "path", "") == offered("run", "cases", "") == ["a.toml", "below/"]
    assert list(completion.case_files("below/")) == ["below/c.toml"]
    assert list(completion.case_files("none/")) == []


@pytest.mark.parametrize(("case", "found"), [(RIG, ["sdof", "two_modes", "beam"]), ("none.toml", []), (None, [])])
def test_fidelities_of_the_case_are_offered(case: object, found: list[str]) -> None:
    context = typer.Context(typer.main.get_command(app))
    for params in ({"case": case}, {"cases": [case]}):
        context.params = params
        assert list(completion.fidelities(context)) == found
