"""Report of a run under a record: answer, tables of fidelities, peaks, energies and impacts, what is uncertain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from math import isfinite
from typing import Any

import numpy as np

from vibeam.figures.record import unit_of_signal
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank
from vibeam.report.transient_answer import (
    DUST,
    ENSEMBLE,
    answers,
    difference_text,
    enough_at,
    time_text,
    transient_answer,
)
from vibeam.runs.comparison.differences import listed
from vibeam.runs.summary import assumed
from vibeam.runs.transient.comparison import TransientComparison
from vibeam.runs.transient.motions import SCALED
from vibeam.runs.transient.result import TransientResult
from vibeam.runs.transient.statistics import SampleMean, mean_of, mean_of_series, windowed_rate
from vibeam.runs.transient.transient import Transient
from vibeam.system.number_text import percent, with_unit
from vibeam.system.response import Ended
from vibeam_models.arguments import counted

OPEN = 1e-3  # residual of an energy balance that is told
SHARES = (0.1, 0.5, 0.9)  # quantiles of impact velocities


def transient_report(result: TransientResult) -> StudySheet:
    """Report of a result under a record."""
    tables = [fidelities(result), peaks(result), energies(result)]
    return StudySheet(
        transient_answer(result, result.case.asked["verdict"].accuracy),
        tables[:1],
        list(remarks(result)),
        list(_details()),
        [*tables[1:], impacts(result), *modal_energies(result), cost(result)],
        _data(result),
        rows=[row for part in result.columns()[0] for row in _rows(part)],
    )


def by_value(result: TransientResult, accuracy: float) -> StudySheet:
    """Sheet of the fidelity that suffices at each value of the factor; as CSV a row a difference."""
    found, told = enough_at(result, accuracy), transient_report(result)
    parts = [(name, [value for value, _ in group]) for name, group in groupby(found, lambda pair: pair[1])]
    said = [f"{name} {_at_values(result, values)}" if len(parts) > 1 else name for name, values in parts]
    values = [{"value": value, "cheapest": name} for value, name in found]
    rows = [
        {"fidelity": name, "value": result.factors[each.at], "enough": found[each.at][1], **plain(each)}
        for name, of in result.comparison.items() for each in of.differences
    ]  # fmt: skip
    answer = f"Enough for {percent(accuracy)} of peaks and the hardest impact: {listed(said)}."
    return replace(
        told,
        answer=answer,
        details=[told.answer, *told.details],
        data={**told.data, "accuracy": accuracy, "values": values},
        rows=rows,
    )


def _at_values(result: TransientResult, values: Sequence[float]) -> str:
    ends = [factor_text(result, values[0]), factor_text(result, values[-1])]
    return f"at {result.over} {' to '.join(dict.fromkeys(ends))}"


def fidelities(result: TransientResult) -> ReportTable:
    """Table of every fidelity at every value: peak of the first signal, impacts, energy, each beside the finest's."""
    first = next(iter(result.values())).signals[0]
    largest = max(float(np.nanmax(each.peak[..., 0], initial=0.0)) for each in result.values())
    unit, factor = unit_of_signal(result.case, first.unit, largest)
    table = _table(result, "Fidelities", "modes|", f"peak {first.name}{_of(result, unit)}|", "off|")
    table.add("impacts|", "off|", f"hardest{_of(result, 'm/s')}|", "off|", "agrees until|", "CPU ratio|")
    cheapest = min(float(np.nansum(each.cpu_seconds)) for each in result.values()) or float("nan")
    finest = {each.finest for each in result.comparison.values()}
    for name, own in result.items():
        of, ratio = result.comparison.get(name), float(np.nansum(own.cpu_seconds)) / cheapest
        for at, head in _values(result, name):
            numbers = [(own.of("peak")[at] * factor, "peak", first.name), (own.of("impacts")[at], "impacts", "")]
            numbers.append((own.of("hardest_impact")[at], "hardest_impact", ""))
            cells = [cell for values, quantity, signal in numbers
                     for cell in (mean_text(mean_of(values)), _off(of, quantity, signal, at))]  # fmt: skip
            until = "finest" * (name in finest) if of is None else _until(of, at)
            table.add_row(*head, str(own.modes), *cells, until, f"{ratio:.3g}")
    table.caption = "\n".join(_caption(result))
    return table


def _caption(result: TransientResult) -> Iterator[str]:
    many = len(result.seeds)
    if many > 1:
        yield f"means over {counted(many, 'realisation')} ± standard errors; off: paired, on the same realisations"
    if result.comparison:
        share = next(iter(result.comparison.values())).tolerance
        yield f"agrees until: hard impacts pair within {time_text(share)} with the finest's (the earliest realisation)"


def mean_text(found: SampleMean) -> str:
    """Mean to four digits with its standard error; a dash where there is none."""
    if not isfinite(found.mean):
        return "–"
    error = f" ± {found.error:.2g}" if found.error > DUST * abs(found.mean) else ""
    return f"{found.mean:.4g}{error}"


