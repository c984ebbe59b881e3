"""Influence of each effect as terminal tables and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import ceil, isfinite, isinf
from shlex import quote
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.text import Text

from vibeam.case.plans import FigurePlan
from vibeam.figures.page import blank_page, legend, titled
from vibeam.figures.style import COLOURS
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.runs.comparison.differences import both_peaks, doubts, listed, settled
from vibeam.system.number_text import signed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.influence.curve import Change, Interest
    from vibeam.studies.influence.study import EffectRow, InfluenceStudy, Variant


SHORT = {
    "peak": "peak",
    "peak_frequency": "at",
    "period_one_from": "period 1 from",
    "period_one_to": "to",
    "ringing": "ringing",
    "ringing_frequency": "at",
    "apparent_restitution": "apparent R",
}

SHOWN = {"m": ("mm", 1e3), "m/s": ("mm/s", 1e3), "Hz": ("Hz", 1.0), "1": ("", 1.0)}
USUAL = FigurePlan()
LEAST, MOST = 1e-3, 1e3  # changes over tolerance: larger ones are drawn at the ends
MOVED = 0.005  # relative change above which a mode's frequency counts as changed


def sheet(study: InfluenceStudy, case: Case) -> StudySheet:
    """Sheet of a study of ``case``; as CSV a row a model and quantity."""
    said = list(details(study))
    return StudySheet(
        answer=answer(study),
        tables=[taken_away(study)],
        notes=list(uncertain(study, case)),
        details=said,
        more=[left_alone(study)],
        data={"study": study, "sentences": said},
        rows=list(lines(study)),
        draw=lambda: bars(study, case.figure),
        coarse=True,
    )


NAMED = 2  # largest number of effects whose loss is told in the answer
DUST = 1e-6  # share of a tolerance that is round-off


def answer(study: InfluenceStudy) -> str:
    """Sentence on the effects that the scene needs: what changes most without them, and without the others."""
    needed = [row for row in study.rows if row.needed]
    others = [row.effect for row in study.rows if not row.needed]
    losses = [f"without {row.effect} {_loss(study, row)}" for row in needed[:NAMED]]
    if others:
        kept = f"every quantity stays within {share(study.enough.worst)} of its tolerance"
        losses.append(f"without {listed(others)} {kept if study.enough.worst > DUST else 'nothing changes'}")
    needs = f"{_needed([row.effect for row in needed], len(study.rows))}: {', '.join(losses)}."
    return f"With {study.comparison.what} held, the scene {'may need' if study.left_out else 'needs'} {needs}"


def _needed(names: Sequence[str], count: int) -> str:
    if len(names) == count:
        return f"all of its {count} effects" if count > 1 else f"its one effect, {names[0]}"
    return f"{listed(names) if names else 'none'} of its {count} effects" if count > 1 else "no effect"


def _loss(study: InfluenceStudy, row: EffectRow) -> str:
    """Largest error without an effect: of the peak, where that is beyond the tolerance."""
    if row.without.why:
        return "there is no model"
    pairs = list(zip(study.quantities, row.without.changes, strict=True))
    if row.influence <= 1:
        return "beside the others that are left out, some quantity is beyond its tolerance"
    beyond = [pair for pair in pairs if pair[0].name == "peak" and pair[1].share > 1]
    quantity, each = (beyond or [max(pairs, key=lambda pair: pair[1].share)])[0]
    if not isfinite(each.amount):
        return f"{_label(quantity)} is not there to compare"
    return f"{_label(quantity)} is {_amount(quantity, each).lstrip('+-')} too {'high' if each.amount > 0 else 'low'}"


def _label(quantity: Interest) -> str:
    return quantity.label.replace("its", "the peak's" if quantity.name.startswith("peak") else "the ringing's")


def taken_away(study: InfluenceStudy) -> ReportTable:
    """Table of every effect's contribution, and of the changes when it alone is taken away."""
    table = blank("When one effect is taken away", "without", "", "influence|")
    _add_quantities(table, study, [row.without for row in study.rows])
    table.add("coordinates|", "modes|", "CPU|", detail=True)
    low, high, points = study.frequency
    swept = f"{points} frequencies from {low:.5g} to {high:.5g} Hz" if points > 1 else f"at {low:.5g} Hz"
    table.caption = (
        f"{study.fidelity}, {swept}, {study.settle} + {study.hold} periods; influence: the largest change over its "
        "tolerance; *: -v says why"
    )
    whole = (str(study.whole.coordinates), str(study.whole.modes), _milliseconds(study.whole.cpu))
    table.add_row("nothing: as it is", "", "", *_values(study), *whole)
    table.add_section()
    for row in study.rows:
        verdict = Text("needed", style="bold") if row.needed else Text("not needed", style="green")
        table.add_row(row.effect, verdict, share(row.influence), *_changes(study, row.without), *_added(row))
    return table


