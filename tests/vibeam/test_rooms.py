"""Every file lies in a room, rooms hang together by declared capabilities, and the rules that say so can fail."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
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
