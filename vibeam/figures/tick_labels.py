"""Tick labels as plain text: matplotlib's formulas take longer to set than all curves of a figure to draw."""

from __future__ import annotations

import math
import re
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterMathtext, LogFormatterSciNotation, ScalarFormatter

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
