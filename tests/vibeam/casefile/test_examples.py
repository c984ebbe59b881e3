"""Examples that come with vibeam, and the short case of each rig: written, read, run."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import vibeam
from vibeam.casefile import examples
from vibeam.casefile.template import short
from vibeam.cli.main import app
from vibeam.system.response import Ended

PROJECT = Path(__file__).parents[3]
NUMBERS = {16: "sixteen", 17: "seventeen", 18: "eighteen", 19: "nineteen", 20: "twenty"}


def new(*words: object, expect: int = 0) -> str:
    result = CliRunner().invoke(app, ["new", *map(str, words)])
    assert result.exit_code == expect, result.output
    return result.output


def runs(case: Path) -> None:
    if "[record]" in case.read_text(encoding="utf-8"):
        loaded = vibeam.load(case, set={"record.duration": "0.02 s", "record.realisations": 1})
        motions = vibeam.run(loaded, show=False)
        assert all(np.all(each.ended == Ended.COMPLETE.code) for each in motions.values())
        return
    quick = {"sweep.frequency.points": 3, "sweep.settle": 20, "sweep.hold": 5}
    result = vibeam.run(vibeam.load(case, set=quick), show=False)
    for _, response in (each for branches in result.values() for each in branches.items()):
        assert np.all(response.ended == Ended.COMPLETE.code)
        assert np.all(np.isfinite(response.amplitude))


@pytest.mark.parametrize("name", examples.PLACES)
def test_an_example_is_written_with_its_files_and_runs(name: str, tmp_path: Path) -> None:
    said = new(tmp_path / f"{name}.toml", "--from", name)
    there = {file.name for file in tmp_path.iterdir()}
    assert all(file in said for file in there)
    text = (tmp_path / f"{name}.toml").read_text(encoding="utf-8")
    assert "\n# numbers:" not in text
    assert {"title", "source"} <= set(tomllib.loads(text)) or name == "frame"
    assert "[reference." in text or "[expect." in text
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    assert "is there already" in new(tmp_path / f"{name}.toml", "--from", name, expect=2)
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before
    runs(tmp_path / f"{name}.toml")


def test_examples_share_a_folder_but_not_their_files(tmp_path: Path) -> None:
    for name in ("dtu", "modes"):
        new(f"{tmp_path}/", "--from", name)
    for file in tmp_path.glob("modes.toml"):
        file.unlink()
    (tmp_path / "dtu_neutral_two_modes.csv").write_text("mine")
    assert "two_modes.csv: is there already" in new(f"{tmp_path}/", "--from", "modes", expect=2)
    assert not (tmp_path / "modes.toml").exists()
    assert (tmp_path / "dtu_neutral_two_modes.csv").read_text() == "mine"


def test_a_name_that_is_none_lists_the_examples(tmp_path: Path) -> None:
    assert new("--from", "tub", expect=2) == "--from tub: no such example; did you mean 'tube'?\n"
    assert f"known here: {', '.join(examples.PLACES)}" in new("--from", "x", expect=2)
    listed = new("--from", "list").splitlines()
    assert [line.split()[0] for line in listed if line][4:] == list(examples.PLACES)
    assert len(examples.PLACES) >= 10
    assert max(map(len, listed)) <= 80


@pytest.mark.parametrize("page", ["README.md", "cases/README.md"])
def test_a_page_has_the_number_of_examples(page: str) -> None:
    text = " ".join((PROJECT / page).read_text(encoding="utf-8").split())
    found = re.findall(r"(\w+) (?:examples that|of them) come with vibeam", text)
    assert [each.lower() for each in found] == [NUMBERS[len(examples.PLACES)]]


def test_a_wheel_has_all_examples() -> None:
    wheel = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]["targets"]
    assert wheel["wheel"]["sources"]["cases"] == "vibeam/cases"
    included = [PROJECT / place for place in wheel["wheel"]["only-include"]]
    cases = examples.folder()
    assert cases == PROJECT / "cases"
    for name, place in examples.PLACES.items():
        named = [(cases / place).parent / file for file in examples.files_of(name, examples.tables(name))]
        for file in (cases / place, *named):
            assert any(file.resolve().is_relative_to(each) for each in included), file


def test_the_short_case_has_what_a_first_run_needs(tmp_path: Path) -> None:
    new(tmp_path / "case.toml", "--short")
    lines = (tmp_path / "case.toml").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 35
    assert max(map(len, lines)) <= 120
    chosen = lines.index('restitution_of = "first mode"')
    assert lines[chosen - 1].startswith('# whose R: "first mode", ')
    del lines[chosen - 1 : chosen + 1]
    assert all("  # " in line for line in lines if not line.startswith(("#", "[")))
    runs(tmp_path / "case.toml")
    without = [line for line in short().splitlines() if not line.startswith("hold")]
    (tmp_path / "case.toml").write_text("\n".join(without), encoding="utf-8")
    with pytest.raises(vibeam.CaseError, match=r"sweep\.hold: missing"):
        vibeam.load(tmp_path / "case.toml")


@pytest.mark.parametrize("name", examples.PLACES)
def test_a_short_example_computes_the_same_with_one_comment_on_the_choice_that_matters(
    name: str, tmp_path: Path
) -> None:
    new(tmp_path / f"{name}.toml", "--from", name, "--short")
    text = (tmp_path / f"{name}.toml").read_text(encoding="utf-8")
    lines = text.splitlines()
    [comment] = [at for at, line in enumerate(lines) if "#" in line]
    told = "# a stop that yields, " if "\nlaw = " in text else "# whose R: "
    assert lines[comment].startswith(told)
    assert lines[comment + 1].startswith("law = " if "\nlaw = " in text else "restitution_of = ")
    assert len(lines[comment]) <= 120
    assert len(lines) <= 75
    short_case, case = vibeam.load(tmp_path / f"{name}.toml"), vibeam.load(examples.folder() / examples.PLACES[name])
    assert short_case.key == case.key
    assert short_case.own == case.own
    assert (short_case.title, short_case.source) == (case.title, case.source)
    assert not any((short_case.references, short_case.expectations, short_case.shows))
    named = {Path(file).name for file in examples.files_of(name, examples.tables(name)) if file in case.numbers}
    assert {file.name for file in tmp_path.iterdir()} == {f"{name}.toml"} | named


def test_the_short_rig_of_the_front_page_needs_two_modes(tmp_path: Path) -> None:
    """Not ten, as with R held at the contact."""
    new(tmp_path / "case.toml", "--short")
    case = vibeam.load(tmp_path / "case.toml")
    assert case.scene.held == ("first mode", 0.72)
    found = vibeam.modes_needed(case, accuracy="5 %").enough
    assert found is not None
    assert found.modes == 2


SDNL32 = {  # stiffness: deflection of the struck end in mm after 1, 2 … 12 ms
    "18 kN/m": [2.66, 4.33, 4.92, 4.78, 3.82, 2.87, 2.71, 3.09, 3.41, 3.36, 2.64, 0.742],
    "45 kN/m": [2.25, 2.66, 1.96, 1.15, 0.124, 0.364, 2.01, 2.74, 1.89, 0.352, -1.70, -4.99],
}


@pytest.mark.parametrize("stiffness", SDNL32)
def test_the_pinned_bar_strikes_as_code_aster_says(stiffness: str) -> None:
    """code_aster V5.02.032, astest/sdnl32a.comm: the bar turns at 3.8 rad/s when its end meets the spring; no weight.

    Its ten modes of Timoshenko's beam, integrated in steps of 10 µs, are ours to 0.04 mm.
    """
    place = PROJECT / "cases" / examples.PLACES["pinned-bar"]
    weightless = {"support.0.rotational_stiffness": "1e-6 N m/rad", "fidelity.bar.modes": 10}
    system = vibeam.load(place, set={"stop.stiffness": stiffness, **weightless}).system("bar")
    velocity = np.zeros(system.size)
    velocity[0] = 3.8 * 0.783 / system.contact[0]
    still = vibeam.Drive(omega=1.0, amplitude=0.0)
    path = vibeam.simulate(system, still, 0.0125, vibeam.State(np.zeros(system.size), velocity))
    found = [1e3 * float(path.at(1e-3 * time, "contact")) for time in range(1, 13)]
    assert found == pytest.approx(SDNL32[stiffness], abs=0.04)
