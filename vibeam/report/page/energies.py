"""Energies of a record case: where what the load put in went, as bars of each fidelity."""

from __future__ import annotations

from html import escape

import numpy as np

from vibeam.figures.record import kept_place, unit_of_signal
from vibeam.figures.style import name_of
from vibeam.figures.units import with_unit
from vibeam.report.page.parts import Picture, as_csv
from vibeam.runs.transient.result import TransientResult

WIDTH, LEFT, BAR, ROW = 960, 190, 22, 34  # px of the drawing, of its labels, of a bar, from one to the next
#: field of a transient, the words for it, its colour on the page
SHARES = (("left", "at the end", "steel"), ("damping", "lost by damping", "mass"), ("lost", "lost to the stop", "stop"))


def mean_energies(result: TransientResult, name: str) -> dict[str, float]:
    """Mean energies, J, by field, over the seeds at the value of the factor whose histories are kept."""
    place, own = kept_place(result), result[name]
    complete = own.complete[place]
    found = {field: np.nansum(getattr(own, field)[place][complete], axis=-1) for field, _, _ in SHARES}
    return {field: float(np.mean(each)) for field, each in found.items()} if complete.any() else {}


def energy_bars(result: TransientResult) -> Picture | None:
    """Bars of each fidelity: the shares of what was there at the begin and what the load put in; None without any."""
    totals = {name: known for name in result if (known := mean_energies(result, name))}
    given = {name: sum(max(each, 0.0) for each in known.values()) for name, known in totals.items()}
    if not any(given.values()):
        return None
    unit, factor = unit_of_signal(result.case, "J", max(given.values()))
    rows, parts, scale = [], [], (WIDTH - LEFT - 130) / max(given.values())
    for number, (name, each) in enumerate(totals.items()):
        top, x, label = 8 + ROW * number, float(LEFT), name_of(result.case, name)
        parts.append(_text(LEFT - 8, top + 15, label[:26], "end"))
        for field, words, colour in SHARES:
            value = f"{each[field] * factor:.4g} {unit}"
            parts.append(_box(x, top, scale * max(each[field], 0.0), BAR, colour, f"{label}, {words}: {value}"))
            x += scale * max(each[field], 0.0)
            rows.append((label, words, each[field] * factor))
        parts.append(_text(x + 6, top + 15, f"{given[name] * factor:.4g} {unit}"))
    low = 8 + ROW * len(totals)
    for number, (_, words, colour) in enumerate(SHARES):
        x = LEFT + 190.0 * number
        parts += [_box(x, low, 12, 12, colour, words), _text(x + 18, low + 11, words)]
    said = f"Energies, means over the motions of each fidelity: {', '.join(words for _, words, _ in SHARES)}"
    drawn = f'<svg class="scene" viewBox="0 0 {WIDTH} {low + 22}" role="img" aria-label="{said}">{"".join(parts)}</svg>'
    numbers = as_csv(("fidelity", "part", with_unit("energy", unit)), rows)
    return Picture("Energies of each fidelity", f"{said}.", drawn, numbers)


def _text(x: float, y: float, text: str, kind: str = "small") -> str:
    return f'<text class="{kind}" x="{x:.1f}" y="{y}">{escape(text)}</text>'


def _box(x: float, y: float, width: float, height: float, colour: str, title: str) -> str:
    place = f'x="{x:.1f}" y="{y}" width="{width:.1f}" height="{height}"'
    return f'<rect {place} style="fill: var(--{colour})"><title>{escape(title)}</title></rect>'
