"""Declarations of the study's table and of its command."""

from __future__ import annotations

from vibeam.cli.declaration import Command
from vibeam_models.registry import Home

HOME = "vibeam.extensions.dictionary"
PLANS = (Home("mode_share", f"{HOME}.plan:ModeSharePlan"),)
COMMANDS = (
    Command(
        "mode_share",
        "From geometry",
        "What a sensor shows of the restitution; other programs' terms.",
        f"{HOME}.studies:MODE_SHARE",
    ),
)
