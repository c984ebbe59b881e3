"""Pages in Debian's browsers: Chromium with all that a page asks for and says; Firefox in ``firefox.py``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

CHROMIUM = Path(os.environ.get("VIBEAM_CHROMIUM", "/usr/bin/chromium"))

OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
           "--disable-component-update", "--disable-sync"]  # fmt: skip


class Opened:
    """A page with what it has asked for, said and run; ``before``: a script that runs before those of the page."""

    def __init__(self, browser: Any, file: Path, fragment: str = "", before: str = "", **options: Any) -> None:
        self.page = browser.new_page(**options)
        self.asked: list[str] = []
        self.said: list[str] = []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("dialog", lambda dialog: (self.said.append("dialog"), dialog.dismiss()))
        if before:
            self.page.add_init_script(before)
        self.page.goto(file.as_uri() + fragment)

    @property
    def foreign(self) -> list[str]:
        """Requests for what is neither the file nor part of it."""
        return [url for url in self.asked if not url.startswith(("file:", "data:", "blob:"))]

    def saved(self, name: str) -> bytes:
        """Content of the file that a button writes."""
        with self.page.expect_download() as started:
            self.page.get_by_role("button", name=name, exact=True).click()
        return Path(started.value.path()).read_bytes()

    def violations(self) -> list[tuple[str, list[str]]]:
        """What axe finds, minor things too: rule and elements."""
        from axe_playwright_python.sync_playwright import Axe

        found = Axe().run(self.page).response["violations"]
        return [(each["id"], [node["html"][:120] for node in each["nodes"]]) for each in found]
