"""The same examples in every run: a failure here is a failure everywhere; what tests need not pay for again."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import typer.testing
from hypothesis import settings

# before numpy is imported: OpenBLAS's further threads wait by spinning, most of the CPU time of small matrices
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["VIBEAM_CACHE"] = ""  # a reduced solid of another run would hide a change

BROWSERS = {"browser", "firefox"}  # fixtures that open pages in one
PACKAGE = "vibeam.extensions"
SUPPORT = Path(__file__).parent / "support"
EXTENSIONS = Path(__file__).parent / "vibeam" / "extensions"
SLOW_LIMIT = 3600  # seconds that a slow test may take; others: pyproject.toml

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")

typer.testing._get_command = cache(typer.testing._get_command)  # the command of an app never changes: 30 ms each time


if os.environ.get("VIBEAM_TEST_ULP"):  # before a test takes solve_ivp by its name
    import nudged

    nudged.install()


def pytest_configure(config: pytest.Config) -> None:
    """The mark of tests that need an extension: all of ``vibeam/extensions``, and others one by one."""
    config.addinivalue_line("markers", "extension: needs an extension that comes with vibeam")


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out the files that import an extension where there is none: the core is tested by itself."""
    if collection_path.suffix != ".py" or find_spec(PACKAGE) is not None:
        return None
    text = collection_path.read_text(encoding="utf-8")
    helpers = [each.stem for each in SUPPORT.glob("*.py") if PACKAGE in each.read_text(encoding="utf-8")]
    return PACKAGE in text or any(f"from {name} import" in text for name in helpers) or None


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The marks ``browser`` and ``extension``, and limits of time: an hour for slow tests, all by a patience."""
    patience = float(os.environ.get("VIBEAM_TEST_PATIENCE", "1"))
    for item in items:
        if BROWSERS & set(getattr(item, "fixturenames", ())):
            item.add_marker("browser")
        if EXTENSIONS in item.path.parents:
            item.add_marker("extension")
        marked = item.get_closest_marker("timeout")
        limit = marked.args[0] if marked else SLOW_LIMIT if item.get_closest_marker("slow") else None
        if limit is not None or patience != 1:
            item.add_marker(
                pytest.mark.timeout(patience * (limit or float(item.config.getini("timeout")))), append=False
            )


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of figures without a picture, which takes 0.3 s: ``tests/vibeam/figures`` draws."""
    from undrawn import Undrawn

    from vibeam.figures import page

    monkeypatch.setattr(page, "composed", Undrawn)


@pytest.fixture(scope="session")
def node() -> Callable[..., Any]:
    """What a script for node returns: ``node("return 1 + given.x;", {"x": 1})``, see ``support/javascript.py``."""
    from javascript import evaluated

    return evaluated
