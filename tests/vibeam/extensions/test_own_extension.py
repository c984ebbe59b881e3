"""A package of a user's own that is found by its entry point; extensions that are absent, or cannot be loaded."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam_models import extensions
from vibeam_models.beam import assemble_with_space
from vibeam_models.extensions import Extension, ExtensionError, ExtensionPoint
from vibeam_models.registry import Home, Registry

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "tests" / "support" / "wire_package"
NEUTRAL = (ROOT / "cases" / "dtu_neutral.toml").read_text(encoding="utf-8").partition("[fidelity.sdof]")[0]
CASE = f"""{NEUTRAL}
[wire]
stiffness = "80 N/m"
position = "60 mm"

[fidelity.plain]
reduction = "modal"
modes = 1

[fidelity.held]
model = "wire"
reduction = "modal"
modes = 1

[show.stiffened]
kind = "stiffened"

[wires]
most = "200 N/m"
"""
SHORT = [f"--set=sweep.{key}={value}" for key, value in {"frequency.points": 2, "settle": 3, "hold": 3}.items()]


def command(folder: Path, *words: str, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    """``vibeam`` of a fresh interpreter in a folder, with the packages that lie at ``path``."""
    places = os.pathsep.join(map(str, [*[path] * bool(path), *(ROOT / part for part in ("", "models", "reductions"))]))
    asked = [sys.executable, "-m", "vibeam", *words]
    return subprocess.run(asked, cwd=folder, env=os.environ | {"PYTHONPATH": places}, capture_output=True, text=True)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "own.toml").write_text(CASE, encoding="utf-8")
    return tmp_path


def first_omega(stiffness: float) -> float:
    """Lowest natural frequency of the rig with a spring at 60 mm, by its matrices."""
    structure, space = assemble_with_space(vibeam.load(ROOT / "cases" / "dtu_neutral.toml").scene)
    row = space.row(0.06)
    return float(structure.with_(K=structure.K + stiffness * np.outer(row, row)).modes(1).omega[0])


def test_the_package_is_small() -> None:
    assert sum(len(file.read_text("utf-8").splitlines()) for file in PACKAGE.rglob("*.py")) <= 80


def test_a_package_of_ones_own_brings_table_model_figure_study_command_and_section(folder: Path) -> None:
    package = folder / "site"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    run = command(folder, "run", "own.toml", "-q", *SHORT, path=package)
    assert (run.returncode, run.stderr) == (0, "")
    assert (folder / "own_stiffened.svg").exists()
    study = json.loads(command(folder, "wires", "own.toml", "--json", "--most", "300 N/m", path=package).stdout)
    assert study["rows"] == [{"omega": pytest.approx(first_omega(300.0), rel=1e-9)}]
    assert command(folder, "study", "wires", "own.toml", "--out", "wires.html", path=package).returncode == 0
    assert "frequencies under wires" in (folder / "wires.html").read_text("utf-8").lower()
    assert command(folder, "report", "own.h5", "--no-engine", path=package).returncode == 0
    page = (folder / "own.html").read_text("utf-8")
    assert '<a href="#wires">Wires</a>' in page
    assert "Wires up to 200 N/m hold the beam." in page
    assert "Frequencies under wires." in command(folder, "-h", path=package).stdout
    wrong = command(folder, "run", "own.toml", "--set", "wire.stiffnes=3 N/m", path=package)
    assert (wrong.returncode, wrong.stderr) == (2, "--set wire.stiffnes: unknown key; did you mean 'stiffness'?\n")


def test_without_the_package_its_names_are_unknown(folder: Path) -> None:
    done = command(folder, "run", "own.toml")
    assert done.returncode == 2
    assert "fidelity.held.model: 'wire' is not one of" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_package_that_cannot_be_imported_is_named_with_the_cure(folder: Path) -> None:
    package = folder / "site"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "wire" / "__init__.py").write_text("import nowhere_at_all\n", encoding="utf-8")
    for words in (["run", "own.toml"], ["-h"], ["keys"]):
        done = command(folder, *words, path=package)
        assert done.returncode == 2
        said = "extension 'wire' of the package 'wire': wire:EXTENSION cannot be loaded: No module"
        assert done.stderr.startswith(said)
        assert done.stderr.endswith("; install wire again, or uninstall it\n")


def test_what_an_extension_brings_must_be_of_a_known_kind() -> None:
    with pytest.raises(ValueError, match="brings solvers: what can be brought is effect, contact law"):
        Extension({"solvers": "mine:SOLVERS"})


MINE = (Home("a", int), Home("taken", int))


def test_two_declarations_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    point = ExtensionPoint("mine", f"{__name__}:EXTENSION", "mine")
    monkeypatch.setattr(extensions, "entry_points", lambda: (point,))
    monkeypatch.setattr(sys.modules[__name__], "EXTENSION", Extension({"effect": f"{__name__}:MINE"}), raising=False)
    assert list(Registry[Home]("effect", Home("b", int))) == ["b", "a", "taken"]
    with pytest.raises(ExtensionError, match="'mine': effect 'taken' is declared already: uninstall one"):
        list(Registry[Home]("effect", Home("taken", int)))


ABSENT = {
    "fidelity.sdof.solver=averaging": "fidelity.sdof.solver: 'averaging'",
    "mode_share.speed=1": "--set mode_share: unknown key",
    'expect.a={ fidelity = "sdof", quantity = "largest_gap", value = "1 mm", tolerance = "1 %", source = "x" }':
        "expect.a.quantity: 'largest_gap'",
}  # fmt: skip


@pytest.fixture
def hidden(tmp_path: Path) -> Path:
    """Folder of an installation of vibeam that registers no extension, as one that is older than the checkout."""
    made = tmp_path / "older" / "vibeam-0.1.0.dist-info"
    made.mkdir(parents=True)
    (made / "METADATA").write_text("Metadata-Version: 2.1\nName: vibeam\nVersion: 0.1.0\n", encoding="utf-8")
    return made.parent


@pytest.mark.parametrize(("setting", "said"), ABSENT.items())
def test_a_case_that_names_what_an_absent_extension_brings_is_told_the_cure(
    setting: str, said: str, hidden: Path
) -> None:
    case = str(ROOT / "cases" / "dtu_neutral.toml")
    done = command(hidden, "run", case, "--set", setting, path=hidden)
    assert (done.returncode, "Traceback" in done.stderr) == (2, False)
    (line,) = [each for each in done.stderr.splitlines() if "extension" in each]
    assert said in line
    assert line.endswith(", which is not registered: install vibeam again (pip install)")


def test_commands_of_absent_extensions_are_told_with_the_cure(hidden: Path) -> None:
    case = str(ROOT / "cases" / "dtu_neutral.toml")
    (hidden / "a.csv").write_text("t,x\n0,1\n", encoding="utf-8")
    for words, name in ((["explore", case], "explore"), (["mode_share", case], "dictionary"),
                        (["fit", "a.csv"], "identification")):  # fmt: skip
        done = command(hidden, *words, path=hidden)
        assert (done.returncode, "Traceback" in done.stderr) == (2, False)
        assert f"the extension {name!r}, which is not registered: install vibeam again" in done.stderr
    assert "explore" not in command(hidden, "-h", path=hidden).stdout
    assert command(hidden, "derive", case, path=hidden).returncode == 0


def test_what_is_said_of_absent_extensions_is_what_they_bring() -> None:
    """Names of their declarations, and those that programs have of them."""
    brought: dict[str, set[str]] = {}
    for kind in extensions.KINDS:
        for point, each in extensions.brought(kind):
            names = {"command": {f"vibeam {each.name}"}, "section of a page": set(), "reader of meshes": set()}.get(
                kind, {each.name}
            )
            read = {*each.quantities, *each.reads} if kind == "kind of figure" else set()
            if point.package == extensions.OWN:
                brought.setdefault(point.name, set()).update(names | read)
    brought["identification"] = {"vibeam fit FILE"}
    for name in dir(vibeam):
        home = vibeam._homes.get(name, "").split(".")  # type: ignore[attr-defined]
        if home[:2] == ["vibeam", "extensions"]:
            brought[home[2]].add(f"vibeam.{name}")
    assert {name: set(said) for name, said in extensions.OURS.items()} == brought


DECLARATIONS = {"declared", "figures", "solvers", "stages", "plan"}
WITHOUT = """
import sys
from vibeam.__main__ import main
sys.argv = ["vibeam", *{words!r}]
try:
    main()
except SystemExit:
    pass
own = {{name for name in sys.modules if name.startswith("vibeam.extensions.")}}
print("LOADED", sorted(name for name in own if name.count(".") > 2))
"""


@pytest.mark.parametrize(
    ("words", "loaded"),
    [
        (["-h"], {"declared", "stages"}),
        (["derive", "cases/dtu_neutral.toml", "-q"], DECLARATIONS),
        (
            ["run", "cases/dtu_neutral.toml", "--out", "OUT", *SHORT],
            DECLARATIONS,
        ),
    ],
)
def test_a_command_of_the_core_loads_the_declarations_alone(words: list[str], loaded: set[str], tmp_path: Path) -> None:
    asked = [each.replace("OUT", str(tmp_path / "a.h5")) for each in words]
    done = subprocess.run([sys.executable, "-c", WITHOUT.format(words=asked)], cwd=ROOT, capture_output=True, text=True)
    found = done.stdout.splitlines()[-1].partition("LOADED ")[2]
    assert {each.strip("' ").rpartition(".")[2] for each in found.strip("[]").split(",")} <= loaded
