"""Declaration of the command ``fit``, of cases and of signals."""

from __future__ import annotations

from vibeam.cli.declaration import Command

COMMANDS = (
    Command(
        "fit",
        "Measurements",
        "Estimate parameters from measurements, with intervals.",
        "vibeam.extensions.identification.command:fit",
    ),
)
