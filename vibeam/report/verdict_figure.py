"""Fidelity map as a figure: the cheapest model that suffices, then each model's error and difference in kind."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vibeam.figures.page import PAGE, blank_page, legend, plain, titled, write_page
from vibeam.figures.style import name_of
from vibeam.figures.units import frequency_label, units_of, with_unit
from vibeam.report.stability import LOOKS, OWN
from vibeam.report.verdict import key_unit, quantity_of
from vibeam.studies.stability.rows import NAMES
from vibeam.studies.verdict.judgement import DIFFERENCES, IN_CHAOS, IN_NUMBER, IN_PERIOD, SAME
from vibeam.studies.verdict.study import Verdict

MODELS = ("#D6ECC4", "#9CCB86", "#F2E2A0", "#E9B872", "#D98C5F", "#B5654A")  # cheapest first
FINEST = "#8FA9C8"
NEAR, FAR, FARTHER = "#E4F1DA", "#F7E3B5", "#EBB78B"  # within the accuracy, five times it, beyond
APART = {IN_PERIOD: "#C9B6DD", IN_NUMBER: "#8E7CC3", IN_CHAOS: "#4F4789"}
FIVE = 5.0
HATCH = "////"
BOUNDARIES = {NAMES[kind]: look for kind, look in LOOKS.items()}


def write_verdict(found: Verdict, *paths: Path) -> None:
    """Draw and write the map; the format follows each path's ending (.png, .svg, .pdf)."""
    write_page(lambda: verdict_figure(found), paths)


def verdict_figure(found: Verdict) -> Figure:
    """The regions, and a panel for each model but the finest, on the same axes."""
    count = len(found.models)
    columns = min(count, 3)
    rows = ceil(count / columns)
    figure = blank_page((3.4 * columns, 2.9 * rows + 1.2), found.case.figure)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    handles = _regions(grid.flat[0], found)
    for axes, index in zip(grid.flat[1:], range(count - 1), strict=False):
        handles += _model(axes, found, index)
    for spare in grid.flat[count:]:
        spare.set_axis_off()
    for axes in grid.flat[:count]:
        _frame(axes, found)
    drawn = {each.boundary for each in found.boundaries}
    handles += [Line2D([], [], label=name, linewidth=1.1, **look) for name, look in BOUNDARIES.items() if name in drawn]
    for axes in [axes for axes in grid.flat if axes.axison][-columns:]:
        axes.set_xlabel(frequency_label(units_of(found.case)))
        axes.tick_params(labelbottom=True)
    figure.supylabel(with_unit(found.axis.name, key_unit(found)[0]), fontsize=PAGE["font.size"])
    titled(
        figure, found.case.figure, found.case.title,
        f"how much model: {found.accuracy * 100:.3g} % of the {quantity_of(found)} against {found.finest.name}",
    )  # fmt: skip
    unique = {str(handle.get_label()): handle for handle in handles}
    legend(figure, list(unique.values()), list(unique))
    return figure


def _places(found: Verdict) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    factor = units_of(found.case).frequency_factor
    return found.frequency * factor, found.axis.values * key_unit(found)[1]


def _shaded(axes: Axes, found: Verdict, codes: NDArray[np.int64], colours: list[str]) -> None:
    across, up = _places(found)
    axes.pcolormesh(
        across, up, codes, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(colours) - 0.5, shading="nearest",
        rasterized=True,
    )  # fmt: skip


def _regions(axes: Axes, found: Verdict) -> list[Artist]:
    """Shade the cheapest model that suffices; hatch where models differ in kind."""
    last = len(found.models) - 1
    colours = [*(MODELS[min(index, len(MODELS) - 1)] for index in range(last)), FINEST]
    _shaded(axes, found, found.label, colours)
    apart = np.any([codes != SAME for codes in found.differences], axis=0)
    across, up = _places(found)
    if apart.any():
        axes.contourf(across, up, apart.astype(float), levels=[0.5, 1.5], colors="none", hatches=[HATCH])
    _boundaries(axes, found, found.finest.name)
    axes.set_title(plain("cheapest model that suffices"))
    names = [name_of(found.case, model.name) for model in found.models]
    shown = [index for index in range(last + 1) if (found.label == index).any()]
    words = [f"{names[index]} suffices" if index < last else f"{names[index]} is needed" for index in shown]
    patches: list[Artist] = [
        Patch(facecolor=colours[index], edgecolor="0.6", linewidth=0.5, label=word)
        for index, word in zip(shown, words, strict=True)
    ]
    hatched = Patch(facecolor="none", edgecolor="0.25", hatch=HATCH, linewidth=0.5, label="models differ in kind")
    return [*patches, *([hatched] if apart.any() else [])]


def _model(axes: Axes, found: Verdict, index: int) -> list[Artist]:
    """Shade how far one model is off, and where it differs in kind, and how."""
    with np.errstate(invalid="ignore"):
        off = np.abs(found.relative[index])
        size = np.select([off <= found.accuracy, off <= FIVE * found.accuracy], [0, 1], 2)
    codes = np.where(found.differences[index] == SAME, size, 2 + found.differences[index])
    colours = [NEAR, FAR, FARTHER, *APART.values()]
    accuracy = found.accuracy * 100
    words = [
        f"off by up to {accuracy:.3g} %", f"up to {FIVE * accuracy:.3g} %", f"more than {FIVE * accuracy:.3g} %",
        *(DIFFERENCES[code] for code in APART),
    ]  # fmt: skip
    _shaded(axes, found, codes, colours)
    _boundaries(axes, found, found.models[index].name)
    axes.set_title(plain(f"{name_of(found.case, found.models[index].name)} against {found.finest.name}"))
    return [
        Patch(facecolor=colour, edgecolor="0.6", linewidth=0.5, label=word)
        for code, (colour, word) in enumerate(zip(colours, words, strict=True))
        if (codes == code).any()
    ]


def _boundaries(axes: Axes, found: Verdict, name: str) -> None:
    """Draw the exact boundaries of one model."""
    for curve in found.boundaries:
        if curve.fidelity == name:
            across, up = curve.frequency * units_of(found.case).frequency_factor, curve.value * key_unit(found)[1]
            alone: Any = {"marker": ".", "markersize": 2.0} if len(across) == 1 else {}
            axes.plot(across, up, linewidth=1.1, **BOUNDARIES[curve.boundary], **alone)


def _frame(axes: Axes, found: Verdict) -> None:
    across, up = _places(found)
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(up[0], up[-1])
    own = found.axis.own * key_unit(found)[1]
    if up[0] <= own <= up[-1]:
        axes.axhline(own, gid="own", **OWN)
