"""Sheets of the studies of a case under a record: fidelities by value, modes, effects, uncertain inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from vibeam.case.case import Case, units_of_output
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.report.output import StudySheet
from vibeam.report.tables import blank
from vibeam.studies.changes import NumberChange
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.system.number_text import begun, percent, signed, with_unit
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.studies.uncertainty.recorded_inputs import RecordUncertainty

ONE = "one realisation: a motion that impacts make sensitive is one draw of many: record.realisations gives errors"
FEW = "errors are counted twice: more record.realisations narrow them"
CAPTION = "changes from {} on the same realisations, at the value where they are largest; ±: two standard errors"


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
