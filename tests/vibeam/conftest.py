"""Browsers that slow tests open pages in; a test is skipped where its browser is not installed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from browsers import CHROMIUM, OPTIONS
from firefox import FIREFOX, Firefox


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    if not CHROMIUM.exists():
        pytest.skip("needs Debian's chromium")
    with playwright.sync_playwright() as started:
        found = started.chromium.launch(executable_path=str(CHROMIUM), args=OPTIONS)
        yield found
        found.close()


@pytest.fixture(scope="session")
def firefox() -> Iterator[Firefox]:
    if not FIREFOX.exists():
        pytest.skip("needs Debian's firefox-esr")
    with Firefox() as found:
        yield found
