"""What figures over the drive frequency share: one panel a quantity, one line a fidelity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibeam.report.outputs import frequency_label
from vibeam.show.plan import Sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from vibeam.report.units import Units

Array = NDArray[np.float64]


def means(sheets: Sequence[Sheet], column: str) -> tuple[Array, Array, Array]:
    """Frequencies (Hz), mean and standard deviation of a column's finite entries, NaN where there are none."""
    rows = []
    for sheet in sheets:
        values = sheet.of(column)
        values = values[np.isfinite(values)]
        rows.append((sheet.frequency, *((np.mean(values), np.std(values)) if len(values) else (np.nan, np.nan))))
    frequency, mean, spread = np.array(sorted(rows), dtype=float).reshape(-1, 3).T
    return frequency, mean, spread


def drawn(axes: Axes, sheets: Sequence[Sheet], column: str, factor: float, across: float, **look: Any) -> bool:
    """Draw the mean of a column over frequency, its spread between impacts as a band; False where there is nothing."""
    frequency, mean, spread = means(sheets, column)
    if not np.isfinite(mean).any():
        return False
    marks: dict[str, Any] = {"marker": "o", "markersize": 2.4} if len(frequency) < 40 else {}
    marks["linewidth"] = 1.0
    axes.plot(frequency * across, mean * factor, **(marks | look))
    axes.fill_between(
        frequency * across, (mean - spread) * factor, (mean + spread) * factor, color=look["color"], alpha=0.15,
        linewidth=0,
    )  # fmt: skip
    return True


def across_frequency(axes: Axes, units: Units) -> None:
    """The label below."""
    axes.set_xlabel(frequency_label(units))
