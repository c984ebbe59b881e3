"""Examples in the docstrings of all public names, run as they stand."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Iterator
from pathlib import Path

import pytest

import vibeam
from vibeam.case.study_plans import STUDY_PLANS
from vibeam.figures import FIGURES
from vibeam.report.declaration import STUDIES
from vibeam.solvers import SOLVERS
from vibeam_reductions.declaration import REDUCTIONS

ROOT = Path(__file__).parents[2]
ROOMS = {"observe", "periodic", "studies"}
NAMES = sorted({*vibeam.__all__} - {"__version__"} - ROOMS)
REGISTRIES = (FIGURES, REDUCTIONS, SOLVERS, STUDIES, STUDY_PLANS)


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A folder with the cases, which files may be written to; what an example registers is forgotten after it."""
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    monkeypatch.chdir(tmp_path)
    known = [set(registry) for registry in REGISTRIES]
    yield
    for registry, names in zip(REGISTRIES, known, strict=True):
        for name in set(registry) - names:
            registry.remove(name)


def examples(name: str) -> list[doctest.DocTest]:
    """Examples of a public name and of its methods."""
    found = inspect.unwrap(getattr(vibeam, name))
    return [each for each in doctest.DocTestFinder().find(found, name, globs={}) if each.examples]


@pytest.mark.usefixtures("checkout")
@pytest.mark.parametrize("name", NAMES)
def test_the_example_of_a_public_name_runs(name: str) -> None:
    own = examples(name)
    assert name in {each.name for each in own}, "a public name has an example in its docstring"
    for each in own:
        said: list[str] = []
        assert doctest.DocTestRunner().run(each, out=said.append).failed == 0, "".join(said)


def test_names_of_the_observers_are_documented() -> None:
    assert all(inspect.getdoc(getattr(vibeam.observe, name)) for name in dir(vibeam.observe))


def test_a_wrong_example_is_seen() -> None:
    wrong = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, 0)
    assert doctest.DocTestRunner().run(wrong, out=lambda text: None).failed == 1
