"""Every file lies in a room, rooms hang together by declared capabilities, and the rules that say so can fail."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = (ROOT / "vibeam", ROOT / "models" / "vibeam_models", ROOT / "reductions" / "vibeam_reductions")


def test_nothing_lies_loose_beside_the_rooms() -> None:
    assert {path.name for path in (ROOT / "vibeam").glob("*.py")} == {"__init__.py", "__main__.py"}


def asks_for_attributes(path: Path) -> bool:
    """Whether the file tests by name what a thing can do, in place of a declaration."""
    called = (node.func for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Call))
    return any(isinstance(function, ast.Name) and function.id == "hasattr" for function in called)


def test_capabilities_are_declared_and_not_looked_for(tmp_path: Path) -> None:
    files = [
        path
        for package in PACKAGES
        for path in package.rglob("*.py")
        if "kernels" not in path.relative_to(package).parts
    ]
    assert len(files) > 200
    assert [path for path in files if asks_for_attributes(path)] == []
    (tmp_path / "a.py").write_text("if hasattr(x, 'motion'):\n    pass\n")
    assert asks_for_attributes(tmp_path / "a.py")


@cache
def floors() -> dict[str, int]:
    """The floor of every package and room, the lowest 0, as the contracts of pyproject.toml have them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    layers = {each["name"]: each["layers"] for each in settings["contracts"] if each["type"] == "layers"}
    rooms = [[f"vibeam.{room.strip()}" for room in layer.split("|")] for layer in layers["one way down"]]
    storeys = [*rooms, *([package] for package in layers["packages"] if package != "vibeam")]
    return {name: floor for floor, storey in enumerate(reversed(storeys)) for name in storey}


def test_the_page_has_the_floors_of_the_contract() -> None:
    page = (ROOT / "vibeam" / "README.md").read_text("utf-8")
    line = re.split(r"Floors, from the top: |; reductions", page)[1]
    layers = [{f"vibeam.{room}" for room in re.findall(r"`(\w+)`", floor)} for floor in reversed(line.split(">"))]
    own = {name: floor for name, floor in floors().items() if name.startswith("vibeam.")}
    assert layers == [{name for name in own if own[name] == floor} for floor in sorted(set(own.values()))]