def _off(of: TransientComparison | None, quantity: str, signal: str, at: int) -> str:
    if of is None:
        return ""
    try:
        return difference_text(of.difference(quantity, signal, at))
    except KeyError:
        return "–"


def _until(of: TransientComparison, at: int) -> str:
    least = float(np.nanmin(of.horizon[at])) if np.isfinite(of.horizon[at]).any() else float("nan")
    return "–" if not isfinite(least) else "the end" if least >= of.duration else time_text(least)


def peaks(result: TransientResult) -> ReportTable:
    """Table of all signals: largest absolute value, when, root mean square, beside the finest's."""
    table = _table(result, "Peaks", "signal", "peak|", "off|", "before the horizon|", "at|", "rms|", "off|")
    for name, own in result.items():
        of = result.comparison.get(name)
        for at, head in _values(result, name):
            for number, signal in enumerate(own.signals):
                unit, factor = unit_of_signal(result.case, signal.unit, np.nanmax(own.peak[at, :, number], initial=0.0))
                read = [mean_of(own.of(each, signal.name)[at] * factor) for each in ("peak", "rms")]
                when = time_text(mean_of(own.of("peak_time", signal.name)[at]).mean)
                peak, rms = (f"{mean_text(each)} {unit}".strip() for each in read)
                off, rms_off = (_off(of, each, signal.name, at) for each in ("peak", "rms"))
                table.add_row(*head, signal.name, peak, off, _before(result, of, signal.name, at), when, rms, rms_off)
    return table


def _before(result: TransientResult, of: TransientComparison | None, signal: str, at: int) -> str:
    if of is None or signal not in [each.name for each in result[of.finest].signals]:
        return ""
    known = of.off_before[at, :, result[of.finest].signal(signal)]
    return percent(float(np.nanmax(np.abs(known)))) if np.isfinite(known).any() else "–"


def energies(result: TransientResult) -> ReportTable:
    """Table of energies: what came in, where it went, by how much the balance is open."""
    start, work = (f"{each}{_of(result, 'J')}|" for each in ("start", "work"))
    table = _table(result, "Energies", start, work, "by damping|", "to the stop|", "left|", "balance open by|")
    table.caption = "means over the realisations; of the motion relative to the base; shares of start and work"
    for name, own in result.items():
        for at, head in _values(result, name):
            parts = [float(np.nanmean(getattr(own, each)[at].sum(axis=1))) if own.run[at].any() else float("nan")
                     for each in ("start", "work", "damping", "lost", "left")]  # fmt: skip
            put = parts[0] + parts[1]
            shares = [percent(each / put) if put > 0 else "–" for each in parts[2:]]
            worst = float(np.nanmax(own.residual[at], initial=0.0))
            table.add_row(*head, *(f"{each:.4g}" for each in parts[:2]), *shares, f"{worst:.1g}")
    return table


def modal_energies(result: TransientResult) -> Iterator[ReportTable]:
    """Tables of the finest fidelities: work, energy lost and left of every mode, at the last value."""
    last = f"; at {result.over} = {factor_text(result, result.factors[-1])}" * (len(result.factors) > 1)
    finest = {name: result[name] for name in result.finest.values()}
    for name, own in ((name, each) for name, each in finest.items() if each.run[-1].any()):
        heads = (f"{each}{_of(result, 'J')}|" for each in ("work", "by damping", "to the stop", "left"))
        table = blank(f"Energy by mode, {name}", "mode|", *heads)
        table.caption = "to the stop: less than 0 is handed to the mode by impacts" + last
        found = [np.nanmean(getattr(own, each)[-1], axis=0) for each in ("work", "damping", "lost", "left")]
        for mode, row in enumerate(np.transpose(found), 1):
            table.add_row(str(mode), *(f"{each:.3g}" for each in row))
        yield table


def impacts(result: TransientResult) -> ReportTable:
    """Table of impacts: rate, mean velocity and quantiles with their errors, of one realisation as of a series."""
    speeds = (f"{each}{_of(result, 'm/s')}|" for each in ("mean", *map(percent, SHARES)))
    table = _table(result, "Impacts", "first|", "rate (1/s)|", *speeds, "n|", "worth|")
    if result.seeds:
        table.caption = "n impacts in all, whose mean velocity is worth so many independent ones"
    for name, own in result.items():
        for at, head in _values(result, name):
            rate, speed, quantiles = impact_statistics(own, at, bool(result.seeds))
            first = mean_of(own.of("first_impact")[at]).mean
            known = result.seeds and isfinite(speed.effective)
            many, worth = int(own.impacts[at].sum()), f"{speed.effective:.4g}" if known else ""
            cells = [mean_text(each) for each in (rate, speed, *quantiles)]
            table.add_row(*head, time_text(first), *cells, str(many), worth)
    return table


