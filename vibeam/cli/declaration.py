"""Commands that extensions bring: their declaration and registry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vibeam_models.registry import Registry


@dataclass(frozen=True)
class Command:
    """Command of an extension: ``vibeam NAME``, in a ``group`` of the help with its ``meaning``, the first line of it.

    ``home``: ``"module:function"``, imported when the command runs, or a ``StudyDeclaration`` there, whose command
    follows from it.
    """

    name: str
    group: str
    meaning: str
    home: Any


COMMANDS: Registry[Command] = Registry("command")
