"""Modules of the user that register effects, contact laws, reductions, solvers, figures or studies."""

from __future__ import annotations

import sys
from importlib import import_module
from os import getcwd

from vibeam.cli.errors import UsageError


def import_extension(name: str) -> None:
    """Import the module ``name``, from the current folder too; UsageError where it is not found."""
    if getcwd() not in sys.path:
        sys.path.insert(0, getcwd())
    try:
        import_module(name)
    except ModuleNotFoundError as missing:
        if missing.name != name.partition(".")[0] and missing.name != name:
            raise
        raise UsageError(
            f"--load {name}: no such module; it is looked for in {getcwd()} and among those installed"
        ) from None
