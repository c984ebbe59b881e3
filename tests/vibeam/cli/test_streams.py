"""The command's standard streams: encodings without the characters, readers that went away, a full device."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer
from rich.console import Console
from typer.testing import CliRunner

from vibeam.cli import progress
from vibeam.cli.errors import mistakes
from vibeam.cli.main import app
from vibeam.cli.progress import Bar
from vibeam.cli.streams import put, standard_streams

RIG = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
MODES = ("modes", str(RIG), "--count", "2")


def vibeam(*words: str, **options: Any) -> subprocess.CompletedProcess[bytes]:
    """The command in a process of its own; ``environment`` and what ``subprocess.run`` takes as options."""
    places = os.pathsep.join(path for path in sys.path if path)
    environment = os.environ | {"PYTHONPATH": places} | options.pop("environment", {})
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.run([sys.executable, "-m", "vibeam", *words], env=environment, check=False, **options)


C_LOCALE = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize("environment", [C_LOCALE, {"PYTHONIOENCODING": "ascii:strict"}])
def test_tables_have_escapes_where_the_encoding_lacks_their_characters(environment: dict[str, str]) -> None:
    done = vibeam(*MODES, environment=environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert r"R\u2081 seen" in done.stdout.decode("ascii")


def test_json_is_the_same_in_every_encoding() -> None:
    words = ("derive", str(RIG), "--json")
    rows = json.loads(vibeam(*words, environment={"PYTHONIOENCODING": "ascii"}).stdout)
    assert rows == json.loads(CliRunner().invoke(app, words).stdout)  # in UTF-8
    assert rows["rows"][0]["symbol"] == "φ(L_m)"


@pytest.mark.parametrize("words", [MODES, ("--help",), ("--version",), ("keys", "--json")])
def test_a_reader_that_has_gone_ends_the_command_in_silence(words: tuple[str, ...]) -> None:
    there, here = os.pipe()
    os.close(there)
    try:
        done = vibeam(*words, stdout=here)
    finally:
        os.close(here)
    assert done.stderr == b""
    assert done.returncode in (1, 141)


@pytest.mark.parametrize("words", [("keys",), ("keys", "--json"), ("--help",), ("--version",)])
def test_a_full_device_is_one_message(words: tuple[str, ...]) -> None:
    with open("/dev/full", "wb") as full:
        done = vibeam(*words, stdout=full)
    assert (done.returncode, done.stderr) == (2, b"stdout: no space left on device\n")


def test_control_characters_of_a_file_name_are_escapes(tmp_path: Path) -> None:
    name = "a\x1b[2J\u202e.toml"
    (tmp_path / name).write_text("", encoding="utf-8")
    done = vibeam("check", name, cwd=tmp_path)
    assert done.stderr.decode().startswith(r"a\x1b[2J\u202e.toml: is empty")
    made = vibeam("new", "--out", "b\x1b.toml", cwd=tmp_path)
    assert made.stdout.decode().startswith(r"wrote b\x1b.toml: ")
    assert json.loads(vibeam("new", "c\x9b.toml", "--json", cwd=tmp_path).stdout)["written"] == "c\x9b.toml"


@pytest.mark.parametrize("width", [40, 60, 80, 120])
def test_progress_keeps_count_elapsed_and_remaining_in_a_narrow_terminal(width: int) -> None:
    """Words go first, then the bar; nothing is elided."""
    shown = io.StringIO()
    with Bar(console=Console(file=shown, force_terminal=True, width=width, color_system=None)) as bar:
        bar(0, 123456)
        bar(12345, 123456)
    last = shown.getvalue().replace("\x1b[?25h", "").split("\r")[-2]
    assert re.search(r"12345/123456 .*· 0:00:00 · (remaining )?(-:--:--|\d:\d\d:\d\d)", last), last
    assert "…" not in last
    assert ("sweeping on up to" in last, "remaining" in last) == (width >= 120, width >= 60)


class Rig:
    """Stands in for the overview of a case."""

    def __str__(self) -> str:
        return "beam 180 mm long; mode 1 at 15 Hz"

    def warnings(self) -> list[str]:
        return ["look at the units"]


@pytest.mark.parametrize(
    ("terminal", "first"), [(True, ["beam 180 mm long;", "mode 1 at 15 Hz"]), (False, [str(Rig())])]
)
def test_the_overview_is_broken_in_a_terminal_alone(
    terminal: bool, first: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = io.StringIO()
    console = Console(file=shown, force_terminal=terminal, width=20, color_system=None, soft_wrap=True)
    monkeypatch.setattr(progress, "stderr", lambda: console)
    progress.tell_overview(Rig())  # type: ignore[arg-type]
    said = shown.getvalue().splitlines()
    assert said[: len(first)] == first
    assert "".join(said[len(first) :]).replace(" ", "") == "warning:lookattheunits"


def test_lines_of_progress_are_printed() -> None:
    shown = io.StringIO()
    with Bar("cost", Console(file=shown, force_terminal=True, width=80, color_system=None)) as bar:
        bar("first")
        bar("second")
    assert shown.getvalue() == "first\nsecond\n"


def test_progress_in_a_notebook_is_an_element_of_its_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    """IPython's two names that it needs, stood in for: ``display`` gives a handle whose ``update`` replaces it."""
    shown: list[str] = []
    place = SimpleNamespace(update=shown.append)
    stand_in = SimpleNamespace(HTML=str, display=lambda text, display_id: place)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(display=stand_in))
    with Bar("a < b", Console(file=io.StringIO(), force_jupyter=True)) as bar:
        bar(0, 4)
        bar(4, 4)
    assert shown[-2:] == ['<progress value="4" max="4"></progress> a &lt; b: 4 of 4 points', ""]


def test_text_that_is_pending_after_a_failed_write_is_not_told_twice(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def printed() -> None:
        with standard_streams(), mistakes():
            full.buffer.write(b"x")
            put("y" * 100_000)

    with open("/dev/full", "w", encoding="utf-8") as full:
        monkeypatch.setattr(sys, "stdout", full)
        with pytest.raises((typer.Exit, SystemExit)):
            printed()
    assert capfd.readouterr().err == "stdout: no space left on device\n"
