"""Common parts of the figures: titles, labels and limits of axes, looks of the fidelities, notes, mark of the stop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

from vibeam.case.case import Case, quantity_of
from vibeam.case.plans import ShowPlan
from vibeam.figures.page import plain
from vibeam.figures.sheet import Sheet
from vibeam.figures.style import GAP, Look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, frequency_label, with_unit
from vibeam_models.arrays import Array

DECADES = 10  # decades below the largest value: smaller values are round-off
ROW = 0.028  # height of a row of marks of failed points, in axes
SLIGHT, MARGIN = 1e-3, 0.1  # relative range below which all points coincide; margin around one
TOP = 0.4  # share of the largest value that the range of all values is below, for an axis that does not start at 0
CUT = ((-1.0, -0.5), (1.0, 0.5))  # stroke of the mark of such an axis
NOT_FROM_ZERO = "the axis does not start at 0"


def start_upward(panels: Sequence[Axes]) -> str:
    """Start upward axes of one scale at 0, or mark them where all that is drawn lies in their upper part.

    Return what their label has to add: nothing, or that they do not start at 0.
    """
    boxes = [axes.dataLim for axes in panels if not is_empty(axes)]
    low, high = (min(box.y0 for box in boxes), max(box.y1 for box in boxes)) if boxes else (0.0, 0.0)
    if not SLIGHT * high < high - low < TOP * high:
        for axes in panels:
            from_zero(axes)
        return ""
    for axes in panels:
        for height in (0.03, 0.05):
            axes.plot(
                0, height, transform=axes.transAxes, clip_on=False, marker=CUT, markersize=7, color="black",
                markeredgewidth=0.8, gid="not-from-zero",
            )  # fmt: skip
    return NOT_FROM_ZERO


def from_zero(axes: Axes) -> None:
    """Start the upward axis at 0; its upper end goes on to scale with whatever is drawn."""
    (anchor,) = axes.plot([], [], linestyle="")
    anchor.sticky_edges.y.append(0.0)
    axes.update_datalim([(0.0, 0.0)], updatex=False)
    axes.autoscale(enable=True, axis="y")


def decades(axes: Axes, values: list[Array], least: float = 0.0) -> None:
    """Logarithmic upward axis, ten decades at most below the largest of ``values``, and not below ``least``."""
    known = np.concatenate([np.empty(0), *values])
    known = known[np.isfinite(known) & (known > 0)]
    if not len(known):
        return
    axes.set_yscale("log")
    top = float(known.max())
    bottom = max(float(known[known >= top * 10.0**-DECADES].min()) / 2, least)
    axes.set_ylim(min(bottom, top / 10), 2 * top)


def around(panels: Sequence[Axes]) -> None:
    """Widen shared limits where all points coincide, so that round-off does not fill the figure."""
    boxes = [axes.dataLim for axes in panels if not is_empty(axes)]
    if not boxes:
        return
    box = Bbox.union(boxes)
    for low, high, limit in ((box.x0, box.x1, panels[0].set_xlim), (box.y0, box.y1, panels[0].set_ylim)):
        size = max(abs(low), abs(high))
        if high - low <= SLIGHT * size:
            limit(low - MARGIN * size, high + MARGIN * size)


def mark_failed(axes: Axes, frequency: Array, row: int, **look: Any) -> None:
    """Mark frequencies without a motion, in rows along the upper edge."""
    if len(frequency):
        height = np.full(len(frequency), 1 - ROW * (row + 0.7))
        axes.plot(frequency, height, transform=axes.get_xaxis_transform(), **look)


def is_empty(axes: Axes) -> bool:
    """True where no point, line or bar lies on these axes."""
    return not bool(np.all(np.isfinite(axes.dataLim.get_points())))


def say(axes: Axes, text: str) -> None:
    """Write a note in the middle of axes; of empty ones by themselves the scales go, which are of nothing."""
    shared = (axes.get_shared_x_axes(), axes.get_shared_y_axes())
    if is_empty(axes) and all(len(each.get_siblings(axes)) == 1 for each in shared):
        axes.set(xticks=[], yticks=[])
    axes.text(0.5, 0.5, plain(text), transform=axes.transAxes, ha="center", va="center", color="0.35", wrap=True)


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
    """Draw the mean of a column over frequency, its spread between impacts as a band; False without data."""
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


def across_frequency(axes: Axes, units: DisplayUnits) -> None:
    """Label the frequency axis."""
    axes.set_xlabel(frequency_label(units))


STOP = "stop"  # legend entry of the stop
FAR = 3.0  # distance, in largest displacements, beyond which a stop is not drawn


def titled(axes: Axes, units: DisplayUnits, frequency: float) -> None:
    """Title a panel with its frequency (Hz)."""
    number = f"{frequency * units.frequency_factor:.5g}"
    axes.set_title(f"{number} {units.frequency}" if units.frequency else f"Ω/ω = {number}")


def labelled(axes: Axes, what: str, unit: str, across: bool = False) -> None:
    """Label an axis with its unit, the one across or the one upward."""
    (axes.set_xlabel if across else axes.set_ylabel)(with_unit(what, unit))


def sheets_at(case: Case, frequency: float, plan: ShowPlan, shown: Sequence[Sheet]) -> list[tuple[Sheet, Look]]:
    """Sheets of one frequency (Hz) that have numbers, in the plan's order, with the looks of their fidelities."""
    sheets = {sheet.fidelity: sheet for sheet in reversed(shown) if sheet.frequency == frequency and not sheet.fault}
    looks = looks_of(case, plan.fidelities)
    return [(sheets[name], looks[name]) for name in plan.fidelities if name in sheets]


