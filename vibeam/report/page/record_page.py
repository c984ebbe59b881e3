"""Page of a record case: history with zoom, impact velocities, energies, spectra, what the factor does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import ShowPlan
from vibeam.exchange.faults import CaseError
from vibeam.figures.kinds import impact_velocities
from vibeam.figures.page import blank_page
from vibeam.figures.record import drawn_motion, kept_place, unit_of_signal
from vibeam.figures.style import name_of
from vibeam.figures.units import with_unit
from vibeam.report.page.parts import Picture, as_csv, as_json, picture, rendered
from vibeam.report.page.record_charts import record_data
from vibeam.report.page.standing import PAGE_BYTES, standing
from vibeam.report.record_figure import record_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.report.output import StudySheet
    from vibeam.runs.stored_result import StoredResult
    from vibeam.runs.systems import Overview
    from vibeam.runs.transient.result import TransientResult

STILL = 110  # columns of a panel of the still picture
VIEWS = ("base64", "numbers", "chart", "envelope", "record", "zoom", "timeline", "families")


def record_page(stored: StoredResult, sections: Mapping[str, StudySheet]) -> str:
    """The page as HTML, ``sections`` of extensions in it; CaseError where a model of the case cannot be built."""
    from vibeam.report.transient import transient_report

    result: Any = stored.result
    history = picture("history", "Histories of all fidelities over time", lambda: record_figure(result, STILL))
    velocities = _velocities(result)
    data = record_data(result)
    text = as_json(data)
    room = PAGE_BYTES - len(text) - len(history.data) - len(velocities.data)
    modes = max((each.modes for each in result.values()), default=0)
    return rendered(
        "record.html",
        ("state", "saving", *VIEWS, "start"),
        **standing(result, modes, _overview(result), stored.provenance, stored.left_out, room),
        missing=stored.missing,
        verdict=transient_report(result),
        response=history,
        velocities=velocities,
        drawn_motion=drawn_motion(result),
        bins=_bins(data["histories"]),
        energies=energy_bars(result),
        factor=result.over if len(result.factors) > 1 else "",
        data=text,
        sections=list(sections.items()),
    )


def _overview(result: TransientResult) -> Overview | None:
    """Rig and load in a sentence; None where a file of the load is not there any more."""
    from vibeam.runs.transient.motions import MotionMaker
    from vibeam.runs.transient.overview import overview_of_record

    try:
        return overview_of_record({name: MotionMaker(result.case, name) for name in result}, result.total)
    except CaseError:
        return None


def _velocities(result: TransientResult) -> Picture:
    plan = ShowPlan(name="velocities", kind="impact_velocities", key="", fidelities=tuple(result))

    def make() -> Figure:
        made = blank_page(impact_velocities.size, result.case.figure)
        impact_velocities.draw(made, result, plan, ())
        return made

    return picture("impact velocities", "Impacts a second that are harder than a velocity", make)


def _bins(histories: Sequence[Mapping[str, Any]]) -> str:
    """Width of the bins of the histories on the page, of the first output, around the marks too."""
    first = next((each["signal"] for each in histories if each["signal"] != "input"), "")
    own = [float(each["width"]) for each in histories if each["signal"] == first]
    if not own:
        return "each bin"
    close = f", around the marks of {1e3 * min(own):.3g} ms" if min(own) < 0.9 * max(own) else ""
    return f"each bin of {1e3 * max(own):.3g} ms{close}"


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
