"""Declarations of what exploration brings."""

from __future__ import annotations

from vibeam.cli.declaration import Command
from vibeam.report.declaration import PageSection

COMMANDS = (
    Command(
        "explore",
        "Results",
        "Fly a case in a page as its sliders move, without a sweep.",
        "vibeam.extensions.explore.command:explore",
    ),
)
SECTIONS = (PageSection("explore", "vibeam.extensions.explore.page:results_section", live=True),)
