"""Picture of a page that flies, for the front page: ``python tests/benchmarks/explore_picture.py``, with Chromium.

pip install 'vibeam[browser]' and Debian's chromium. Writes cases/dtu_neutral_explore.png.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import sync_playwright

import vibeam

CASES = Path(__file__).parents[2] / "cases"
PLACE = "#gap=50&f=14.85&start=sweep"  # µm, Hz
SETTLED = """() => document.getElementById("state").textContent.startsWith("Settled")
  && !document.getElementById("state").textContent.includes("follow")
  && !document.getElementById("readings").textContent.includes("…")"""
WIDTH, HEIGHT = 1040, 1200  # px: down to history and beam


def draw() -> None:
    """Open the page at a place that the case does not have, and keep what is seen once all has settled."""
    with TemporaryDirectory() as folder, sync_playwright() as started:
        page = Path(folder) / "page.html"
        vibeam.explore(CASES / "dtu_neutral.toml").write(page)
        browser = started.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox", "--disable-gpu"])
        tab = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, device_scale_factor=1)
        tab.goto(page.as_uri() + PLACE)
        tab.wait_for_function(SETTLED, timeout=60000)
        tab.wait_for_timeout(500)
        top = tab.evaluate("document.getElementById('explore').getBoundingClientRect().top + scrollY")
        clip = {"x": 0, "y": top, "width": WIDTH, "height": HEIGHT}
        tab.screenshot(path=CASES / "dtu_neutral_explore.png", clip=clip, full_page=True)
        browser.close()


if __name__ == "__main__":
    draw()