def imported(package: Path) -> set[str]:
    """Rooms, and packages beside ``vibeam``, that the modules of a folder import."""
    nodes = [node for path in package.rglob("*.py") for node in ast.walk(ast.parse(path.read_text("utf-8")))]
    names = [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    names += [each.name for node in nodes if isinstance(node, ast.Import) for each in node.names]
    return {".".join(name.split(".")[: 2 if name.startswith("vibeam.") else 1]) for name in names}


def faults_of_diagram(page: str) -> list[str]:
    """Rooms that a page's diagram lacks or invents, arrows that do not lead down, and those that nothing imports."""
    drawn = page.partition("```mermaid\n")[2].partition("```")[0]
    own = floors()
    label = {name: name.removeprefix("vibeam.").removeprefix("vibeam_") for name in own}
    homes = {label[name]: home for name, home in zip(own, map(home_of, own), strict=True)}
    names = {shown: name for name, shown in label.items()}
    arrows = re.findall(r"^ +(\w+)(?:\[.*?\])? --> (\w+)", drawn, re.MULTILINE)
    shown = {each for arrow in arrows for each in arrow}
    missed = [f"{each}: not drawn" for each in sorted(names.keys() - shown)]
    unknown = [f"{each}: no room" for each in sorted(shown - names.keys())]
    known = [(above, below) for above, below in arrows if {above, below} <= names.keys()]
    upward = [f"{above} → {below}: up" for above, below in known if own[names[above]] <= own[names[below]]]
    idle = [f"{above} → {below}: no import" for above, below in known if names[below] not in imported(homes[above])]
    return [*missed, *unknown, *upward, *idle]


def home_of(name: str) -> Path:
    """Folder of a room or package."""
    if name.startswith("vibeam."):
        return ROOT / name.replace(".", "/")
    return next(package for package in PACKAGES if package.name == name)


def test_the_diagram_has_the_rooms_of_the_contract_and_arrows_that_are_imports() -> None:
    page = (ROOT / "vibeam" / "README.md").read_text("utf-8")
    assert faults_of_diagram(page) == []
    assert faults_of_diagram(page.replace("batches", "batch")) == ["batches: not drawn", "batch: no room"]
    assert "flight → exchange: no import" in faults_of_diagram(
        page.replace("flight --> observe", "flight --> exchange")
    )
    assert "store → runs: up" in faults_of_diagram(page.replace("runs --> store", "store --> runs"))


def upward_names(path: Path, room: str) -> list[str]:
    """Strings of a file in ``room`` that name a module of another room that is not below: ``"package.module:name"``."""
    found, known = [], floors()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        word = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
        parts = re.match(r"(vibeam(?:_\w+)?)\.(?:(\w+)[\w.:]*)?$", word)
        home = parts[1] if parts and parts[1] in known else parts and f"{parts[1]}.{parts[2]}"
        if home and home != room and known.get(home, -1) >= known[room]:
            found.append(word)
    return found


def test_no_string_names_a_room_above(tmp_path: Path) -> None:
    """What is loaded by its name runs one way down too, though no import says so."""
    found = set()
    for room in floors():
        package, _, name = room.partition(".")
        folder = next(each for each in PACKAGES if each.name == package) / name
        found |= {f"{path.name}: {word}" for path in folder.rglob("*.py") for word in upward_names(path, room)}
    assert found == set()
    (tmp_path / "a.py").write_text('a = "vibeam.report.figures"; b = "vibeam.flight.solver:x"; f"vibeam.cli.{a}:{b}"')
    climbing = ["vibeam.report.figures", "vibeam.flight.solver:x", "vibeam.cli."]
    assert sorted(upward_names(tmp_path / "a.py", "vibeam.case")) == sorted(climbing)
    assert upward_names(tmp_path / "a.py", "vibeam.cli") == []


LAWS = {
    node.name
    for path in (ROOT / "models" / "vibeam_models" / "laws").glob("*.py")
    for node in ast.parse(path.read_text("utf-8")).body
    if isinstance(node, ast.ClassDef)
}


def tells_laws_apart(path: Path) -> list[str]:
    """Tests of a contact law's class in a file, in place of a capability that the law declares."""
    found: list[ast.expr] = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("isinstance", "issubclass"):
            found.append(node.args[1])
        elif isinstance(node, ast.MatchClass):
            found.append(node.cls)
    named = ({getattr(each, "id", getattr(each, "attr", "")) for each in ast.walk(node)} for node in found)
    return sorted(name for names in named for name in names & LAWS)


def test_a_law_is_asked_for_its_capabilities_and_not_for_its_class(tmp_path: Path) -> None:
    assert {"StopLaw", "LinearStop", "HuntCrossley", "TableRestitution", "ContactLaw"} <= LAWS
    files = [path for package in PACKAGES if package.name != "vibeam_models" for path in package.rglob("*.py")]
    assert len(files) > 200
    assert {str(path): names for path in files if (names := tells_laws_apart(path))} == {}
    own = tmp_path / "a.py"
    for line in ("isinstance(x.law, LinearStop | int)", "issubclass(kind, laws.StopLaw)", "LinearStop(1.0)"):
        own.write_text(line)
        assert bool(tells_laws_apart(own)) is line.startswith("is")
    own.write_text("match law:\n    case LinearStop():\n        pass\n")
    assert tells_laws_apart(own) == ["LinearStop"]


@pytest.mark.parametrize("upward", [None, "import vibeam.runs.sweep"])
def test_imports_run_one_way_down(upward: str | None, tmp_path: Path) -> None:
    """The contracts in pyproject.toml hold, and an import upward breaks them."""
    for part in ("vibeam", "models", "reductions"):
        shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    if upward:
        state = tmp_path / "vibeam" / "system" / "state.py"
        state.write_text(f"{state.read_text('utf-8')}\n{upward}\n", "utf-8")
    code = (
        "import sys; sys.path[:0] = ['.', 'models', 'reductions']; "
        "from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, "vibeam.system.state -> vibeam.runs.sweep" in done.stdout) == (
        int(bool(upward)),
        bool(upward),
    )
