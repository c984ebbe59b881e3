"""A figure on its page: what holds for the whole of it, and how it is written."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from vibeam.store.whole import write_whole

PAGE: Any = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 8.5,
    "svg.fonttype": "none",
    "svg.hashsalt": "vibeam",
    "legend.fontsize": 7.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
}
DOTS = 220  # an inch


def write_page(make: Callable[[], Figure], paths: Iterable[Path], dots: int = DOTS) -> None:
    """Make a figure and write it; the format follows each path's ending (.png, .svg, .pdf)."""
    with mpl.rc_context(PAGE):
        figure = make()
        for path in paths:
            metadata: Any = {"Date": None} if path.suffix == ".svg" else None
            content = BytesIO()
            figure.savefig(content, format=path.suffix.removeprefix("."), dpi=dots, metadata=metadata)
            write_whole(path, content.getvalue())
