"""Sheet of the effects of a case, of a sweep or under a record: which the scene needs, and what each changes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan
from typing import TYPE_CHECKING, Any

from rich.text import Text

from vibeam.case.case import quantity_of
from vibeam.figures.units import METRIC, DisplayUnits, units_of
from vibeam.report.comparison_words import Subject, gravest
from vibeam.report.output import StudySheet
from vibeam.report.record_studies import CAPTION, FEW, ONE, value_text
from vibeam.report.tables import ReportTable, blank
from vibeam.report.variants import (
    SHORT,
    change_cell,
    gravest_number,
    gravest_of,
    share,
    time_text,
    variant_rows,
    within_words,
)
from vibeam.runs.comparison.differences import listed
from vibeam.studies.changes import COMPARED
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.system.number_text import percent
from vibeam.system.number_text import signed as by_percent
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from vibeam.studies.effects import EffectRow, Effects, EffectsVariant

SWEPT = "changes from all effects of {}, ends in frequency; worst: the largest over what is allowed of it"
NAMED = 2  # largest number of effects whose loss is told in the answer
DUST = 1e-6  # share of what is allowed that is round-off


def sheet(study: Effects) -> StudySheet:
    """Sheet of a study; as CSV a row a model and number."""
    rows = list(lines(study))
    return StudySheet(
        answer(study),
        [table(study)],
        list(notes(study)),
        list(details(study)),
        data={
            "fidelity": study.fidelity, "asked": study.asked, "rows": study.rows, "enough": study.enough.kept,
            "exact": study.exact, "models": study.models, "left_out": study.left_out,
        },
        rows=rows,
    )  # fmt: skip


def answer(study: Effects) -> str:
    """Sentence on the effects that the scene needs: what the model gets wrong without them, and without the others."""
    needed = [row.effect for row in study.rows if row.needed]
    others = [row.effect for row in study.rows if not row.needed]
    clauses = [f"without {row.effect} {_loss(study, row)}" for row in study.rows if row.needed][:NAMED]
    clauses += [f"without {listed(others)} {_rest(study)}"] if others else []
    verb = "may need" if study.left_out else "needs"
    said = f"For {percent(study.asked.amplitude)} the scene {verb} {_needed(needed, len(study.rows))}"
    fixed = f" {'The ' * (study.held.coefficient is None)}{study.held.label} is prescribed."
    left = f"; {counted(study.realisations, 'realisation')} left out over the budget" * bool(study.realisations)
    return f"{said}: {', '.join(clauses)}{left}.{fixed}"


def _needed(names: Sequence[str], count: int) -> str:
    if len(names) == count:
        return f"all of its {count} effects" if count > 1 else f"its one effect, {names[0]}"
    return f"{listed(names) if names else 'none'} of its {count} effects" if count > 1 else "no effect"


def _loss(study: Effects, row: EffectRow) -> str:
    """Largest error of the model without an effect, in words."""
    if row.without.left_out:
        return f"what changes is not known ({row.without.why})"
    if row.without.why:
        return f"there is no model ({row.without.why})"
    if row.without.worst <= 1:
        return "beside the others that are left out more than that changes"
    return _gravest(study, row.without)


def _gravest(study: Effects, variant: EffectsVariant) -> str:
    found, top = variant.comparison, gravest_of(variant)
    if top is None or found is None or top.number not in COMPARED or abs(top.change) <= top.allowed:
        return gravest_number(variant)
    return gravest(Subject("the model"), Subject("the whole model"), found, study.asked, _units(study))


def _rest(study: Effects) -> str:
    """Errors of the model that has the needed effects alone, in words."""
    if study.enough.worst <= DUST:
        return "nothing changes"
    found = study.enough.comparison
    if found is not None and found.amplitude is None and not found.ends:
        return f"the peak stays within {percent(study.enough.worst * study.asked.amplitude)}"
    return within_words(study.enough, study.asked, METRIC if found is None else _units(study))


def _units(study: Effects) -> DisplayUnits:
    """Units of a sweep."""
    whole, case = study.whole.response, study.case
    return units_of(case, 0.0 if whole is None else whole.largest, quantity=quantity_of(case, case.sweep.output).name)


def _value(study: Effects, number: AskedNumber) -> str:
    """Number of the model with all effects."""
    value, case = study.whole.mean(number).mean, study.case
    if case.record is not None:
        return value_text(case, number, value)
    units = _units(study)
    if number.quantity.endswith("frequency") or number.quantity.startswith("period"):
        return units.frequencies(value)
    if number.quantity == "apparent_restitution":
        return "–" if isnan(value) else f"{value:.4g}"
    return units.lengths(value) if number.quantity == "peak" else units.speeds(value)


def table(study: Effects) -> ReportTable:
    """Table of every effect: what changes without it, the largest change with it alone, CPU time."""
    numbers = [each.number for each in study.enough.changes]
    heads = [f"{SHORT.get(each, each)}|" for each in numbers]
    other = "" if study.other is None else f"peak, {study.other.symbol} prescribed"
    made = blank("What changes without each effect", "without", "", "worst|", *heads, f"{other}|")
    made.add("with it alone|", "modes|", "CPU|", detail=True)
    made.caption = SWEPT.format(study.fidelity)
    if study.case.record is not None:
        made.caption = CAPTION.format(f"all effects of {study.fidelity}")
    own = ["" if each in COMPARED else _value(study, each) for each in numbers]
    made.add_row("nothing", "", "", *own, "", "", str(study.whole.modes), time_text(float(study.whole.seconds.sum())))
    made.add_section()
    for row in study.rows:
        made.add_row(row.effect, *_cells(row, numbers))
    return made


def _cells(row: EffectRow, numbers: Sequence[AskedNumber]) -> Iterator[str | Text]:
    yield Text("needed", style="bold") if row.needed else Text("not needed", style="green")
    yield share(row.without.worst)
    found = {each.number: each for each in row.without.changes}
    yield from (change_cell(found[each]) if each in found else "–" for each in numbers)
    yield "" if isnan(row.other_peak) else by_percent(row.other_peak)
    yield share(row.alone.worst)
    yield from ("–", "–") if row.without.why else (str(row.without.modes), time_text(row.without.seconds))


def notes(study: Effects) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    if study.left_out:
        cure = "allow more (--budget), or sweep less (influence.points, influence.settle)"
        yield f"{counted(study.left_out, 'set')} of effects left out for the time that they take: {cure}."
    elif not study.exact:
        yield "Effects were left out one after another: try a smaller set by [fidelity.NAME] without = […]."
    if study.case.record is not None:
        yield FEW if study.whole.seconds.shape[1] > 1 else ONE
    turning = [row.effect for row in study.rows if row.turns]
    if turning and study.other is not None:
        key = f"'stop.restitution_of=\"{study.other.restitution_of}\"'"
        yield (
            f"What {listed(turning)} change{'s' * (len(turning) == 1)} of the peak turns with what is prescribed, "
            f"{study.held.label} or {study.other.label}: --set {key} compares so."
        )


def details(study: Effects) -> Iterator[str]:
    """Reasons of what is not known, and how the needed set was found."""
    for row in study.rows:
        if row.without.why and not row.without.left_out:
            yield f"{row.effect} cannot be left out of the case as it is ({row.without.why}): needed."
        elif not row.needed and row.without.worst > 1:
            others = [other.effect for other in study.rows if not other.needed and other is not row]
            yield f"{row.effect} is not needed, but only where {listed(others)} is left out too: together they cancel."
        yield from (f"Without {row.effect}, {each}" for each in row.without.remarks)
    yield from (f"With all effects, {number}: {why}" for number, why in study.whole.why.items())
    tried = "No smaller set of effects suffices" if study.exact else "Not all sets were tried"
    yield f"{tried}: {counted(study.models, 'model')} computed."


def lines(study: Effects) -> Iterator[dict[str, Any]]:
    """Rows of every model and number."""
    models = [(row.effect, name, each) for row in study.rows
              for name, each in (("without", row.without), ("alone", row.alone))]  # fmt: skip
    for effect, model, variant in [*models, ("", "needed", study.enough)]:
        yield from variant_rows(variant, effect=effect, model=model, effects=" ".join(variant.kept))
