"""Exploration: a page in which the exact engine runs as the keys of a case move."""

from __future__ import annotations

from vibeam_models.extensions import Extension

EXTENSION = Extension(
    {
        "command": "vibeam.extensions.explore.declared:COMMANDS",
        "section of a page": "vibeam.extensions.explore.declared:SECTIONS",
    }
)
