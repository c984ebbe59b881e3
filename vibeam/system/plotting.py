"""Bridge to the figures: imports the room ``report``, which stands above this one, only when a plot is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

HOME = "vibeam.report.figures"


def plot(shown: object, *paths: str | Path, **options: Any) -> Figure:
    """Plot a response or a result with ``vibeam.plot``."""
    made: Figure = import_module(HOME).plot(shown, *paths, **options)
    return made
