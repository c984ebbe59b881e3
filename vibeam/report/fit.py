"""Sheets of a fit and of an identification: answer, tables, JSON, figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import partial
from math import floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.held import PLACES, held_of
from vibeam.case.plans import FigurePlan
from vibeam.report.measured import curves_figure
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.runs.comparison.differences import listed
from vibeam.studies.fit.judgement import Judgement
from vibeam.studies.fit.linear_estimates import Estimate, Identification
from vibeam.studies.fit.profile import FitRow
from vibeam.studies.fit.study import FitStudy, FittedPoint
from vibeam.system.number_text import begun, percent, shown_in, with_unit
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.case.case import Case

CURVE = 121  # frequencies of a fitted branch
PANEL_MOST = 4  # references with a panel


def sheet(study: FitStudy) -> StudySheet:
    """Sheet of a fit: answer, tables, remarks, keys as CSV, figure."""
    tables = [_estimates(study.rows, study.judgement), *([_next(study)] if study.next else [])]
    said = fit_answer(study)
    notes = [each for each in study.sentences if each not in (said, *study.facts)]
    return StudySheet(
        said, tables, notes, [each for each in study.facts if each != said], data=as_data(study), rows=study.rows,
        draw=partial(fit_figure, study),
    )  # fmt: skip


def fit_answer(study: FitStudy) -> str:
    """Estimated keys in one sentence, with the coefficient that is meant; or that the model does not fit them."""
    if study.judgement.rejected or not study.judgement.described:
        return study.sentences[0]
    open_keys = [row.key for row in study.rows if not row.determined]
    used = sum(not point.left_out for point in study.points)
    points = f"{used} of {len(study.points)} points" if used < len(study.points) else counted(used, "point")
    if open_keys:
        fault = "cannot separate" if study.shared else "does not determine" if used == 1 else "do not determine"
        shared = "".join(f": {each}" for each in study.shared[:1])
        cure = "" if study.next else "; --next says what to measure"
        known = "".join(f" {row.key} is {_value(row)}." for row in study.rows if row.determined)
        return f"The {points} {fault} {listed(open_keys)} within the bounds{shared}{cure}.{known}"
    found = listed([f"{row.key} {_value(row)}" for row in study.rows])
    rms = f"rms residual {(study.misfit / used) ** 0.5:.2g} of their uncertainty"
    return f"{found} describe{'s' * (len(study.rows) == 1)} the {points} (± at 95 %; {rms}){_restitution(study)}."


def _restitution(study: FitStudy) -> str:
    meant = restitution_meant(study.case)
    if meant and any(row.key == "stop.restitution" for row in study.rows):
        return f"; stop.restitution is {meant}"
    return f"; {held_of(study.case.scene).label} is held" if meant else ""


def restitution_meant(case: Case) -> str:
    """Coefficient that ``stop.restitution`` gives, as mode 1 sees it or at the contact; empty of a contact law."""
    held = held_of(case.scene)
    return "" if held.coefficient is None else f"{held.symbol} {PLACES.get(held.restitution_of, 'at the contact')}"


def _value(row: FitRow | Estimate) -> str:
    """Value and half its interval, a share of it; a number near 0 or of a plain one; both ends where one is a bound."""
    size, half, unit = abs(row.value), (row.high - row.low) / 2, "" if row.unit == "1" else row.unit
    if isinstance(row, FitRow) and (row.low_bound or row.high_bound):
        found = row.ends(" to ")
    elif half > size / 2 or (not unit and 0.1 < size <= 1):
        found = f"± {with_unit(half, unit, 2)}"
    else:
        found = f"± {percent(float(f'{half / size:.2g}'))}"
    value = round(row.value, 1 - floor(log10(half))) + 0.0 if half > 2 * size else row.value
    return f"{with_unit(value, unit)} ({found})"


def identification_sheet(found: Identification) -> StudySheet:
    """Sheet of an identification: values with intervals, what a file was taken as, what is not fixed."""
    known = [f"{row.name} {_value(row)}" for row in found.leading if row.determined]
    unknown = listed([row.name for row in found.rows if not row.determined])
    of = f"the {found.points} {f'points of the {found.of}' if found.of else 'measured modal frequencies'}"
    told = f"{listed(known)} describe{'s' * (len(known) == 1)} {of} (± at 95 %; rms residual "
    told += f"{percent(found.residual)}){f', which do not fix {unknown}' if unknown else ''}"
    told = told if known else f"{of} do not fix {unknown}"
    because = f"; taken as {'an' if found.of[0] == 'a' else 'a'} {found.of}, since {found.why}" if found.of else ""
    answer = f"{begun(told) if found.of or not known else told}{because}."
    names = [each.name for each in fields(found) if each.name != "curve" and getattr(found, each.name) != ""]
    data = {name: getattr(found, name) for name in names}
    draw = None if found.curve is None else partial(curves_figure, [found.curve], FigurePlan(), "", found.orders)
    notes = [*found.directions, *found.notes]
    return StudySheet(answer, [_identified(found)], notes, data=data, rows=found.rows, draw=draw)


def _identified(found: Identification) -> ReportTable:
    """Identified parameters: value and 95 % interval, a dash where the data do not fix it."""
    table = blank("Identified", "parameter", "value|", "95 % interval|", "±|", "unit")
    table.caption = "\n".join(filter(None, [found.method, found.shapes]))
    for row in found.rows:
        half = 0.5 * (row.high - row.low)
        digits = 4 if not half > 0 else max(2, min(9, 2 + floor(log10(abs(row.value) / half))))
        unit, factor = shown_in("" if row.unit == "1" else row.unit, row.value, row.low, row.high)
        value, low, high = (f"{factor * each:.{digits}g}" for each in (row.value, row.low, row.high))
        numbers = [value, f"{low} … {high}", percent(abs(half / row.value))]
        table.add_row(row.name, *(numbers if row.determined else ["not determined", "–", "–"]), unit)
    return table


def _estimates(rows: Sequence[FitRow], judgement: Judgement) -> ReportTable:
    table = blank("Estimated keys", "key", "value|", "95 % from|", "to|", "unit", "the case's own|")
    for row in rows:
        unit, factor = shown_in(row.unit, row.value, row.low, row.high, row.start)
        value = f"{row.value * factor:.5g}" if row.determined else "not determined"
        low, high = (
            "withheld" if judgement.withheld else f"{end * factor:.5g}{' (bound)' * bool(bound)}"
            for end, bound in ((row.low, row.low_bound), (row.high, row.high_bound))
        )
        table.add_row(row.key, value, low, high, unit, f"{row.start * factor:.5g}")
    table.caption = _caption(judgement)
    return table


def _caption(judgement: Judgement) -> str:
    if judgement.withheld:
        return "no intervals: the model does not describe the points"
    told = "intervals by profile likelihood; (bound): a bound in [fit] ends it, not the data"
    if judgement.scale > 1:
        told += f"\nscaled by {judgement.scale:.3g}, as if all uncertainties were larger: the model misses the points"
    return told


def _next(study: FitStudy) -> ReportTable:
    settings, first = list(study.next[0].settings), study.next[0]
    table = blank("What to measure next", "frequency|", *(f"{each}|" for each in settings), "motion", "value|")
    table.add("interval then|")
    unit = next(row.unit for row in study.rows if row.key == first.key)
    quantity = study.case.references[study.points[0].reference].quantity
    plain = study.case.scene.given_mode is not None
    for each in study.next:
        values = (with_unit(each.settings[name], study.case.keys.unit(name)) for name in settings)
        value = with_unit(each.value, "" if plain else "m/s" if quantity == "impact_velocity" else "m")
        table.add_row(f"{each.frequency:.5g} Hz", *values, each.motion, value, f"± {with_unit(each.after, unit, 3)}")
    table.caption = (
        f"the interval of {first.key} is ± {with_unit(first.before, unit, 3)} now; linearised; the best of each setting"
    )
    return table


def as_data(study: FitStudy) -> dict[str, Any]:
    """Content for JSON."""
    profiles = {
        row.key: [[*study.problem.values(each[:-1]).tolist(), float(each[-1])] for each in found.path]
        for row, found in zip(study.rows, study.profiles, strict=True)
    }
    names = ("rows", "misfit", "judgement", "covariance", "points", "next", "sentences")
    return {name: getattr(study, name) for name in names} | {"profiles": profiles}


def fit_figure(study: FitStudy) -> Figure:
    """Points, fitted branch and band above residuals, a column a reference."""
    from vibeam.figures.page import blank_page, legend, titled

    names = list(dict.fromkeys(point.reference for point in study.points))[:PANEL_MOST]
    figure = blank_page((1.4 + 2.9 * len(names), 4.6), study.case.figure)
    grid = figure.add_gridspec(2, len(names), height_ratios=[3, 1])
    handles: dict[str, Any] = {}
    first: Axes | None = None
    for column, name in enumerate(names):
        upper = figure.add_subplot(grid[0, column])
        lower = figure.add_subplot(grid[1, column], sharex=upper, sharey=first)
        first = first or lower
        handles |= _response(study, name, upper)
        _residuals([each for each in study.points if each.reference == name], lower)
        upper.tick_params(labelbottom=False)
        upper.set_title(name)
        lower.set_xlabel("drive frequency in Hz")
        if column == 0:
            lower.set_ylabel("residual in σ")
    legend(figure, handles)
    titled(figure, study.case.figure, study.case.title, "measured points, fitted branches and 95 % band")
    return figure


def _scale(study: FitStudy, name: str) -> tuple[float, str]:
    """Factor and label of a reference's quantity."""
    from vibeam.figures.units import units_of

    quantity = study.case.references[name].quantity
    largest = max(abs(each.measured) for each in study.points if each.reference == name)
    units = units_of(study.case, largest, largest)
    fast = quantity == "impact_velocity"
    unit, factor = (units.speed, units.speed_factor) if fast else (units.length, units.length_factor)
    return factor, quantity.replace("_", " ") + (f" in {unit}" if unit else "")


