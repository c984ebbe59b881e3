"""Lettering of a figure: ticks without overlap, labels in plain text, letters that the page's font lacks.

Matplotlib's formulas take longer to set than all curves of a figure to draw: tick labels are plain text. Letters that
the font lacks are taken from another installed one, or escaped.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from itertools import combinations
from typing import Any

from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, fontManager, get_font
from matplotlib.text import Text
from matplotlib.ticker import (
    AutoLocator,
    FixedLocator,
    LogFormatterMathtext,
    LogFormatterSciNotation,
    LogLocator,
    MaxNLocator,
    ScalarFormatter,
)
from matplotlib.transforms import Bbox

FEWER = (6, 5, 4, 3, 2, 1)  # numbers of intervals, tried in order until nothing overlaps
STEPS = [1, 2, 5, 10]
ROOM = 3.0  # points between two labels


def thin_out(figure: Figure) -> None:
    """Reduce the ticks of axes whose labels overlap, their own or a neighbour's."""
    for count in FEWER:
        crowded = crowded_axes(figure)
        for axis in crowded:
            _limit(axis, count)
        if not crowded:
            return


def crowded_axes(figure: Figure) -> list[Any]:
    """Axes (matplotlib ``Axis``) with a tick label that overlaps another one."""
    figure.draw_without_rendering()
    axes = [axis for each in figure.axes if each.axison for axis in (each.xaxis, each.yaxis)]
    boxes = [(axis, box) for axis in axes for box in _boxes(axis, ROOM * figure.dpi / 72)]
    pairs = [(one, two) for (one, box), (two, other) in combinations(boxes, 2) if box.overlaps(other)]
    alike = [pair for pair in pairs if pair[0].axis_name == pair[1].axis_name]  # fewer ticks help along one axis only
    return list(dict.fromkeys(axis for pair in alike for axis in pair))


def _boxes(axis: Any, room: float) -> list[Bbox]:
    """Boxes of the labels, in pixels; neighbours widened by half the ``room`` between two on either side."""
    if isinstance(axis.get_major_locator(), FixedLocator):
        return []
    low, high = sorted(axis.get_view_interval())
    ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
    labels = [label for tick in ticks for label in (tick.label1, tick.label2) if label.get_visible()]
    found = [label.get_window_extent() for label in labels if label.get_text()]
    beside = room / 2 if axis.axis_name == "x" else 0.0
    return [Bbox.from_extents(box.x0 - beside, box.y0, box.x1 + beside, box.y1) for box in found]


def _limit(axis: Any, count: int) -> None:
    if axis.get_scale() == "log":
        axis.set_major_locator(LogLocator(numticks=count))
    elif isinstance(axis.get_major_locator(), AutoLocator | MaxNLocator):
        axis.set_major_locator(MaxNLocator(count, steps=STEPS, min_n_ticks=1))


SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


MINUS = "\N{MINUS SIGN}"
POWER = re.compile(rf"^1e([-{MINUS}]?\d+)")  # common power of ten of a linear axis, as matplotlib writes it


def power_of_ten(exponent: int) -> str:
    """``exponent`` as a power of ten, in Unicode: 10⁻³."""
    return "10" + str(exponent).translate(SUPERSCRIPTS)


class LinearLabels(ScalarFormatter):
    """Labels of a linear axis; a common power of ten stands at its end, as ×10⁻³."""

    def get_offset(self) -> str:
        """Common offset and power of ten of the labels."""
        return POWER.sub(lambda power: f"×{power_of_ten(int(power[1].replace(MINUS, '-')))}", super().get_offset())


class LogLabels(LogFormatterSciNotation):
    """Labels of a logarithmic axis of base 10: powers of ten, and multiples such as 2×10⁻³ where few decades show."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Label of the tick at ``x``; empty where matplotlib leaves the tick without one."""
        if not super().__call__(x, pos):
            return ""
        exponent = math.floor(math.log10(x) + 1e-9)
        share = x / 10.0**exponent
        return power_of_ten(exponent) if math.isclose(share, 1.0) else f"{share:g}×{power_of_ten(exponent)}"


def set_plain_labels(figure: Figure) -> None:
    """Replace matplotlib's own formatters of all axes of a figure by these."""
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        for get, put in (
            (axis.get_major_formatter, axis.set_major_formatter),
            (axis.get_minor_formatter, axis.set_minor_formatter),
        ):
            if (own := _plain(get())) is not None:
                put(own)


def _plain(formatter: Any) -> ScalarFormatter | LogFormatterSciNotation | None:
    if type(formatter) is ScalarFormatter:
        return LinearLabels(useMathText=False)
    if type(formatter) in (LogFormatterSciNotation, LogFormatterMathtext) and formatter._base == 10:
        return LogLabels(labelOnlyBase=formatter.labelOnlyBase)
    return None


NO_FONT = "Last Resort"  # has a box for every letter


def set_fonts(figure: Figure) -> None:
    """Make every text of a figure legible; letters that no installed font has are written as Python escapes them."""
    own = _letters_of(findfont(FontProperties()))
    for text in figure.findobj(Text):
        lacking = frozenset(map(ord, text.get_text())) - own - {ord("\n")}
        if lacking:
            families, left = _others(lacking)
            text.set_fontfamily([*text.get_fontfamily(), *families])
            escaped = {letter: chr(letter).encode("unicode_escape").decode() for letter in left}
            text.set_text(text.get_text().translate(escaped))


@lru_cache(maxsize=64)
def _others(lacking: frozenset[int]) -> tuple[tuple[str, ...], frozenset[int]]:
    """Installed families that have the letters, one after the other, and the letters that none has."""
    families, left = list[str](), lacking
    for entry in sorted(fontManager.ttflist, key=lambda each: (each.style != "normal", each.weight != 400, each.name)):
        if not left:
            break
        if not entry.name.startswith(NO_FONT) and left & (letters := _letters_of(entry.fname)):
            families, left = [*families, entry.name], left - letters
    return tuple(families), left


@lru_cache(maxsize=256)
def _letters_of(file: str) -> frozenset[int]:
    """Code points of a font file; none of one that cannot be read, or is made for no letters at all."""
    try:
        return frozenset(get_font(file).get_charmap())
    except (OSError, RuntimeError):
        return frozenset()