def impact_statistics(own: Transient, at: int, random: bool) -> tuple[SampleMean, SampleMean, list[SampleMean]]:
    """Rate, 1/s, mean velocity and quantiles, m/s, of the impacts at one value.

    Their errors are those over seeds; of one realisation of a random input those of a correlated series; of a load that
    is not random there are none.
    """
    speeds = [each for each, done in zip(own.impact_velocities[at], own.complete[at], strict=True) if done]
    quantiles = [
        mean_of([float(np.quantile(each, share)) if len(each) else np.nan for each in speeds]) for share in SHARES
    ]
    if len(speeds) > 1:
        within = [mean_of_series(each) for each in speeds]
        worth = float(np.nansum([each.effective for each in within]))
        mean = mean_of([each.mean for each in within])
        return mean_of(own.of("impact_rate")[at]), SampleMean(mean.mean, mean.error, mean.n, worth), quantiles
    if not random:
        return mean_of(own.of("impact_rate")[at]), mean_of(own.of("impact_velocity")[at]), quantiles
    times = own.impact_times[at][0]
    return windowed_rate(times, 0.0, own.duration), mean_of_series(speeds[0] if speeds else []), quantiles


def cost(result: TransientResult) -> ReportTable:
    """Table of what a run costs that is done again: CPU time of the motions and of what is read off them."""
    table = blank("Cost", "fidelity", "motions|", "motions, CPU|", "an impact|", "reading, CPU|", "proved")
    for name, own in result.items():
        spent, read = float(np.nansum(own.cpu_seconds)), float(np.nansum(own.reading_seconds))
        struck = int(own.impacts.sum())
        each = f"{1e6 * spent / struck:.3g} µs" if struck else "–"
        asked = own.proved[own.run]
        proved = "" if not len(asked) or (asked < 0).all() else f"{int((asked > 0).sum())} of {len(asked)}"
        table.add_row(name, str(int(own.run.sum())), f"{spent:.3g} s", each, f"{read:.3g} s", proved)
    return table


def remarks(result: TransientResult) -> Iterator[str]:
    """Sentences on what is uncertain, each with what to do."""
    for name, own in result.items():
        for ended in {int(each) for each in own.ended[own.run & ~own.complete]}:
            many = int(np.count_nonzero(own.ended == ended))
            yield f"{name}: {counted(many, 'motion')} not complete: {Ended.of_code(ended).value}"
        if missing := int(np.count_nonzero(~own.run)):
            yield f"{name}: {counted(missing, 'motion')} not run yet: the same vibeam run goes on"
        if (worst := float(np.nanmax(own.residual, initial=0.0))) > OPEN:
            yield f"{name}: the energy balance is open by {percent(worst)}: its energies hold to that"
        if partly := int(np.count_nonzero(own.run & (own.proved == 0))):
            some = counted(partly, "motion")
            yield f"{name}: {some} not proved throughout: path.certificate.unproved says when and why"
    chaotic = [each.name for each in answers(result) if each.chaotic]
    if chaotic and len(result.seeds) < ENSEMBLE:
        cure = "give record.realisations" if result.seeds else "compare statistics over a longer or random record"
        yield f"{listed(chaotic)}: single motions part by chaos, and peaks after that say nothing of a model: {cure}"
    if len(result.seeds) == 1:
        yield "one realisation of a random input: peaks have no sampling error: give record.realisations"
    yield from assumed(result.case)


def _details() -> Iterator[str]:
    yield "acceleration: of flight, contact and rest; the impulses of a rigid stop are no part of it"
    yield "work of the load: on the motion relative to the base"


def factor_text(result: TransientResult, value: float) -> str:
    """Value of the factor with its unit, where it is a key that has one."""
    if result.over in SCALED:
        return f"{value:.4g}"
    return with_unit(value, result.case.keys.unit(result.over))


def _values(result: TransientResult, name: str) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Index of every value, and the first cells of its row."""
    for at, value in enumerate(result.factors):
        yield at, (name, factor_text(result, value)) if len(result.factors) > 1 else (name,)


def _table(result: TransientResult, title: str, *names: str) -> ReportTable:
    varied = len(result.factors) > 1
    return blank(title, "fidelity", *[f"{result.over}|"] * varied, *names, heads=1 + varied)


def _of(result: TransientResult, unit: str) -> str:
    """Unit behind a head; nothing in a case of plain numbers."""
    return f" ({unit})" if unit and result.case.scene.natural_unit is None else ""


def _data(result: TransientResult) -> dict[str, Any]:
    """Content of the JSON object."""
    return {
        "over": result.over, "values": result.factors, "seeds": result.seeds, "finest": result.finest,
        "found": result.found, "total": result.total,
        "fidelities": [_fidelity(result, name, own) for name, own in result.items()],
        "comparison": result.comparison,
    }  # fmt: skip


def _fidelity(result: TransientResult, name: str, own: Transient) -> dict[str, Any]:
    found = {"fidelity": name, "modes": own.modes, "cpu_seconds": float(np.nansum(own.cpu_seconds))}
    numbers, _ = result.columns()
    mine = next(part for part in numbers if part["fidelity"][0] == name)
    return found | {"motions": _rows(mine)}


def _rows(part: dict[str, Any]) -> list[dict[str, Any]]:
    return [dict(zip(part, row, strict=True)) for row in zip(*part.values(), strict=True)]
