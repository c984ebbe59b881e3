"""Fidelity maps: their sheet, and their picture: the cheapest model that suffices, each model's error and kind."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from vibeam.case.held import held_of
from vibeam.figures.page import blank_page, legend, plain, titled
from vibeam.figures.style import name_of
from vibeam.maps.axes import edges
from vibeam.maps.boundaries import PlaneBoundary
from vibeam.report.maps.labels import shown_axis
from vibeam.report.maps.plane import COLUMNS, Handles, PlanePanel, draw_planes, page_size, place_of, shade, swatch
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.studies.fidelity_map.judgement import DIFFERENCES, IN_NUMBER, IN_PERIOD, SAME
from vibeam.studies.fidelity_map.study import FidelityMap
from vibeam.system.number_text import percent, signed
from vibeam_models.arrays import Array

MODELS = ("#D6ECC4", "#9CCB86", "#F2E2A0", "#E9B872", "#D98C5F", "#B5654A")  # cheapest first
FINEST = "#8FA9C8"
NEAR, FAR, FARTHER = "#E4F1DA", "#F7E3B5", "#EBB78B"  # within the accuracy, five times it, beyond
APART = {IN_PERIOD: "#C9B6DD", IN_NUMBER: "#8E7CC3"}
FIVE = 5.0
ALONE = (5.0, 4.4)  # inches of the regions without the other panels
HATCH, CLEAR = "////", ListedColormap(["#00000000"])
BOUNDARY = ("fidelity", "boundary", "branch", "frequency", "value", "velocity", "clear")  # fields in JSON


def sheet(found: FidelityMap) -> StudySheet:
    """Sheet of a fidelity map; every point of the map as CSV."""
    answer, notes = _answer(found), list(_notes(found))
    curves = [{name: getattr(each, name) for name in BOUNDARY} for each in found.boundaries]
    data = {"fidelities": found.rows, "shares": found.shares, "boundaries": curves, "sentences": [answer, *notes]}
    return StudySheet(
        answer, [_table(found)], notes, data=data, rows=found.points,
    )  # fmt: skip


def _answer(found: FidelityMap) -> str:
    """Shares of the places with impacts on which each model suffices, and what is held."""
    finest, upward = found.finest.name, shown_axis(found.case, found.plan.axes[-2])
    accuracy, what = f"{found.plan.accuracy * 100:.3g} %", quantity_of(found)
    rows, columns = found.label.shape
    few = f"{rows} x {columns} places of the " if found.thinned else ""
    plane = f"the {few}plane of frequency and {upward.name}"
    known = [(share, name) for name, share in found.shares.items() if name != finest and share > 0]
    choice = held_of(found.case.scene)
    held = f"; {'the ' * (choice.coefficient is None)}{choice.label} is held."
    if not found.touched.any():
        return f"No model touches the stop on {plane}{held}"
    where = f"of the places with impacts ({percent(float(found.touched.mean()))} of {plane})"
    needed = found.shares[finest]
    if not known:
        return f"To {accuracy} of the {what} {finest} is needed on all {where}{held}"
    first, *others = [f"{name} suffices on {percent(share)}" for share, name in sorted(known, reverse=True)]
    rest = [each.replace(" suffices", "") for each in others]
    last = f"{finest} is needed on {percent(needed)}" if needed else f"{finest} is needed nowhere"
    return f"To {accuracy} of the {what} {', '.join([f'{first} {where}', *rest])}; {last}{held}"


def _notes(found: FidelityMap) -> Iterator[str]:
    """Sentences on what is uncertain, each with what to do about it."""
    if found.thinned is not None:
        (rows, columns), (few, fewer) = found.thinned
        kept = f"{few} x {fewer} places in place of {rows} x {columns}"
        yield f"{kept}, for the budget: a larger --budget refines the map."
    if found.doubtful > 0:
        yield (
            f"On {percent(found.doubtful)} of the places with impacts the choice hangs on the scatter of motions that "
            "do not repeat: a longer sweep.hold decides more."
        )
    yield from found.refused


def _table(found: FidelityMap) -> ReportTable:
    """Table of all models: where they suffice, how far they are off."""
    table = blank(f"Against {found.finest.name}", "fidelity", "modes|", "cost|", "suffices|", "bias|", "rms|")
    table.add("other kind|", "of what kind")
    table.caption = (
        "cost: CPU time of a point over the finest's; suffices: share of the places where a model touches the stop\n"
        "bias, rms: where of one kind; other kind: share where it differs in kind, and what the finest does there"
    )
    for row in found.rows:
        rms = percent(row.rms) if isfinite(row.rms) else "–"
        ratio = f"1/{row.cost_ratio:.3g}" if row.cost_ratio >= 1 else f"{1 / row.cost_ratio:.3g}"
        within, other = (percent(each) if isfinite(each) else "–" for each in (row.within, row.other_kind))
        cells = (ratio, within, signed(row.bias), rms, other, row.kinds or "–")
        table.add_row(row.fidelity, str(row.modes), *cells)
    return table


def quantity_of(found: FidelityMap) -> str:
    """Quantity that the accuracy is of."""
    return "reach at the contact" if found.plan.quantity == "reach" else f"amplitude at the {found.plan.output}"


def caption(found: FidelityMap) -> str:
    """Caption of the picture."""
    return f"which model: {found.plan.accuracy * 100:.3g} % of the {quantity_of(found)} against {found.finest.name}"


def size_of(found: FidelityMap) -> tuple[float, float]:
    """A panel for the regions, and one for each model but the finest."""
    count = len(found.models)
    return page_size(place_of(count - 1)[0] + 1, min(count, COLUMNS), 2.0)


def verdict(figure: Figure, found: FidelityMap, exact: bool) -> tuple[Handles, list[str]]:
    """Draw the regions, and a panel for each model but the finest; legend and notes."""
    shown, handles = [_regions(found, exact)], _region_keys(found)
    for index in range(len(found.models) - 1):
        panel, keys = _model(found, index, exact)
        shown.append(panel)
        handles += keys
    handles += draw_planes(figure, found.result, shown)
    return list({str(handle.get_label()): handle for handle in handles}.values()), []


def regions_figure(found: FidelityMap) -> Figure:
    """The regions alone, small enough for any page."""
    figure = blank_page(ALONE, found.case.figure)
    keys = _region_keys(found) + draw_planes(figure, found.result, [_regions(found, found.plan.boundaries)])
    titled(figure, found.case.figure, "", caption(found))
    legend(figure, keys)
    return figure


def _colours(found: FidelityMap) -> list[str]:
    last = len(found.models) - 1
    return [*(MODELS[min(index, len(MODELS) - 1)] for index in range(last)), FINEST]


def _regions(found: FidelityMap, exact: bool) -> PlanePanel:
    """Shade the cheapest model that suffices; hatch where models differ in kind."""
    apart = np.any([codes != SAME for codes in found.differences], axis=0)

    def draw(axes: Axes, x: Array, y: Array) -> None:
        shade(axes, x, y, found.label, _colours(found))
        if apart.any():
            cells = np.ma.masked_where(~apart, apart)
            axes.pcolor(edges(x), edges(y), cells, cmap=CLEAR, hatch=HATCH, edgecolors="0.15", linewidth=0, zorder=1.5)

    return PlanePanel(0, 0, "cheapest model that suffices", draw, _boundaries(found, found.finest.name, exact))


def _region_keys(found: FidelityMap) -> Handles:
    last, colours = len(found.models) - 1, _colours(found)
    names = [name_of(found.case, model.name) for model in found.models]
    shown = [index for index in range(last + 1) if (found.label == index).any()]
    words = [f"{names[index]} suffices" if index < last else f"{names[index]} is needed" for index in shown]
    apart = any((codes != SAME).any() for codes in found.differences)
    hatched = Patch(facecolor="none", edgecolor="0.25", hatch=HATCH, linewidth=0.5, label="models differ in kind")
    patches = [swatch(colours[index], word) for index, word in zip(shown, words, strict=True)]
    return [*patches, *([hatched] if apart else [])]


def _model(found: FidelityMap, index: int, exact: bool) -> tuple[PlanePanel, Handles]:
    """Shade how far one model is off, and where it differs in kind, and how."""
    share = found.plan.accuracy
    with np.errstate(invalid="ignore"):
        off = np.abs(found.relative[index])
        size = np.select([off <= share, off <= FIVE * share], [0, 1], 2)
    codes = np.where(found.differences[index] == SAME, size, 2 + found.differences[index])
    colours = [NEAR, FAR, FARTHER, *APART.values()]
    words = [
        f"off by up to {share * 100:.3g} %", f"up to {FIVE * share * 100:.3g} %",
        f"more than {FIVE * share * 100:.3g} %", *(DIFFERENCES[code] for code in APART),
    ]  # fmt: skip
    name = found.models[index].name

    def draw(axes: Axes, x: Array, y: Array) -> None:
        shade(axes, x, y, codes, colours)

    title = plain(f"{name_of(found.case, name)} against {found.finest.name}")
    keys = [swatch(colours[code], words[code]) for code in range(len(colours)) if (codes == code).any()]
    return PlanePanel(*place_of(index + 1), title, draw, _boundaries(found, name, exact)), keys


def _boundaries(found: FidelityMap, name: str, exact: bool) -> list[PlaneBoundary]:
    return [curve for curve in found.boundaries if curve.fidelity == name and exact]
