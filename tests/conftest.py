"""The same examples in every run: a failure here is a failure everywhere; what tests need not pay for again."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest
import typer.testing
from hypothesis import settings

# before numpy is imported: OpenBLAS's further threads wait by spinning, most of the CPU time of small matrices
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["VIBEAM_CACHE"] = ""  # a reduced solid of another run would hide a change

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")

typer.testing._get_command = cache(typer.testing._get_command)  # the command of an app never changes: 30 ms each time


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
