"""Uncertainty study as tables, sentences, a figure and CSV."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import Case, quantity_of
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, amplitude_of, frequency_label, units_of
from vibeam.report.fit import restitution_meant
from vibeam.report.output import StudySheet
from vibeam.report.record_studies import of_uncertainty
from vibeam.report.tables import ReportTable, blank, plain
from vibeam.studies.uncertainty.statistics import LEVELS, Distribution, ErrorRow
from vibeam.system.number_text import percent, shown_in
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from vibeam.studies.uncertainty.study import UncertaintyStudy


ROUGH = 0.5  # width of the interval of a share, from which on it is told


def units_in(study: UncertaintyStudy) -> DisplayUnits:
    """Units by the largest amplitude."""
    output = quantity_of(study.case, study.case.sweep.output).name
    return units_of(study.case, float(np.nanmax(study.finest.bands, initial=0.0)), quantity=output)


def sheet(study: Any, case: Case | None = None) -> StudySheet:
    """Sheet of a study: spread of the peak and its main source, tables, remarks, bands as CSV, their figure."""
    if case is not None and case.record is not None:
        return of_uncertainty(study)
    said, uncertain, further = answer(study), list(notes(study)), list(details(study))
    data = {
        "inputs": study.uncertain, "samples": study.samples, "replicates": study.replicates, "seed": study.seed,
        "frequency": study.frequency, "fidelities": study.rows, "sensitivity": study.over_frequency,
        "sensitivity_of_peak": study.of_peak, "errors": study.errors, "sentences": [said, *uncertain, *further],
    }  # fmt: skip
    more = [each for each in (beside(study), changes(study), errors(study)) if each is not None]
    return StudySheet(
        said, [inputs(study), fidelities(study)], uncertain, further, more, data, list(rows(study)),
        lambda: bands(study, units_in(study)),
    )  # fmt: skip


def inputs(study: UncertaintyStudy) -> ReportTable:
    """Table of the uncertain inputs, with their shares in the variance of the finest fidelity's peak."""
    table = blank("Uncertain inputs", "key", "distribution")
    table.add("mean|", detail=True)
    table.add("std. deviation|", "unit")
    table.add("first order|", detail=True)
    table.add("total|", "95 % of it|")
    table.caption = (
        "total: share of the peak's variance, together with others (Sobol' index; may pass 0 and 1)\n"
        "first order, with -v: what it gives alone"
    )
    found, keys, plain_numbers = study.of_peak, study.case.keys, study.case.scene.natural_unit is not None
    for place, each in enumerate(study.uncertain):
        unit, factor = ("", 1.0) if plain_numbers else shown_in(keys.unit(each.key), each.middle, each.deviation)
        kind = "normal" if each.kind == "normal" else f"uniform, {each.first * factor:.6g} … {each.second * factor:.6g}"
        first, total, low, high = (
            f"{part[place, 0]:.2f}" if isfinite(part[place, 0]) else "–"
            for part in (found.first, found.total, found.low, found.high)
        )
        mean, deviation = f"{each.middle * factor:.6g}", f"{each.deviation * factor:.3g}"
        table.add_row(each.key, kind, mean, deviation, unit, first, total, f"{low} … {high}" if total != "–" else "–")
    return table


def fidelities(study: UncertaintyStudy) -> ReportTable:
    """Table of the peak, its frequency and the end of period 1 of each fidelity over the samples."""
    units = units_in(study)
    length, hertz = (f" ({unit})" if unit else "" for unit in (units.length, units.frequency))
    table = blank("What the inputs make of the sweep", "fidelity", f"peak{length}|", "mean|", "5 % … 95 %|")
    table.add(f"at{hertz}|", "5 % … 95 %|")
    table.add(f"period 1 ends{hertz}|", "5 % … 95 %|", "samples|", "failed|", "CPU each|", detail=True)
    table.caption = "first number of each: at the case's own values; period 1 ends, with -v: in the way of the sweep"
    for row in study.rows:
        cells = [*_spread(row.peak, units.lengths, mean=True), *_spread(row.peak_frequency, units.frequencies)]
        cells += [*_spread(row.jump, units.frequencies), str(row.samples), str(row.failed or "–")]
        table.add_row(row.fidelity, *cells, f"{1e3 * row.seconds:.3g} ms")
    return table


def beside(study: UncertaintyStudy) -> ReportTable | None:
    """Table of the errors of each other fidelity in the samples; None without another one."""
    table = blank(f"Beside {study.finest.fidelity} in each sample", "fidelity", "amplitudes (%)|", "5 % … 95 %|")
    table.add("ends, kinds (%)|", "5 % … 95 %|", "suffices|")
    table.caption = "first: at the case's own values; ends, kinds to the sweep's grid; suffices: surely … perhaps"
    for row in study.rows[:-1]:
        cells = *_spread(row.amplitude_error, percent), *_spread(row.end_error, percent)
        table.add_row(row.fidelity, *cells, " … ".join(dict.fromkeys(map(percent, row.suffices))))
    return table if table.rows else None


