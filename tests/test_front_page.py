"""The front page's Python block, run as it is written where nothing but README's installation is there."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
#: packages of extras, which README's installation has not
BARE = """
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {absent!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Absent())
"""


def names(requirements: list[str]) -> set[str]:
    """Modules of requirements, those of vibeam's own extras aside."""
    return {re.split(r"[\[<>=;]", each)[0].replace("-", "_") for each in requirements} - {"vibeam"}


def bare(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The code in a folder with the cases of the checkout, as after README's installation."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = set().union(*map(names, project["optional-dependencies"].values()))
    absent = extras - names(project["dependencies"]) | {"numba", "IPython"}
    (folder / "cases").symlink_to(ROOT / "cases", target_is_directory=True)
    text = BARE.format(absent=sorted(absent)) + code
    return subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True)


def test_the_python_block_runs_after_the_installation(tmp_path: Path) -> None:
    (block,) = BLOCK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    done = bare(block, tmp_path)
    assert done.returncode == 0, done.stderr
    assert {"neutral.h5", "neutral.png"} <= {each.name for each in tmp_path.iterdir()}


@pytest.mark.parametrize(("call", "package"), [("to_dataframe", "pandas"), ("to_xarray", "xarray")])
def test_tables_are_of_the_extra_that_the_page_names(tmp_path: Path, call: str, package: str) -> None:
    run = "vibeam.modes('cases/dtu_neutral.toml')" if package == "pandas" else "vibeam.sweep(system, omega=[1.0])"
    system = "system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)\n"
    done = bare(f"import vibeam\n{system}{run.replace('[1.0]', '[1.0], amplitude=0.1')}.{call}()", tmp_path)
    assert done.returncode == 1
    assert f"{call} needs the package {package}: pip install {package}" in done.stderr
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert package in names(project["optional-dependencies"]["tables"])
    assert "pip install '.[tables]'" in (ROOT / "README.md").read_text(encoding="utf-8")