def _response(study: FitStudy, name: str, axes: Axes) -> dict[str, Any]:
    from vibeam.figures.style import COLOURS

    points = [each for each in study.points if each.reference == name]
    factor, label = _scale(study, name)
    frequency = np.array([each.frequency for each in points])
    grid = np.linspace(frequency.min(), frequency.max(), CURVE)
    handles: dict[str, Any] = {}
    for number, motion in enumerate(dict.fromkeys(each.motion for each in points if not each.left_out)):
        own = [each.frequency for each in points if each.motion == motion]
        part = grid[(grid >= min(own)) & (grid <= max(own))]
        best, error = study.branch(name, motion, part)
        low, high = best - 1.96 * error, best + 1.96 * error
        keys: dict[str, Any] = {"color": COLOURS[number], "zorder": 2}
        band = axes.fill_between(part, factor * low, factor * high, alpha=0.3, linewidth=0, **keys)
        handles[f"fitted, {motion}; 95 % band"] = band, *axes.plot(part, factor * best, linewidth=1.1, **keys)
    handles["measured, ± 2 σ"] = axes.errorbar(
        frequency, [factor * each.measured for each in points], [2 * factor * each.uncertainty for each in points],
        fmt="o", color="black", markersize=2.6, elinewidth=0.6, zorder=3,
    )  # fmt: skip
    for called, lost in (
        ("nearest motion is none of the model", [each for each in points if not each.actual and not each.left_out]),
        ("left out", [each for each in points if each.left_out]),
    ):
        if not lost:
            continue
        (handles[called],) = axes.plot(
            [each.frequency for each in lost], [factor * each.measured for each in lost], "o", markersize=6,
            markerfacecolor="none", markeredgecolor="#D55E00" if called != "left out" else "0.5", linestyle="none",
        )  # fmt: skip
    axes.set_ylabel(label)
    return handles


def _residuals(points: Sequence[FittedPoint], axes: Axes) -> None:
    axes.axhspan(-1.96, 1.96, color="0.92", zorder=0)
    axes.axhline(0.0, color="0.5", linewidth=0.6)
    axes.plot(
        [each.frequency for each in points], [each.residual for each in points], "o", color="black", markersize=2.6
    )
    axes.margins(y=0.15)  # no point lies on the frame