CHANGES = (("begin", "impacts begin"), ("doubling", "period 1 becomes 2"))


def changes(study: UncertaintyStudy) -> ReportTable | None:
    """Table of where impacts begin and period 1 doubles in the sweeps; None where neither happens in any."""
    units = units_in(study)
    hertz = f" ({units.frequency})" if units.frequency else ""
    table = blank("Where motions change", "fidelity", "change", f"at{hertz}|", "5 % … 95 %|", "of the samples|")
    table.caption = "first of each in the way of the sweep, to its grid; first number: at the case's own values"
    for row in study.rows:
        for name, words in CHANGES:
            each: Distribution = getattr(row, name)
            if each.share > 0:
                table.add_row(row.fidelity, words, *_spread(each, units.frequencies), percent(each.share))
    return table if table.rows else None


def _spread(each: Distribution, show: Callable[[float], str], mean: bool = False) -> Iterator[str]:
    yield plain(show(each.nominal))
    if mean:
        yield plain(show(each.mean))
    yield f"{plain(show(each.quantiles[0]))} … {plain(show(each.quantiles[-1]))}"


def errors(study: UncertaintyStudy) -> ReportTable:
    """Table of the uncertainties of the peak side by side, after ASME V&V 20."""
    units = units_in(study)
    unit = f" ({units.length})" if units.length else ""
    table = blank(
        "Errors of the peak side by side", "fidelity", f"peak{unit}|", "numerical|", "by the inputs|", "data|"
    )
    table.add("to the finest|", "measured|", "to the measured|", "u_val|")
    table.caption = (
        "standard uncertainties; numerical: beside a fuller model; by the inputs: standard deviation;\n"
        "data: of the measurement; u_val: the root of the sum of their squares (ASME V&V 20). –: not known here"
    )
    for row in study.errors:
        values = (row.numerical, row.given, row.uncertainty, row.form, row.measured, row.comparison, row.validation)
        table.add_row(row.fidelity, *(plain(units.lengths(value)) for value in (row.peak, *values)))
    return table


def answer(study: UncertaintyStudy) -> str:
    """Spread of the finest fidelity's peak, its main source, and the error of the coarsest reduction beside it."""
    peak, units = study.finest.peak, units_in(study)
    low, high = (units.lengths(peak.quantiles[place]) for place in (0, -1))
    told = f"The peak of {study.finest.fidelity} is {units.lengths(peak.nominal)}; 90 % of the samples are between "
    told += f"{low} and {high}"
    if (main := _main(study)) is not None:
        place, share, rough = main
        part = "the largest part" if rough else percent(float(f"{min(share, 1.0):.2g}"))
        told += f", {part} of their variance involves {study.uncertain[place].key}"
    coarse = max(_reductions(study), key=lambda row: abs(row.form), default=None)
    if coarse is not None:
        side = "lower" if coarse.form < 0 else "higher"
        told += f"; the peak of {coarse.fidelity} is {percent(abs(coarse.form / peak.nominal))} {side} with the same "
        told += f"{restitution_meant(study.case) or 'contact law'}, {_beside(study, coarse)}"
    return f"{told}."


def _main(study: UncertaintyStudy) -> tuple[int, float, bool] | None:
    """Place and share of the input with the largest total index, whether that is known roughly; None: no other one."""
    found = study.of_peak
    if len(study.uncertain) < 2 or not np.isfinite(found.total[:, 0]).any():
        return None
    place = int(np.nanargmax(found.total[:, 0]))
    return place, float(found.total[place, 0]), not found.high[place, 0] - found.low[place, 0] <= ROUGH


def _reductions(study: UncertaintyStudy) -> list[ErrorRow]:
    """Rows of the fidelities below the finest whose difference to it can be set against the spread."""
    spread = study.finest.peak.deviation
    return [row for row in study.errors[:-1] if isfinite(row.form) and spread > 0]


def _beside(study: UncertaintyStudy, row: ErrorRow) -> str:
    return f"{abs(row.form) / study.finest.peak.deviation:.2g} standard deviations of the samples"