def _add_quantities(table: ReportTable, study: InfluenceStudy, variants: Sequence[Variant]) -> None:
    """Add a column for each quantity, as a detail where none of the models has a change of it."""
    for index, quantity in enumerate(study.quantities):
        changes = [each.changes[index] for each in variants]
        moved = any(isfinite(each.amount) and each.share > DUST for each in changes)
        table.add(f"{SHORT[quantity.name]}|", detail=not moved)


def left_alone(study: InfluenceStudy) -> ReportTable:
    """Table of the distance to the complete model with each effect alone, with none, and with the sufficient ones."""
    table = blank("When one effect alone is left", "with", "worst|")
    shown = [("none", study.bare), *((row.effect, row.alone) for row in study.rows)]
    _add_quantities(table, study, [variant for _, variant in shown])
    table.add("coordinates|", "modes|")
    table.caption = "changes against the model with all effects; worst: the largest of them over its tolerance"
    for name, variant in [*shown, ("the needed ones", study.enough)]:
        if variant is study.enough:
            table.add_section()
        size = ("–", "–") if variant.why else (str(variant.coordinates), str(variant.modes))
        table.add_row(name, share(variant.worst), *_changes(study, variant), *size)
    return table


def _values(study: InfluenceStudy) -> Iterator[str]:
    for quantity, each in zip(study.quantities, study.whole.changes, strict=True):
        unit, factor = SHOWN[quantity.unit]
        yield (f"{each.value * factor:.4g} {unit}".strip() if isfinite(each.value) else "–") + "*" * bool(each.why)


def _changes(study: InfluenceStudy, variant: Variant) -> Iterator[str]:
    for quantity, each in zip(study.quantities, variant.changes, strict=True):
        yield "–*" if variant.why else _amount(quantity, each) + "*" * bool(each.why)


def _amount(quantity: Interest, each: Change) -> str:
    """Change as text: signed, in percent, of R as it is; a dash without a value."""
    if not isfinite(each.amount):
        return "–"
    if each.share <= DUST:
        return "0"
    return signed(each.amount) if quantity.how == "relative" else f"{each.amount:+.2g}"


def _added(row: EffectRow) -> tuple[str, str, str]:
    if row.without.why:
        return "–", "–", "–"
    return f"{row.coordinates:+d}", f"{row.modes:+d}", _milliseconds(row.cpu, "+")


def _milliseconds(seconds: float, sign: str = "") -> str:
    return f"{1e3 * seconds:{sign}.3g} ms" if isfinite(seconds) else "–"


def share(value: float) -> str:
    """Ratio of a change to its tolerance, as text."""
    if value > MOST:
        return "∞*" if isinf(value) else f"> {MOST:g}"
    return f"{value:.3g}" if value >= LEAST else f"{value:.0e}" if value > DUST else "0"


def uncertain(study: InfluenceStudy, case: Case) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    if study.left_out:
        enough = ceil(1.5 * study.seconds * (1 + study.left_out / study.models))
        yield (
            f"{study.left_out} sweeps of sets of effects did not fit into {study.budget:g} s of CPU time: "
            f"vibeam verdict {quote(str(case.path))} --only effects --budget '{enough} s' makes them."
        )
    elif not study.exact:
        yield "Effects were left out one after another: try a smaller set by [fidelity.NAME] without = […]."
    whole = (each for each in study.whole.changes if each.quantity == "peak" and each.why)
    for why in (each.why.partition("; all effects: ")[0] for each in whole):
        yield f"The peak is that of a point of the sweep ({why}): try more influence.points, or a wider sweep."
    yield from doubts(study.comparison)


def details(study: InfluenceStudy) -> Iterator[str]:
    """Sentence for each effect, the remarks, and how the needed set was found."""
    yield from (_sentence(study, row) for row in study.rows)
    yield from _remarks(study)
    yield from filter(None, [both_peaks(study.comparison, len(study.rows))])
    yield from settled(study.comparison)
    tried = "No smaller set of effects suffices" if study.exact else "One effect after another was left out"
    timed = f"; CPU time of a sweep varied by {_milliseconds(study.scatter)}" * isfinite(study.scatter)
    yield f"{tried}: {study.models} models swept{timed}."


def _sentence(study: InfluenceStudy, row: EffectRow) -> str:
    if row.without.why:
        return f"{row.effect} cannot be taken away from the case as it is ({row.without.why}): needed."
    changed = "; ".join(_modes(study.whole, row.without)) or f"the influence is {share(row.influence)}"
    return f"Without {row.effect} {changed}: {_why(study, row)}."


def _why(study: InfluenceStudy, row: EffectRow) -> str:
    if row.needed and row.influence <= 1:
        return "needed: within tolerance by itself, but not beside the others that are left out"
    if not row.needed and row.influence > 1:
        others = [other.effect for other in study.rows if not other.needed and other is not row]
        return f"not needed, but only where {' and '.join(others)} is left out too: together they cancel"
    return "needed" if row.needed else "not needed"