def faults_at(case: Case, frequency: float, plan: ShowPlan, shown: Sequence[Sheet], axes: Axes) -> None:
    """Note in an empty panel of one frequency (Hz) why there is no motion."""
    faults = {sheet.fault: None for sheet in shown if sheet.frequency == frequency and sheet.fault}
    if is_empty(axes):
        say(axes, "\n".join(faults) or "nothing to show")


def name_faults(case: Case, plan: ShowPlan, shown: Sequence[Sheet]) -> dict[str, Any]:
    """Legend entries of fidelities without a motion at some frequencies: where, unless everywhere, and why."""
    looks = looks_of(case, plan.fidelities)
    found: dict[str, Any] = {}
    for name in plan.fidelities:
        own = [sheet for sheet in shown if sheet.fidelity == name]
        for fault in dict.fromkeys(sheet.fault for sheet in own if sheet.fault):
            some = sum(sheet.fault == fault for sheet in own)
            where = "" if some == len(own) else f" at {some} of {len(own)} frequencies"
            handle = Line2D([], [], **looks[name].keys())
            found[f"{name_of(case, name)}{where}: {fault}"] = handle
    return found


def stop_at(case: Case, plan: ShowPlan) -> list[float]:
    """Output displacement at contact with the stop, each value once; none where modes leave it undetermined."""
    found = set()
    for name in plan.fidelities if not quantity_of(case, plan.output).rate else ():
        system = case.system(name)
        row = system.output(plan.output)
        if system.size == 1:
            found.add(float(system.gap * row[0] / system.contact[0]))
        elif plan.output == "contact":
            found.add(float(system.gap))
    return sorted(found)


def mark_stop(case: Case, plan: ShowPlan, shown: Sequence[Sheet], mark: Any, axes: Axes, factor: float) -> None:
    """Draw the stop by ``mark`` (axhline or axvline), unless it is so far away that the motion would look flat."""
    largest = max((float(np.abs(sheet["displacement"]).max()) for sheet in shown if not sheet.fault), default=0.0)
    places = stop_at(case, plan)
    near = [place for place in places if largest == 0 or abs(place) <= FAR * largest]
    for place in near:
        mark(place * factor, label=STOP, **GAP)
    if len(near) < len(places):
        axes.plot([], [], label=f"{STOP}: beyond the figure", **GAP)
