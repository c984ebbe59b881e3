"""Influence of each effect as terminal tables and sentences."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite, isinf
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
from vibeam.runs.comparison.differences import both_peaks, headline, notes
from vibeam.system.number_text import signed

if TYPE_CHECKING:
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


def sheet(study: InfluenceStudy, plan: FigurePlan = USUAL) -> StudySheet:
    """Sheet of a study; as CSV a row a model and quantity."""
    said = list(sentences(study))
    return StudySheet(
        headline(study.comparison), [taken_away(study), left_alone(study)], said, rows=list(lines(study)),
        data={"study": study, "sentences": said}, draw=lambda: bars(study, plan), coarse=True,
    )  # fmt: skip


def taken_away(study: InfluenceStudy) -> ReportTable:
    """Table of every effect's contribution, and of the changes when it alone is taken away."""
    names = (f"{SHORT[quantity.name]}|" for quantity in study.quantities)
    head = ("coordinates|", "modes|", "CPU|", *names, "influence|", "")
    table = blank("When one effect is taken away", "without", *head)
    low, high, points = study.frequency
    table.caption = (
        f"{study.fidelity}, {points} frequencies from {low:.5g} to {high:.5g} Hz, {study.settle} + {study.hold} periods"
        f"\ncoordinates, modes, CPU: what the effect adds; CPU of a sweep, which varied by {1e3 * study.scatter:.2g} ms"
        "\ninfluence: the largest change over its tolerance; *: see below"
    )
    whole = (str(study.whole.coordinates), str(study.whole.modes), f"{1e3 * study.whole.cpu:.3g} ms")
    table.add_row("nothing: as it is", *whole, *_values(study), "", "")
    table.add_section()
    for row in study.rows:
        verdict = Text("needed", style="bold") if row.needed else Text("not needed", style="green")
        cells = _changes(study, row.without)
        table.add_row(row.effect, *_added(row), *cells, share(row.influence), verdict)
    return table


def left_alone(study: InfluenceStudy) -> ReportTable:
    """Table of the distance to the complete model with each effect alone, with none, and with the sufficient ones."""
    names = (f"{SHORT[quantity.name]}|" for quantity in study.quantities)
    table = blank("When one effect alone is left", "with", "coordinates|", "modes|", *names, "worst|")
    table.caption = "changes against the model with all effects; worst: the largest of them over its tolerance"
    shown = [("none", study.bare), *((row.effect, row.alone) for row in study.rows)]
    for name, variant in [*shown, ("the needed ones", study.enough)]:
        if variant is study.enough:
            table.add_section()
        size = ("–", "–") if variant.why else (str(variant.coordinates), str(variant.modes))
        table.add_row(name, *size, *_changes(study, variant), share(variant.worst))
    return table


def _values(study: InfluenceStudy) -> list[str]:
    pairs = zip(study.quantities, study.whole.changes, strict=True)
    return [_value(quantity, each) + "*" * bool(each.why) for quantity, each in pairs]


def _value(quantity: Interest, each: Change) -> str:
    unit, factor = SHOWN[quantity.unit]
    return f"{each.value * factor:.4g} {unit}".strip() if isfinite(each.value) else "–"


def _changes(study: InfluenceStudy, variant: Variant) -> list[str]:
    if variant.why:
        return ["–*"] * len(study.quantities)
    pairs = zip(study.quantities, variant.changes, strict=True)
    return [_amount(quantity, each) + "*" * bool(each.why) for quantity, each in pairs]


def _amount(quantity: Interest, each: Change) -> str:
    """Change as text: signed, in percent or in its unit; a dash without a value."""
    if not isfinite(each.amount):
        return "–"
    if quantity.how == "relative":
        return signed(each.amount)
    return "0" if each.amount == 0 else f"{each.amount:+.2g} {SHOWN[quantity.unit][0]}".strip()


def _added(row: EffectRow) -> tuple[str, str, str]:
    if row.without.why:
        return "–", "–", "–"
    return f"{row.coordinates:+d}", f"{row.modes:+d}", f"{1e3 * row.cpu:+.3g} ms"


def share(value: float) -> str:
    """Ratio of a change to its tolerance, as text."""
    return "∞" if isinf(value) else f"{value:.3g}" if value >= 1e-3 or value == 0 else f"{value:.0e}"


def sentences(study: InfluenceStudy) -> Iterator[str]:
    """Sentence for each effect, the remarks, and the effects the scene needs."""
    yield from (_sentence(study, row) for row in study.rows)
    yield from _remarks(study)
    yield from filter(None, [both_peaks(study.comparison, len(study.rows))])
    yield from notes(study.comparison)
    yield verdict(study)


def _sentence(study: InfluenceStudy, row: EffectRow) -> str:
    if row.without.why:
        return f"{row.effect} cannot be taken away from the case as it is ({row.without.why}): needed."
    notes = [*_modes(study.whole, row.without), *_moved(study, row.without)]
    none = f"nothing moves by more than {share(row.influence)} of its tolerance" if row.influence else "nothing changes"
    return f"Without {row.effect} {'; '.join(notes) or none}: {_why(study, row)}."


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
    ours, theirs = max(pairs, key=lambda pair: abs(pair[0] / pair[1] - 1))
    if abs(ours / theirs - 1) > MOVED:
        yield f"mode {pairs.index((ours, theirs)) + 1} is at {ours:.4g} Hz instead of {theirs:.4g} Hz"


