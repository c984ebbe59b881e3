"""Panels of error against CPU time: amplitudes above, ends of branches and kinds of motion below, a mark a model."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import Any

from vibeam.figures.style import COLOURS
from vibeam.report.comparison_words import LEAST, MOST, SDOF
from vibeam.runs.comparison.errors import Asked
from vibeam.solvers import SOLVERS

DARK = "0.25"
LABELS = {"amplitude": "amplitude error (%)", "frequency": "ends, other motion (%)"}
SLACK = 3.0  # factor between the marks and the edge of a panel


def error_panels(
    figure: Any, names: Sequence[str], errors: Sequence[Any], asked: Asked, reference: float = nan
) -> None:  # fmt: skip
    """Draw the panels of the ``names`` above each other: ``ModelError`` over the CPU time of a point.

    ``reference``: that of the reference.
    """
    grid = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(grid, names, strict=True):
        known = [each for each in errors if each.seconds > 0 and getattr(each, name).value >= 0]
        _panel(axes, known, name)
        axes.set_ylabel(LABELS[name])
        allowed = {"color": "0.5", "linewidth": 0.8, "linestyle": ":", "label": "error that is allowed"}
        axes.axhline(100 * getattr(asked, name), gid=f"asked-{name}", **allowed)
        _scale(axes)
        if reference > 0:
            axes.axvline(1e3 * reference, color="0.8", linewidth=3.4, zorder=0, label="time of the reference")
    grid[-1].set_xlabel("CPU time of a point (ms)")


def _panel(axes: Any, errors: Sequence[Any], name: str) -> None:
    """Draw a mark for each model, those of one model by one solver joined."""
    models = list(dict.fromkeys(each.model for each in errors if each.solver))
    colours = {model: COLOURS[at % len(COLOURS)] for at, model in enumerate(models)}
    joined: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for each in errors:
        by = f"-{each.solver}" * bool(each.solver)
        error, colour = getattr(each, name), colours[each.model] if each.solver else DARK
        at = 1e3 * each.seconds, 100 * min(max(error.value, LEAST), MOST)
        shape, size, label = ("D", 5.0, "reference, against a fuller model") if each.beyond else ("o", 5.0, "model")
        if each.solver:
            joined.setdefault((each.model, each.solver), []).append(at)
            (shape, size), label = SOLVERS[each.solver].marker, each.solver
        axes.plot(
            *at, linestyle="", marker=shape, markersize=size, color=colour, zorder=3, label=label,
            markerfacecolor="white" if error.open else colour, gid=f"{name}-of-{each.model}{by}",
        )  # fmt: skip
        below = each.mark == SDOF  # beside one mode, where it often lies
        axes.annotate(each.mark, at, (4, -9 if below else 3), textcoords="offset points", fontsize="small")
    for (model, _), points in joined.items():
        axes.plot(*zip(*points, strict=True), color=colours[model], linewidth=0.8, zorder=2, label=model)


def _scale(axes: Any) -> None:
    """Logarithmic axes with plain numbers and room around the marks."""
    from matplotlib.ticker import LogLocator, NullLocator

    axes.set(xscale="log", yscale="log")
    low, high = axes.dataLim.intervaly
    axes.set_ylim(low / SLACK, high * SLACK)
    axes.margins(x=0.12)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(NullLocator())
