"""Sheets of the studies of a case under a record: fidelities by value, modes, effects, uncertain inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from vibeam.case.case import Case, plan_of_record, units_of_output
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.report.output import StudySheet
from vibeam.report.tables import blank
from vibeam.runs.comparison.differences import listed
from vibeam.studies.changes import NumberChange
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import OF_IMPACTS
from vibeam.system.number_text import begun, modes_in_words, percent, signed, with_unit
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.studies.record.fidelities import RecordFidelities
    from vibeam.studies.record.modes import RecordModes
    from vibeam.studies.uncertainty.recorded_inputs import RecordUncertainty

ONE = "one realisation: a motion that impacts make sensitive is one draw of many: record.realisations gives errors"
FEW = "errors are counted twice: more record.realisations narrow them"
CAPTION = "changes from {} on the same realisations, at the value where they are largest; ±: two standard errors"
SHORT_HORIZON = 0.5  # share of the record


def unit_of_number(case: Case, number: AskedNumber) -> str:
    """SI unit of a number; empty of a plain one, and in a case without dimensions."""
    if case.scene.natural_unit is not None:
        return ""
    kind = QUANTITIES[number.quantity].unit
    if kind != "q":
        return {"c/s": "m/s", "E": "J", "s": "s", "s-1": "1/s"}.get(kind, "")
    rates = {"_velocity": "m/s", "_acceleration": "m/s^2", "contact_force": "N"}
    if number.signal not in [each.name for each in case.scene.outputs]:
        for ending, known in rates.items():
            if number.signal.endswith(ending):
                return known
    return units_of_output(case, number.signal).output.replace(" s-2", "/s^2").replace(" s-1", "/s").replace("1", "")


def value_text(case: Case, number: AskedNumber, value: float) -> str:
    """A number with its unit; a dash where there is none."""
    return "–" if isnan(value) else with_unit(value, unit_of_number(case, number))


def change_text(change: NumberChange) -> str:
    """A change as percent, with two standard errors where they are known."""
    if isnan(change.change):
        return "–"
    if not isfinite(change.change):
        return "was 0"
    return signed(change.change) + (f" ± {percent(2 * change.error)}" if isfinite(change.error) else "")


def of_fidelities(study: RecordFidelities) -> StudySheet:
    """Sheet of the fidelity that suffices at each value."""
    over = plan_of_record(study.case).over
    numbers = [each.number for each in study.values[0].rows[0].changes]
    table = blank("Which fidelity suffices", f"{over}|", "enough", "fidelity", *(f"{each}|" for each in numbers))
    table.add("CPU a motion|", "impacts pair until|", "the finest's own|", detail=True)
    table.caption = f"changes from {study.finest} on the same realisations; ±: two standard errors"
    for found in study.values:
        for row in found.rows:
            parting = percent(row.horizon), percent(row.own_horizon)
            cells = [*map(change_text, row.changes), f"{1e3 * row.seconds:.3g} ms", *parting]
            table.add_row(f"{found.value:g}", found.cheapest, row.fidelity, *cells)
    parts = [(name, [each.value for each in group]) for name, group in groupby(study.values, lambda v: v.cheapest)]
    said = [f"{name} {_of_values(over, values)}" if len(parts) > 1 else name for name, values in parts]
    several = f" on {counted(study.realisations, 'realisation')}" if study.realisations > 1 else ""
    judge = f"{percent(study.accuracy)} of the peaks, against {study.finest}, which was flown everywhere{several}"
    notes = [FEW if study.realisations > 1 else ONE]
    if study.left_out:
        notes.append(f"{listed(study.left_out)}: left out, for another rig than {study.finest}'s")
    notes += _parting(study)
    rows = [
        _row(each, value=at.value, cheapest=at.cheapest, fidelity=row.fidelity)
        for at in study.values
        for row in at.rows
        for each in row.changes
    ]
    data = {"over": over, "accuracy": study.accuracy, "finest": study.finest, "values": study.values}
    return StudySheet(f"Enough for {judge}: {listed(said)}.", [table], notes, data=data, rows=rows, study="fidelities")


def _of_values(over: str, values: Sequence[float]) -> str:
    ends = f"{values[0]:g}" if len(values) == 1 else f"{values[0]:g} to {values[-1]:g}"
    return f"at {over} {ends}"


def _parting(study: RecordFidelities) -> Iterator[str]:
    """Sentence on a finest fidelity whose motions part from themselves."""
    own = [row.own_horizon for found in study.values for row in found.rows if row.own_horizon < SHORT_HORIZON]
    if own:
        yield (
            f"{study.finest} parts from itself under a load larger by 1e-6 after {percent(min(own))} of the record: "
            "beyond that motions differ by chaos, and means over realisations compare"
        )


def of_modes(study: RecordModes) -> StudySheet:
    """Sheet of the number of modes that suffices."""
    numbers = [each.number for each in study.rows[0].changes]
    table = blank("How many modes", "modes|", *(f"{each}|" for each in numbers), "CPU a motion|")
    table.caption = CAPTION.format(f"{study.modes} modes of {study.fidelity}")
    for row in study.rows:
        table.add_row(str(row.modes), *map(change_text, row.changes), f"{1e3 * row.seconds:.3g} ms")
    enough, within = study.enough(), percent(study.accuracy)
    if enough is None:
        last = study.rows[-1]
        answer = (
            f"No fewer than {modes_in_words(study.modes)} of {study.fidelity} are known to be within {within} of the "
            f"peaks: {modes_in_words(last.modes)} are up to {percent(last.worst)} off"
        )
    else:
        [row] = [row for row in study.rows if row.modes == enough]
        answer = (
            f"{begun(modes_in_words(enough))} of {study.fidelity} suffice{'s' * (enough == 1)} for {within} of the "
            f"peaks: {percent(row.worst)} off at most from {modes_in_words(study.modes)}"
        )
    others = ((name.replace("_", " "), study.enough(name)) for name in OF_IMPACTS)
    further = "; ".join(f"{name}: {count or f'more than {study.rows[-1].modes}'}" for name, count in others)
    notes = [f"modes for {within} of what hangs on each impact: {further}", FEW if study.realisations > 1 else ONE]
    rows = [_row(each, modes=row.modes) for row in study.rows for each in row.changes]
    data = {"fidelity": study.fidelity, "enough": enough, "modes": study.modes, "rows": study.rows}
    answer += f"{_left_out(study.left_out)}."
    return StudySheet(answer, [table], notes, data=data, rows=rows, study="modes")


def _left_out(seeds: int) -> str:
    return f"; {counted(seeds, 'realisation')} left out over the budget" if seeds else ""


def of_uncertainty(study: RecordUncertainty) -> StudySheet:
    """Sheet of uncertain inputs carried through a record."""
    case, first = study.case, study.rows[0]
    nominal, low, high = (
        value_text(case, first.number, each)
        for each in (first.spread.nominal, first.spread.quantiles[0], first.spread.quantiles[-1])
    )
    keys, shares = [each.key for each in case.uncertain], first.indices.total[:, 0]
    top = max(range(len(keys)), key=lambda at: shares[at] if isfinite(shares[at]) else -1.0)
    answer = f"{begun(str(first.number))}, {study.fidelity}: {nominal}, and {low} to {high} in 90 % of the samples"
    if isfinite(shares[top]):
        answer += f"; {percent(float(shares[top]))} of its variance comes with {keys[top]}"
    heads = ("nominal|", "mean|", "5 % … 95 %|", *(f"{key}|" for key in keys))
    table = blank("What the inputs make of the record", "number", *heads)
    table.caption = "under each key its share in the variance, together with others (total Sobol' index)"
    for row in study.rows:
        spread = [value_text(case, row.number, each) for each in (row.spread.nominal, row.spread.mean)]
        ends = " … ".join(value_text(case, row.number, row.spread.quantiles[at]) for at in (0, -1))
        parts = [f"{each:.2f}" if isfinite(each) else "–" for each in row.indices.total[:, 0]]
        table.add_row(str(row.number), *spread, ends, *parts)
    same = f"each on the same {counted(study.realisations, 'realisation')}"
    cost = f"{1e3 * study.seconds:.3g} ms of CPU time a sample"
    made = f"{study.replicates} independent scramblings of {study.samples // study.replicates} Sobol' points"
    notes = [f"{study.motions} samples of {study.fidelity} ({made}), {same}, {cost}"]
    mean = [value_text(case, first.number, each) for each in first.spread.mean_within]
    notes.append(f"mean of the {first.number} between {' and '.join(mean)} (95 %)")
    if isfinite(shares[top]):
        within = " … ".join(percent(float(each[top, 0])) for each in (first.indices.low, first.indices.high))
        notes.append(f"the share of {keys[top]} lies in {within} (95 %): --samples narrows it")
    if study.failed:
        notes.append(f"{study.failed} samples did not run to the record's end, and are left out")
    data = {"rows": study.rows, "samples": study.samples, "replicates": study.replicates, "seed": study.seed}
    return StudySheet(f"{answer}.", [table], notes, data=data, rows=list(_spread_rows(study, keys)))


def _spread_rows(study: RecordUncertainty, keys: Sequence[str]) -> Iterator[Mapping[str, Any]]:
    for row in study.rows:
        found, ends = row.spread, row.spread.quantiles
        head = {"number": str(row.number), "nominal": found.nominal, "mean": found.mean, "deviation": found.deviation}
        totals = {f"total {key}": float(row.indices.total[at, 0]) for at, key in enumerate(keys)}
        yield head | {"low": ends[0], "high": ends[-1]} | totals


def _row(change: NumberChange, **head: Any) -> Mapping[str, Any]:
    found = {"number": str(change.number), "mean": change.mean, "change": change.change, "error": change.error}
    return {**head, **found}
