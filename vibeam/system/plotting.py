"""Drawing what is held here: by the report, which stands above and is imported when it is asked."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

HOME = "vibeam.report.plot"


def plot(shown: object, *paths: str | Path, **options: Any) -> Figure:
    """The figure of a response or a result, as ``vibeam.plot`` makes it."""
    made: Figure = import_module(HOME).plot(shown, *paths, **options)
    return made
