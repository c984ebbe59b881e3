"""Figure of the number of modes: the response of what suffices beside all modes, both errors over CPU time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.figures.units import DisplayUnits, units_of, with_unit
from vibeam.report.comparison_words import size
from vibeam.system.number_text import modes_in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.runs.comparison.errors import ResponseComparison
    from vibeam.studies.modes_needed import ModesNeeded, ModesTried

LEAST = 1e-5  # error that is drawn, at least


def every(found: ModesNeeded) -> str:
    """All modes, or those that stand for them."""
    return f"{'all ' * (found.modes == found.size > 1)}{modes_in_words(found.modes)}"


def modes_figure(found: ModesNeeded) -> Figure:
    """The responses over each other, with the largest errors where they are; errors over the CPU time of a point."""
    from vibeam.figures.page import blank_page, titled

    figure = blank_page((8.2, 3.6), found.case.figure)
    responses, errors = figure.subplots(1, 2, width_ratios=[1.35, 1.0])
    _responses(responses, found)
    _errors(errors, found)
    titled(figure, found.case.figure, found.case.title, f"models beside {every(found)}")
    return figure


def _responses(axes: Any, found: ModesNeeded) -> None:
    from vibeam.figures.style import COLOURS

    largest = max((float(np.nanmax(each.amplitude, initial=0.0)) for each in found.curves), default=0.0)
    units = units_of(found.case, largest)
    numbers = list(dict.fromkeys(each.modes for each in found.curves))
    for each in found.curves:
        rank = numbers.index(each.modes)
        look = {"color": "0.25" if rank == 0 else COLOURS[rank - 1], "linewidth": 2.4 if rank == 0 else 1.0}
        style = "-" if each.direction == "up" else "--"
        name = modes_in_words(each.modes) if each.direction == found.curves[0].direction else None
        axes.plot(
            each.frequency * units.frequency_factor, each.amplitude * units.length_factor, style, label=name,
            zorder=2 + rank, gid=f"response-{each.modes}-{each.direction}", **look,
        )  # fmt: skip
    axes.set_xlabel(with_unit("frequency", units.frequency))
    axes.set_ylabel(with_unit("amplitude", units.length))
    axes.legend(fontsize="small")
    row = found.enough or next((each for each in reversed(found.rows) if each.comparison is not None), None)
    if row is not None and row.comparison is not None:
        _marks(axes, row.comparison, units)


def _marks(axes: Any, found: ResponseComparison, units: DisplayUnits) -> None:
    """Mark the largest amplitude error and the largest shift of an end where they are."""
    if found.amplitude is not None:
        at = found.amplitude.frequency * units.frequency_factor
        levels = [each * units.length_factor for each in (found.amplitude.ours, found.amplitude.reference)]
        _mark(axes, ([at, at], levels), found.amplitude_error, "#D55E00", "amplitude-error")
    if found.ends and abs(found.ends[0].error) > found.ends[0].open:
        first, low = found.ends[0], axes.get_ylim()[0]
        places = [each.frequency * units.frequency_factor for each in (first.ours, first.reference)]
        _mark(axes, (places, [low, low]), abs(first.error), "#0072B2", "frequency-error")


def _mark(axes: Any, ends: tuple[list[float], list[float]], error: float, colour: str, name: str) -> None:
    axes.plot(*ends, "|-", color=colour, markersize=8, zorder=9, gid=name)
    corner = max(ends[0]), max(ends[1])
    axes.annotate(size(error), corner, (4, 4), textcoords="offset points", fontsize="small", color=colour)


def _errors(axes: Any, found: ModesNeeded) -> None:
    from matplotlib.ticker import LogLocator

    from vibeam.figures.style import COLOURS

    rows = [row for row in found.rows if row.comparison is not None and row.seconds > 0]
    if not rows:
        axes.set_axis_off()
        axes.text(0.5, 0.5, "no fewer modes were swept", ha="center", transform=axes.transAxes, gid="errors-none")
        return
    names = ("amplitudes", "ends of branches, kinds")
    for colour, name, pick in zip(COLOURS, names, (_amplitude, _frequency), strict=False):
        times, sizes = [1e3 * row.seconds for row in rows], [100 * max(pick(row), LEAST) for row in rows]
        axes.plot(times, sizes, "o", color=colour, label=name, gid=f"errors-{name.split()[0]}")
        allowed = found.asked.amplitude if pick is _amplitude else found.asked.frequency
        axes.axhline(100 * allowed, color=colour, linewidth=0.8, linestyle=":")
    for row in rows:
        axes.annotate(str(row.modes), (1e3 * row.seconds, 100 * max(_amplitude(row), LEAST)), (3, 4),
                      textcoords="offset points", fontsize="small")  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="CPU time of a point (ms)", ylabel="error (%)")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(LogLocator(subs=(2, 5)))
        axis.set_minor_formatter("{x:g}")
    axes.legend(fontsize="small", title="dotted: what is asked; numbers: modes", title_fontsize="small")


def _amplitude(row: ModesTried) -> float:
    return 0.0 if row.comparison is None or row.comparison.amplitude is None else row.comparison.amplitude_error


def _frequency(row: ModesTried) -> float:
    return 0.0 if row.comparison is None else max(row.comparison.frequency_error, row.comparison.kind_width)
