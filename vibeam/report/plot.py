"""Figures of frequency-response curves: of a whole result, or of a response without a case."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.run.result import Result
from vibeam.system.response import Branches, FrequencyResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(
    shown: Result | Branches | FrequencyResponse, *paths: str | Path, quantity: str = "amplitude"
) -> Figure:  # fmt: skip
    """Plot a result, as ``vibeam run`` writes it, or a response over frequency.

    ``paths``: files to write it to (.png, .svg, .pdf). ``quantity``: of a response, any that has one number a point.
    The figure belongs to no window. ValueError for another quantity or another kind of object.
    """
    from vibeam.figures.page import write_page

    made: list[Figure] = []

    def make() -> Figure:
        made.append(_figure(shown, quantity))
        return made[0]

    write_page(make, [Path(path) for path in paths])
    return made[0]


def _figure(shown: Result | Branches | FrequencyResponse, quantity: str) -> Figure:
    if isinstance(shown, Result):
        if quantity != "amplitude":
            raise ValueError(f"quantity: a result is shown by its amplitude; plot result[fidelity] for {quantity!r}")
        from vibeam.figures.response_curve import frc

        return frc(shown)
    if not isinstance(shown, Branches | FrequencyResponse):
        raise ValueError(f"plot: a {type(shown).__name__} is no Result, Branches or FrequencyResponse")
    from vibeam.figures.response import response_figure

    return response_figure(dict(shown.items()) if isinstance(shown, Branches) else {"up": shown}, quantity)
