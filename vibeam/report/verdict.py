"""Verdict on the fidelities over a plane: its table, its sentences, and the fidelity map.

The map shows the cheapest model that suffices, then each model's error and difference in kind.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from vibeam.figures.page import legend, plain, titled
from vibeam.figures.style import name_of
from vibeam.figures.units import units_of
from vibeam.report.output import StudySheet
from vibeam.report.planes import boundary_keys, draw_boundary, frame, panels, shade, swatch
from vibeam.report.tables import ReportTable
from vibeam.studies.stability.rows import NAMES
from vibeam.studies.verdict.judgement import DIFFERENCES, IN_CHAOS, IN_NUMBER, IN_PERIOD, SAME, FidelityRow
from vibeam.studies.verdict.study import Verdict
from vibeam.system.number_text import shown_unit, signed
from vibeam_models.arrays import Array

MODELS = ("#D6ECC4", "#9CCB86", "#F2E2A0", "#E9B872", "#D98C5F", "#B5654A")  # cheapest first
FINEST = "#8FA9C8"
NEAR, FAR, FARTHER = "#E4F1DA", "#F7E3B5", "#EBB78B"  # within the accuracy, five times it, beyond
APART = {IN_PERIOD: "#C9B6DD", IN_NUMBER: "#8E7CC3", IN_CHAOS: "#4F4789"}
FIVE = 5.0
HATCH = "////"
KINDS = {name: kind for kind, name in NAMES.items()}


def sheet(found: Verdict) -> StudySheet:
    """Sheet of a verdict; every point of the map as CSV."""
    words = list(sentences(found))
    data = {"fidelities": found.rows, "shares": found.shares, "boundaries": found.boundaries, "sentences": words}
    return StudySheet(
        words[0], [table_of(found)], words[1:], data=data, rows=found.points, draw=lambda: verdict_figure(found)
    )


def table_of(found: Verdict) -> ReportTable:
    """Table of all models."""
    what = quantity_of(found)
    table = ReportTable(f"Fidelities over frequency and {found.axis.name}, against {found.finest.name}: {what}")
    table.add("fidelity", "modes|", "cost|", "suffices|", "bias|", "rms|", "correlation|", "gain|", "other kind|")
    table.add("of what kind", "wrong between", "use it for")
    table.caption = (
        "cost: CPU time of a point over the finest's; suffices: share of the map within the accuracy and of one kind; "
        "bias, rms: where of one kind\n"
        "gain: variance of a mean over the map at equal cost, without over with this model as a control variate; "
        "other kind: share of the map, and what the finest does there"
    )
    for row in found.rows:
        table.add_row(
            row.fidelity, str(row.modes), f"1/{row.cost_ratio:.3g}", f"{row.within:.1%}", signed(row.bias),
            f"{row.rms:.3g}" if not isfinite(row.rms) else f"{row.rms:.2%}", f"{row.correlation:.4f}",
            f"{row.gain:.2f}", f"{row.other_kind:.1%}", row.kinds or "–", where(found, row), row.use_it_for,
        )  # fmt: skip
    return table


def sentences(found: Verdict) -> Iterator[str]:
    """The verdict in plain words."""
    finest, what = found.finest.name, quantity_of(found)
    shares = [f"{name} on {share:.1%}" for name, share in found.shares.items() if name != finest and share > 0]
    needed = found.shares[finest]
    cheap = f"the cheapest model that suffices is {' of the map, '.join(shares)} of the map" if shares else ""
    rest = f"{finest} is needed on {needed:.1%}" if needed else f"{finest} is needed nowhere"
    parts = "; ".join(part for part in (cheap, rest) if part)
    yield f"To {found.accuracy * 100:.3g} % of the {what}, {parts}."
    for row, apart in zip(found.rows[:-1], found.differences, strict=False):
        kinds = [
            f"{words} on {np.mean(apart == code):.1%}" for code, words in DIFFERENCES.items() if (apart == code).any()
        ]
        if kinds:
            share = f"{row.other_kind:.1%} of the map"
            yield f"{row.fidelity} differs from {finest} in kind on {share}: {', '.join(kinds)}."
        else:
            yield f"{row.fidelity} has the same kind of motion as {finest} everywhere on the map."
    for row in found.rows[:-1]:
        if row.wrong_frequency is None:
            yield f"{row.fidelity} suffices everywhere here."
    if found.doubtful:
        yield f"On {found.doubtful:.1%} of the map the choice hangs on the scatter of motions that do not repeat."
    checked = found.verification
    if checked is not None:
        decided, count = int(checked.decided.sum()), len(checked.decided)
        yield (
            f"Flown anew at {count} places between the map's: {decided} are decided there, and {checked.right} of "
            "these are as the map says."
        )
    yield from found.refused


def quantity_of(found: Verdict) -> str:
    """Quantity that the accuracy is of."""
    return "reach at the contact" if found.quantity == "reach" else f"amplitude at the {found.case.sweep.output}"


def where(found: Verdict, row: FidelityRow) -> str:
    """The ranges in which a model does not suffice."""
    if row.wrong_frequency is None or row.wrong_key is None:
        return "–"
    low, high = row.wrong_frequency
    unit, factor = key_unit(found)
    first, last = (f"{value * factor:.3g}" for value in row.wrong_key)
    return f"{low:.4g} … {high:.4g} Hz, {first} … {last} {unit}".rstrip()


def key_unit(found: Verdict) -> tuple[str, float]:
    """Displayed unit of the second key, and the factor from SI."""
    return shown_unit(found.axis.unit, float(np.abs(found.axis.values).max()))


def verdict_figure(found: Verdict) -> Figure:
    """The regions, and a panel for each model but the finest, on the same axes."""
    figure, grid = panels(found.case, len(found.models), 2.9, 1.2, found.axis.name, key_unit(found)[0])
    handles = _regions(grid[0], found)
    for index, axes in enumerate(grid[1:]):
        handles += _model(axes, found, index)
    for axes in grid:
        frame(axes, *_places(found), found.axis.own * key_unit(found)[1])
    handles += boundary_keys(KINDS[each.boundary] for each in found.boundaries)
    titled(
        figure, found.case.figure, found.case.title,
        f"how much model: {found.accuracy * 100:.3g} % of the {quantity_of(found)} against {found.finest.name}",
    )  # fmt: skip
    legend(figure, {str(handle.get_label()): handle for handle in handles})
    return figure


def _places(found: Verdict) -> tuple[Array, Array]:
    factor = units_of(found.case).frequency_factor
    return found.frequency * factor, found.axis.values * key_unit(found)[1]


def _regions(axes: Axes, found: Verdict) -> list[Artist]:
    """Shade the cheapest model that suffices; hatch where models differ in kind."""
    last = len(found.models) - 1
    colours = [*(MODELS[min(index, len(MODELS) - 1)] for index in range(last)), FINEST]
    across, up = _places(found)
    shade(axes, across, up, found.label, colours)
    apart = np.any([codes != SAME for codes in found.differences], axis=0)
    if apart.any():
        axes.contourf(across, up, apart.astype(float), levels=[0.5, 1.5], colors="none", hatches=[HATCH])
    _boundaries(axes, found, found.finest.name)
    axes.set_title(plain("cheapest model that suffices"))
    names = [name_of(found.case, model.name) for model in found.models]
    shown = [index for index in range(last + 1) if (found.label == index).any()]
    words = [f"{names[index]} suffices" if index < last else f"{names[index]} is needed" for index in shown]
    patches = [swatch(colours[index], word) for index, word in zip(shown, words, strict=True)]
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
    shade(axes, *_places(found), codes, colours)
    _boundaries(axes, found, found.models[index].name)
    axes.set_title(plain(f"{name_of(found.case, found.models[index].name)} against {found.finest.name}"))
    return [
        swatch(colour, word)
        for code, (colour, word) in enumerate(zip(colours, words, strict=True))
        if (codes == code).any()
    ]


def _boundaries(axes: Axes, found: Verdict, name: str) -> None:
    """Draw the exact boundaries of one model."""
    for curve in found.boundaries:
        if curve.fidelity == name:
            across, up = curve.frequency * units_of(found.case).frequency_factor, curve.value * key_unit(found)[1]
            draw_boundary(axes, KINDS[curve.boundary], across, up)
