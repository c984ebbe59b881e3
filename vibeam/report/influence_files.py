"""What ``vibeam influence`` leaves on disk: a line of CSV for every model and quantity, and a bar plot."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.plans import FigurePlan
from vibeam.report.output import write_rows
from vibeam.report.page import blank_page, legend, paths_of, titled, write_page
from vibeam.report.style import COLOURS

if TYPE_CHECKING:
    from vibeam.influence.study import Study, Variant

USUAL = FigurePlan()
LEAST, MOST = 1e-3, 1e3  # changes beyond are drawn at the ends


def write_files(study: Study, table: Path, plan: FigurePlan = USUAL) -> list[Path]:
    """Write the table, and the plot beside it as ``plan`` says; gives the plots' and the table's paths."""
    figures = paths_of(table, plan)
    write_page(lambda: bars(study, plan), figures, dots=160)
    write_rows(list(lines(study)), table)
    return [*figures, table]


def lines(study: Study) -> Iterator[dict[str, Any]]:
    """A line for every model and quantity; what is not there is empty, with its reason."""
    yield from _lines(study, "", "all", study.whole)
    yield from _lines(study, "", "none", study.bare)
    yield from _lines(study, "", "needed", study.enough)
    for row in study.rows:
        yield from _lines(study, row.effect, "without", row.without)
        yield from _lines(study, row.effect, "alone", row.alone)


def _lines(study: Study, effect: str, model: str, variant: Variant) -> Iterator[dict[str, Any]]:
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


def bars(study: Study, plan: FigurePlan = USUAL) -> Figure:
    """For each effect a bar a quantity: its change over its tolerance when that effect alone is taken away."""
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
    titled(figure, plan, study.title, "what each effect changes")
    legend(figure, *axes.get_legend_handles_labels())
    return figure


def _drawn(variant: Variant, index: int) -> float:
    """The bar's length from ``LEAST``."""
    value = MOST if variant.why else variant.changes[index].share
    return float(np.clip(value, LEAST, MOST)) - LEAST


def _tolerance(how: str, tolerance: float, unit: str) -> str:
    return f"{100 * tolerance:g} %" if how == "relative" else f"{tolerance:g} {unit if unit != '1' else ''}".strip()


def _dress(axes: Axes, study: Study) -> None:
    axes.set_xscale("log")
    axes.set_xlim(LEAST, MOST)
    axes.axvline(1.0, color="0.2", linewidth=0.8, linestyle=(0, (4, 2)))
    axes.set_yticks(range(len(study.rows)))
    axes.set_yticklabels([f"{row.effect}\n{'needed' if row.needed else 'not needed'}" for row in study.rows])
    axes.invert_yaxis()
    axes.grid(axis="x", color="0.93", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_xlabel("change when it alone is taken away, over its tolerance (in brackets)")
