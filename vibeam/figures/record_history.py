"""Histories of a record case: input, output, impacts, contact force over time, whole and around the largest value."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import plan_of_record
from vibeam.figures.panels import is_empty, labelled, say
from vibeam.figures.record import COLUMNS, RecordResult, input_of, kept_place, label_of, signals_of_all, unit_of_signal
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.figures.units import with_unit
from vibeam.observe.decimation import History, hardest_impacts
from vibeam_models.arrays import Array

Span = tuple[float, float]
SIZE = (8.4, 6.0)
ROW, REST = 1.25, 1.1  # height of a row and of title, legend and axis beside all rows, inches
CLOSE, MET = 1 / 40, 4  # share of the record around its largest value, and impacts to either side, that are shown
INK, PALE = "0.2", 0.15  # PALE: opacity of an area


def draw_histories(
    figure: Figure, result: RecordResult, names: Sequence[str], output: str, window: Span | None = None,
    columns: int = COLUMNS,
) -> None:  # fmt: skip
    """Draw the motion whose histories are kept, a row a signal of ``output``: the whole record, and a part of it.

    ``window``: begin and end of the part, s; None: around the largest value. ``columns``: least and greatest values of
    a panel, at most.
    """
    signals = {key: each for key, each in signals_of_all(result, names).items() if each.output in (output, "contact")}
    own = [each for each in signals.values() if each.order < 0 or (each.output == output and each.order < 2)]
    driven = any(each.peak > 0 for each in result.input.values())
    rows = [
        *[None] * driven,
        *(each for each in own if each.order >= 0),
        "impacts",
        *(each for each in own if each.order < 0),
    ]
    spans = list(_spans(result, names, own))
    if window is not None:
        spans[1:] = [window]
    grid = figure.subplots(len(rows), len(spans), sharex="col", sharey="row", squeeze=False)
    looks = looks_of(result.case, names)
    for row, signal in zip(grid, rows, strict=True):
        for axes, span in zip(row, spans, strict=True):
            if signal == "impacts":
                _impacts(axes, result, looks, span, columns)
            else:
                _signal(axes, result, looks, signal, span, columns)
    for axes, span in zip(grid[-1], spans, strict=True):
        axes.set_xlim(*span)
        labelled(axes, "time", "s" if result.case.scene.natural_unit is None else "", across=True)
    figure.set_figheight((ROW * len(rows) + REST) * figure.get_figwidth() / SIZE[0])


def _spans(result: RecordResult, names: Sequence[str], signals: Sequence[Any]) -> Iterator[Span]:
    """The whole record, and the part around the largest value of the first signal with some impacts to either side."""
    first = [each.name for each in signals[:1]]
    known = [(own[key], name) for key in first for name in names if key in (own := result[name].history)]
    if not known:
        yield 0.0, plan_of_record(result.case).duration
        return
    history, name = max(known, key=lambda each: each[0].peak)
    begin, end = float(history.edges[0]), float(history.edges[-1])
    yield begin, end
    at = float(history.time[np.argmax(np.maximum(-history.least, history.greatest))])
    times, half = _impacts_of(result, name)[0], CLOSE * (end - begin) / 2
    near = np.sort(np.abs(times - at))
    if len(near) > 2 * MET:
        half = float(near[2 * MET])
    low = min(max(at - half, begin), end - 2 * half)
    if 2 * half < (end - begin) / 2:
        yield low, low + 2 * half


def _impacts_of(result: RecordResult, name: str) -> tuple[Array, Array]:
    place, own = kept_place(result), result[name]
    return own.impact_times[place][0], own.impact_velocities[place][0]


def _signal(axes: Axes, result: RecordResult, looks: dict[str, Look], signal: Any, span: Span, columns: int) -> None:
    """Draw a signal of all fidelities in one panel; None: the input."""
    case = result.case
    if signal is None:
        histories = [(each, Look(INK), "") for each in list(result.input.values())[:1]]
        label, unit = input_of(case)
    else:
        owners = [name for name in looks if signal.name in result[name].history]
        histories = [(result[name].history[signal.name], looks[name], name_of(case, name)) for name in owners]
        label, unit = label_of(signal), signal.unit
    shown, factor = unit_of_signal(case, unit, max((each.peak for each, _, _ in histories), default=0.0))
    for history, look, name in histories:
        _envelope(axes, history.within(*span, most=columns), factor, look, name)
    if is_empty(axes):
        say(axes, "no history kept")
    _named(axes, label, shown)


def _envelope(axes: Axes, seen: History, factor: float, look: Look, label: str) -> None:
    """Outline the least and the greatest values; the area is pale, so that what lies behind it is seen."""
    axes.fill_between(
        seen.time, seen.least * factor, seen.greatest * factor, facecolor=(look.colour, PALE), edgecolor=look.colour,
        linewidth=0.6 * look.wide, label=label or None,
    )  # fmt: skip


def _impacts(axes: Axes, result: RecordResult, looks: dict[str, Look], span: Span, columns: int) -> None:
    """Draw the hardest impact of each column of the panel as a line from 0 to its velocity."""
    edges, met = np.linspace(*span, columns // 2 + 1), []
    for name, look in looks.items():
        times, speeds = _impacts_of(result, name)
        inside = (times >= span[0]) & (times <= span[1])
        met.append((*hardest_impacts(times[inside], speeds[inside], edges)[:2], look))
    largest = max((float(np.max(speeds, initial=0.0)) for _, speeds, _ in met), default=0.0)
    unit, factor = unit_of_signal(result.case, "m s-1", largest)
    for times, speeds, look in met:
        axes.vlines(times, 0.0, speeds * factor, color=look.colour, linewidth=0.8 * look.wide)
        if len(times) <= 16 * MET:
            axes.plot(times, speeds * factor, ".", color=look.colour, markersize=4 * look.wide)
    if not largest:
        say(axes, "no impact")
    _named(axes, "velocity before impact", unit)


def _named(axes: Axes, what: str, unit: str) -> None:
    """Name of a row and its unit, above its first panel."""
    if axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
        axes.set_title(with_unit(what, unit), loc="left", fontsize=7.5)