def _modes(whole: Variant, variant: Variant) -> Iterator[str]:
    """Mode whose frequency changes most, or a changed number of modes."""
    if len(whole.frequencies) != len(variant.frequencies):
        yield f"there are {variant.modes} modes instead of {whole.modes}"
        return
    pairs = list(zip(variant.frequencies, whole.frequencies, strict=True))[:3]
    ours, theirs = max(pairs, key=lambda pair: abs(pair[0] - pair[1]) / (pair[1] or 1.0))
    if abs(ours - theirs) > MOVED * theirs:
        yield f"mode {pairs.index((ours, theirs)) + 1} is at {ours:.4g} Hz instead of {theirs:.4g} Hz"


def _remarks(study: InfluenceStudy) -> Iterator[str]:
    """Explanation of each mark in the tables, once, with the models that have it."""
    labels = {quantity.name: _label(quantity) for quantity in study.quantities}
    models = [(effect, model, each) for effect, model, each in _models(study) if model != "needed"]
    found: dict[str, list[str]] = {}
    for effect, model, variant in models:
        reasons = [
            (labels[each.quantity], each.why.partition("all effects: ")[0].rstrip("; ")) for each in variant.changes
        ]
        notes = [variant.why] if variant.why else [f"{label}: {why}" for label, why in reasons if why]
        name = {"without": f"without {effect}", "alone": f"{effect} alone", "all": "all effects"}.get(model, model)
        for text in notes:
            found.setdefault(text, []).append(name)
    for text, names in found.items():
        yield f"* {text} ({'every model' if len(names) == len(models) else ', '.join(names)})"


def _models(study: InfluenceStudy) -> Iterator[tuple[str, str, Variant]]:
    """Models shown, each with the effect that is taken away or left, and what it is."""
    yield from (("", "all", study.whole), ("", "none", study.bare), ("", "needed", study.enough))
    for row in study.rows:
        yield from ((row.effect, "without", row.without), (row.effect, "alone", row.alone))


def lines(study: InfluenceStudy) -> Iterator[dict[str, Any]]:
    """Rows of every model and quantity; missing values are empty, with their reason."""
    for effect, model, variant in _models(study):
        for quantity, each in zip(study.quantities, variant.changes, strict=True):
            numbers = {"value": each.value, "change": each.amount, "share_of_tolerance": each.share}
            yield {
                "effect": effect, "model": model, "effects": " ".join(variant.kept),
                "coordinates": "" if variant.why else variant.coordinates,
                "modes": "" if variant.why else variant.modes,
                "cpu_seconds": variant.cpu if isfinite(variant.cpu) else "",
                "quantity": quantity.name, "unit": quantity.unit, "how": quantity.how,
                "tolerance": quantity.tolerance,
                **{name: "" if np.isnan(number) else number for name, number in numbers.items()},
                "why": variant.why or each.why,
            }  # fmt: skip


def bars(study: InfluenceStudy, plan: FigurePlan = USUAL) -> Figure:
    """Bar chart: change of each quantity over its tolerance when one effect alone is taken away."""
    count, quantities = len(study.rows), study.quantities
    figure = blank_page((6.4, 1.5 + 0.09 * count * (len(quantities) + 1)), plan)
    axes = figure.subplots()
    thick = 1 / (len(quantities) + 1)
    colours = dict(zip((quantity.name for quantity in quantities), (*COLOURS, "#9A9A9A"), strict=False))
    for index, quantity in enumerate(quantities):
        shares = [MOST if row.without.why else row.without.changes[index].share for row in study.rows]
        places = np.arange(count) + (index - (len(quantities) - 1) / 2) * thick
        tolerance = f"{100 * quantity.tolerance:g} %" if quantity.how == "relative" else f"{quantity.tolerance:g}"
        label = f"{quantity.name.replace('_', ' ')} ({tolerance})"
        for place, row in zip(places, study.rows, strict=True):
            if row.without.why or np.isinf(row.without.changes[index].share):
                axes.text(MOST, place, "∞ ", ha="right", va="center", color="white", fontsize=6)
        lengths = np.clip(shares, LEAST, MOST) - LEAST
        axes.barh(places, lengths, thick, left=LEAST, color=colours[quantity.name], label=label)
    _dress(axes, study)
    titled(figure, plan, study.title, f"what each effect changes, {study.comparison.held.label}")
    legend(figure, axes.get_legend_handles_labels()[0])
    return figure


def _dress(axes: Axes, study: InfluenceStudy) -> None:
    axes.set_xscale("log")
    axes.set_xlim(LEAST, MOST)
    axes.axvline(1.0, color="0.2", linewidth=0.8, linestyle=(0, (4, 2)))
    axes.set_yticks(range(len(study.rows)))
    axes.set_yticklabels([f"{row.effect}\n{'needed' if row.needed else 'not needed'}" for row in study.rows])
    axes.invert_yaxis()
    axes.grid(axis="x", color="0.93", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_xlabel("change when it alone is taken away, over its tolerance (in brackets)")
