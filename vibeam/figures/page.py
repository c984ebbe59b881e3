"""Layout of a figure: size, title and legend, legible tick labels, and the output files."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from vibeam.case.plans import FigurePlan
from vibeam.exchange.whole_files import write_whole
from vibeam.figures.files import metadata
from vibeam.figures.lettering import set_fonts, set_plain_labels, thin_out

PAGE: Any = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 8.5,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "vibeam",
    "pdf.fonttype": 42,
    "legend.fontsize": 7.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
}

DOTS = 220  # dots an inch
INCH = 0.0254  # m
LEAST_SHARE = 0.6  # smallest share of a figure's usual height, however narrow it is
TITLE = 9.5  # pt
LETTER = 0.52  # mean width of a letter, in font sizes
HANDLE = 0.5  # inch, of a legend's entry beside its text
ENTRY = 52  # largest number of letters in a line of a legend's entry
COLUMNS = 4  # largest number of columns of a legend
LINES = 4  # of a title or an entry at most: what is longer ends in an ellipsis


def write_page(make: Callable[[], Figure], paths: Iterable[Path], dots: int = DOTS, mark: str | None = None) -> None:
    """Make a figure and write it, with ``mark`` in its metadata; the format follows each path's ending."""
    with mpl.rc_context(PAGE):
        figure = composed(make)
        figure.set_layout_engine(None)  # the layout is found: keep it for all formats
        for path in paths:
            content = BytesIO()
            options: Any = {"dpi": dots, "metadata": metadata(path, mark)}
            figure.savefig(content, format=path.suffix.removeprefix("."), **options)
            write_whole(path, content.getvalue())


def composed(make: Callable[[], Figure]) -> Figure:
    """Figure in the style of the page, with as many ticks as have room."""
    with mpl.rc_context(PAGE):
        figure = make()
        set_fonts(figure)
        set_plain_labels(figure)
        thin_out(figure)
        return figure


class ShownFigure(Figure):
    """Figure that a notebook shows by itself."""

    def _repr_png_(self) -> bytes:
        content = BytesIO()
        with mpl.rc_context(PAGE):
            self.savefig(content, format="png")
        return content.getvalue()


def blank_page(size: tuple[float, float], plan: FigurePlan) -> Figure:
    """Empty figure of ``size`` (width, height in inches), or as wide as the plan says."""
    width, height = size
    if plan.width is not None:
        share = plan.width / INCH / width
        width, height = share * width, max(share, LEAST_SHARE) * height
    return ShownFigure(figsize=(width, height), layout="constrained")


def titled(figure: Figure, plan: FigurePlan, title: str, shows: str) -> None:
    """Set the case's title above the caption; nothing where the plan wants none."""
    if plan.title:
        letters = _letters(figure, TITLE)
        lines = [shortened(title, letters), *(fill(plain(line), letters) for line in shows.splitlines())]
        figure.suptitle("\n".join(line for line in lines if line), fontsize=TITLE)


def legend(figure: Figure, entries: Sequence[Any] | Mapping[str, Any], remark: str = "") -> None:
    """Draw the legend below, in as many columns as have room; none without entries.

    ``entries``: artists by their labels, or with labels of their own; ``remark``: above them.
    """
    if not entries:
        return
    handles: list[Any] = list(entries.values()) if isinstance(entries, Mapping) else list(entries)
    labels = list(entries) if isinstance(entries, Mapping) else [str(each.get_label()) for each in handles]
    size = PAGE["legend.fontsize"]
    letters = _letters(figure, size, HANDLE, ENTRY)
    texts = [shortened(label, letters) for label in labels]
    widths = [HANDLE + LETTER * size / 72 * max(map(len, text.splitlines())) for text in texts]
    columns = next((n for n in range(COLUMNS, 1, -1) if _wide(widths, n) <= figure.get_figwidth()), 1)
    figure.legend(
        handles, texts, loc="outside lower center", ncols=min(columns, len(texts)), frameon=False, columnspacing=1.5,
        title=shortened(remark, _letters(figure, size)), title_fontsize=size,
    )  # fmt: skip


def _wide(widths: Sequence[float], columns: int) -> float:
    """Width of a legend in inches, its entries put column by column as matplotlib does: the first columns longer."""
    return float(sum(max(column) for column in np.array_split(widths, columns) if len(column)))


def plain(text: str) -> str:
    """Text without formulas, control characters escaped."""
    visible = (repr(each)[1:-1] if unicodedata.category(each) in ("Cc", "Cf", "Zl", "Zp") else each for each in text)
    return "".join(visible).replace("$", r"\$")


def shortened(text: str, letters: int) -> str:
    """A user's text, plain, in lines of so many letters, ``LINES`` at most."""
    return fill(plain(text), letters, max_lines=LINES, placeholder=" …")


def _letters(figure: Figure, size: float, beside: float = 0.1, most: int = 1000) -> int:
    """Number of letters of a ``size`` (pt) in a line, with ``beside`` inches left free."""
    return min(most, max(12, int((figure.get_figwidth() - beside) * 72 / (LETTER * size))))