def notes(study: UncertaintyStudy) -> Iterator[str]:
    """Remarks: which models a measurement tells apart, what is known roughly, what validates nothing, what failed."""
    for row in _reductions(study):
        told = "tells" if abs(row.form) > 2 * study.finest.peak.deviation else "need not tell"
        yield (
            f"{row.fidelity} is off {study.finest.fidelity} by {_beside(study, row)}: a measured peak of one such rig "
            f"{told} the two apart."
        )
    if (main := _main(study)) is not None and main[2]:
        low, high = (part[main[0], 0] for part in (study.of_peak.low, study.of_peak.high))
        known = f"between {low:.2f} and {high:.2f}" if isfinite(low) else "known roughly"
        told = f"{study.uncertain[main[0]].key}'s share is {known} by {study.samples} samples"
        yield f"{told}: --samples {2 * study.samples} says it better."
    for row in (each for each in study.errors if each.chose):
        yield f"The measured peak chose {', '.join(row.chose)} of {row.fidelity}: it validates nothing there."
    failed = [f"{row.failed} of {row.fidelity}" for row in study.rows if row.failed]
    if failed:
        yield f"Samples with a point that failed: {', '.join(failed)}; bands and indices leave these out."


def details(study: UncertaintyStudy) -> Iterator[str]:
    """Samples and replicates; intervals of the peak's mean and of its quantiles."""
    units, peak = units_in(study), study.finest.peak
    yield (
        f"{study.samples} samples of {counted(len(study.uncertain), 'input')}: {study.replicates} independent "
        f"scramblings of {study.samples // study.replicates} Sobol' points each; intervals are Student's t of these."
    )
    ends = {
        "mean": peak.mean_within,
        **{percent(level): each for level, each in zip(LEVELS, peak.within, strict=False)},
    }
    known = {name: each for name, each in ends.items() if np.isfinite(each).all()}
    if known:
        told = (f"{name} between {' and '.join(map(units.lengths, each))}" for name, each in known.items())
        yield f"Mean and quantiles of {study.finest.fidelity}'s peak, 95 % intervals: {', '.join(told)}."


def rows(study: UncertaintyStudy) -> Iterator[dict[str, Any]]:
    """Rows of every fidelity and frequency; indices in those of the finest; missing values are empty."""
    for row in study.rows:
        for place, frequency in enumerate(study.frequency):
            found = {"fidelity": row.fidelity, "frequency": float(frequency), "nominal": row.nominal[place]}
            found |= {f"quantile_{level:g}": row.bands[at, place] for at, level in enumerate(LEVELS)}
            for at, each in enumerate(study.uncertain):
                last = row is study.finest
                found[f"first_order {each.key}"] = study.over_frequency.first[at, place] if last else np.nan
                found[f"total {each.key}"] = study.over_frequency.total[at, place] if last else np.nan
            yield {name: "" if value != value else value for name, value in found.items()}


def bands(study: UncertaintyStudy, units: DisplayUnits) -> Figure:
    """Bands on the curve of each fidelity above the total indices of the finest one's amplitude."""
    figure = blank_page((7.0, 6.0), study.case.figure)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    _draw_bands(study, upper, units)
    frequency = study.frequency * units.frequency_factor
    for place, each in enumerate(study.uncertain):
        keys = look(len(study.rows) + place).keys(1.2)  # no colour of a fidelity
        lower.plot(frequency, study.over_frequency.total[place], label=f"total index of {each.key}", **keys)
    totals = study.over_frequency.total
    low, high = (float(bound(totals[np.isfinite(totals)], initial=edge)) for bound, edge in ((np.min, 0), (np.max, 1)))
    lower.set_ylim(low - 0.05 * (low < 0), high + 0.05)  # scatter of samples passes 0 and 1
    lower.set_ylabel("share of the variance")
    lower.set_xlabel(frequency_label(units))
    caption = (
        f"nine of ten (light) and half (dark) of {study.finest.samples} samples; dashed ends: of the other fidelities"
    )
    titled(figure, study.case.figure, study.case.title, caption)
    handles = [each for axes in (upper, lower) for each in axes.get_legend_handles_labels()[0]]
    legend(figure, handles)
    return figure


def _draw_bands(study: UncertaintyStudy, axes: Axes, units: DisplayUnits) -> None:
    frequency = study.frequency * units.frequency_factor
    own = looks_of(study.case, [row.fidelity for row in study.rows])
    for row in study.rows:
        edges, colour = row.bands * units.length_factor, own[row.fidelity].colour
        label = name_of(study.case, row.fidelity)
        if row is study.finest:
            axes.fill_between(frequency, edges[0], edges[-1], color=colour, alpha=0.18, linewidth=0)
            axes.fill_between(frequency, edges[1], edges[-2], color=colour, alpha=0.30, linewidth=0)
        else:
            for edge in (edges[0], edges[-1]):
                axes.plot(frequency, edge, color=colour, linewidth=0.7, linestyle=(0, (3, 2)))
        axes.plot(frequency, row.nominal * units.length_factor, label=label, **own[row.fidelity].keys(1.2))
    axes.set_ylim(bottom=0)
    axes.set_ylabel(amplitude_of(study.case.sweep.output, units))
