"""Sheet and figure of a map of motions under a record: one key as lines with their errors, two as a plane."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from math import isfinite
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.grid_keys import AxisPlan
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import looks_of, name_of
from vibeam.maps.axes import name_of_key
from vibeam.report.output import StudySheet
from vibeam.report.record_studies import FEW, ONE, unit_of_number, value_text
from vibeam.report.tables import blank
from vibeam.studies.record.plane import RecordMap
from vibeam.system.number_text import begun, shown_in, with_unit
from vibeam_models.arguments import counted

PANEL = 4.4, 3.4  # inches


def sheet(found: RecordMap) -> StudySheet:
    """Sheet of a map: where the number is largest, the ends of each fidelity, all points as CSV, their figure."""
    case, names = found.case, list(found.means)
    table = blank("Over the map", "fidelity", "least|", "at", "greatest|", "at")
    said = []
    for name in names:
        values = found.means[name]
        if not np.isfinite(values).any():
            table.add_row(name, "–", "", "–", "")
            continue
        ends = [np.unravel_index(int(pick(values)), values.shape) for pick in (np.nanargmin, np.nanargmax)]
        cells = [(value_text(case, found.number, float(values[at])), _place(found, at)) for at in ends]
        table.add_row(name, *cells[0], *cells[1])
        said.append(f"{name} up to {cells[1][0]} ({cells[1][1]})")
    failed = sum(int(np.count_nonzero(np.isnan(each))) for each in found.means.values())
    notes = [FEW if found.realisations > 1 else ONE]
    if failed:
        notes.append(f"{counted(failed, 'point')} without the number: no impact there, or a motion that ended early")
    over = " and ".join(axis.key for axis in found.axes)
    answer = f"{begun(str(found.number))} over {over}: {'; '.join(said) or 'there is none anywhere'}."
    data = {"axes": found.axes, "number": found.number, "means": found.means, "errors": found.errors}
    return StudySheet(answer, [table], notes, data=data, rows=_rows(found), draw=lambda: figure(found), study="map")


def _place(found: RecordMap, at: tuple[Any, ...]) -> str:
    pairs = zip(found.axes, at, strict=True)
    return ", ".join(f"{axis.key} {with_unit(axis.values[index], axis.unit)}" for axis, index in pairs)


def _rows(found: RecordMap) -> list[Mapping[str, Any]]:
    rows: list[Mapping[str, Any]] = []
    for name, values in found.means.items():
        for at in product(*(range(len(axis.values)) for axis in found.axes)):
            keys = {axis.key: axis.values[index] for axis, index in zip(found.axes, at, strict=True)}
            mean, error = float(values[at]), float(found.errors[name][at])
            rows.append({"fidelity": name, **keys, str(found.number): mean, "error": error})
    return rows


def figure(found: RecordMap) -> Figure:
    """Lines of all fidelities over one key, with two standard errors; a plane for each over two."""
    known = [float(each) for values in found.means.values() for each in values.ravel() if isfinite(each)]
    unit, factor = shown_in(unit_of_number(found.case, found.number), *known)
    label = f"{begun(str(found.number))}{f' ({unit})' if unit else ''}"
    names = list(found.means)
    size = (PANEL[0] * (len(names) if len(found.axes) > 1 else 1.3), PANEL[1])
    made = blank_page(size, found.case.figure)
    if len(found.axes) == 1:
        _lines(made.subplots(), found, factor, label)
    else:
        _planes(made, found, factor, label)
    seeds = f", mean of {counted(found.realisations, 'realisation')}" if found.realisations > 1 else ""
    if seeds and len(found.axes) == 1:
        seeds += " with two standard errors"
    titled(made, found.case.figure, found.case.title, f"{found.number}{seeds}")
    legend(made, {})
    return made


def _scaled(found: RecordMap, axis: AxisPlan) -> tuple[np.ndarray[Any, Any], str]:
    unit, factor = shown_in(axis.unit, *axis.values)
    name = begun(name_of_key(found.case, axis.key))
    return np.array(axis.values) * factor, f"{name} ({unit})" if unit else name


def _lines(axes: Axes, found: RecordMap, factor: float, label: str) -> None:
    across, head = _scaled(found, found.axes[0])
    looks = looks_of(found.case, found.means)
    for name, values in found.means.items():
        colour, error = looks[name].colour, 2 * found.errors[name]
        axes.plot(across, values * factor, label=name_of(found.case, name), **looks[name].keys())
        if np.isfinite(error).any():
            low, high = (values - error) * factor, (values + error) * factor
            axes.fill_between(across, low, high, color=colour, alpha=0.2, lw=0)
    axes.set(xlabel=head, ylabel=label)
    axes.legend(frameon=False)


def _planes(made: Figure, found: RecordMap, factor: float, label: str) -> None:
    (up, upward), (across, head) = (_scaled(found, axis) for axis in found.axes)
    every = np.concatenate([each.ravel() for each in found.means.values()]) * factor
    ends = (float(np.nanmin(every)), float(np.nanmax(every))) if np.isfinite(every).any() else (0.0, 1.0)
    panels = np.ravel(made.subplots(1, len(found.means), sharey=True, squeeze=False))
    for axes, (name, values) in zip(panels, found.means.items(), strict=True):
        drawn = axes.pcolormesh(
            across, up, values * factor, vmin=ends[0], vmax=ends[1], shading="nearest", rasterized=True
        )
        axes.set_title(name_of(found.case, name))
        axes.set_xlabel(head)
    panels[0].set_ylabel(upward)
    made.colorbar(drawn, ax=list(panels), label=label)