def _moved(study: InfluenceStudy, variant: Variant) -> Iterator[str]:
    """Changes beyond tolerance, each with the frequency of the peak or the ringing."""
    for quantity, each in zip(study.quantities, variant.changes, strict=True):
        if isinf(each.share):
            yield f"{quantity.label.replace('its', _of(quantity))} is not there to compare ({each.why})"
        elif each.share >= 1e-3:
            size = _amount(quantity, each).lstrip("+-")
            yield f"{quantity.label.replace('its', _of(quantity))} moves by {size}"


def _of(quantity: Interest) -> str:
    return "the peak's" if quantity.name.startswith("peak") else "the ringing's"


def _remarks(study: InfluenceStudy) -> Iterator[str]:
    """Explanation of each mark in the tables, once, with the models that have it."""
    labels = {quantity.name: quantity.label.replace("its", _of(quantity)) for quantity in study.quantities}
    models = [("all effects", study.whole), ("none", study.bare)]
    models += [(f"without {row.effect}", row.without) for row in study.rows]
    models += [(f"{row.effect} alone", row.alone) for row in study.rows]
    found: dict[str, list[str]] = {}
    for name, variant in models:
        notes = [variant.why] if variant.why else []
        for each in variant.changes if not variant.why else ():
            why = each.why.partition("all effects: ")[0].rstrip("; ")
            notes += [f"{labels[each.quantity]}: {why}"] if why else []
        for text in notes:
            found.setdefault(text, []).append(name)
    for text, names in found.items():
        yield f"* {text} ({'every model' if len(names) == len(models) else ', '.join(names)})"


def verdict(study: InfluenceStudy) -> str:
    """Sentence on the effects that the scene needs, and how that was determined."""
    needed = [row.effect for row in study.rows if row.needed]
    others = [row.effect for row in study.rows if not row.needed]
    needs = _listed(needed) if needed else "none of its effects"
    text = f"The scene needs {needs}" + (f", not {_listed(others, 'or')}" if others else "")
    kept = f"every quantity then stays within {share(study.enough.worst)} of its tolerance" if others else (
        "leaving out any set of them moves some quantity beyond its tolerance" if study.exact
        else "leaving out any one of them moves some quantity beyond its tolerance"
    )  # fmt: skip
    how = (
        f"all sets up to that size were tried, {study.models} models swept"
        if study.exact
        else f"found by leaving out one after another, {study.models} models swept: a smaller set may exist"
    )
    return f"{text}: {kept} ({how})."


def _listed(names: list[str], last: str = "and") -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}"


def lines(study: InfluenceStudy) -> Iterator[dict[str, Any]]:
    """Rows of every model and quantity; missing values are empty, with their reason."""
    yield from _lines(study, "", "all", study.whole)
    yield from _lines(study, "", "none", study.bare)
    yield from _lines(study, "", "needed", study.enough)
    for row in study.rows:
        yield from _lines(study, row.effect, "without", row.without)
        yield from _lines(study, row.effect, "alone", row.alone)


def _lines(study: InfluenceStudy, effect: str, model: str, variant: Variant) -> Iterator[dict[str, Any]]:
    for quantity, each in zip(study.quantities, variant.changes, strict=True):
        numbers = {"value": each.value, "change": each.amount, "share_of_tolerance": each.share}
        yield {
            "effect": effect, "model": model, "effects": " ".join(variant.kept),
            "coordinates": "" if variant.why else variant.coordinates, "modes": "" if variant.why else variant.modes,
            "cpu_seconds": variant.cpu if isfinite(variant.cpu) else "",
            "quantity": quantity.name, "unit": quantity.unit, "how": quantity.how, "tolerance": quantity.tolerance,
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
        shares = [_drawn(row.without, index) for row in study.rows]
        places = np.arange(count) + (index - (len(quantities) - 1) / 2) * thick
        label = f"{quantity.name.replace('_', ' ')} ({_tolerance(quantity.how, quantity.tolerance, quantity.unit)})"
        for place, row in zip(places, study.rows, strict=True):
            if row.without.why or np.isinf(row.without.changes[index].share):
                axes.text(MOST, place, "∞ ", ha="right", va="center", color="white", fontsize=6)
        axes.barh(places, shares, thick, left=LEAST, color=colours[quantity.name], label=label)
    _dress(axes, study)
    titled(figure, plan, study.title, f"what each effect changes, {study.comparison.held.label}")
    legend(figure, axes.get_legend_handles_labels()[0])
    return figure


def _drawn(variant: Variant, index: int) -> float:
    """Length of the bar from ``LEAST``."""
    value = MOST if variant.why else variant.changes[index].share
    return float(np.clip(value, LEAST, MOST)) - LEAST


def _tolerance(how: str, tolerance: float, unit: str) -> str:
    return f"{100 * tolerance:g} %" if how == "relative" else f"{tolerance:g} {unit if unit != '1' else ''}".strip()


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
