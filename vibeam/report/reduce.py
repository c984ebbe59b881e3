"""Tables, CSV, JSON and figure of what reductions lose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, floor, isfinite, log10, nan
from typing import TYPE_CHECKING, Any

from rich.text import Text

from vibeam.figures.units import units_of
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank, coefficient
from vibeam.studies.reduce.losses import Losses
from vibeam.studies.reduce.study import ReductionStudy
from vibeam.system.number_text import percent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DECIDED = {
    "frequency": "frequency",
    "static_stiffness": "static stiffness",
    "restitution": "restitution",
    "contact": "drive → contact",
    "sensor": "drive → sensor",
    "impact": "impact",
}

PANELS = {
    "response": "amplitude over the sweep",
    "loss": "largest loss",
    "impact": "impact at the contact",
    "contact": "drive → contact",
    "sensor": "drive → sensor",
    "frequency": "natural frequencies",
    "static_stiffness": "static stiffness at the contact",
}

LARGEST = 10.0  # loss up to which the figure goes
ROOM = 1.4  # beyond the first and the last decade
ROUND_OFF = 1e-9  # below which a loss is not drawn: static stiffness is known to about 10⁻¹⁰


def sheet(study: ReductionStudy) -> StudySheet:
    """Sheet of a study: claim, tables, sentences, losses as CSV, their figure."""
    return StudySheet(
        claim(study), reduction_tables(study), sentences(study), data=as_data(study), rows=rows(study),
        draw=lambda: reduction_figure(study),
    )  # fmt: skip


def reduction_tables(study: ReductionStudy) -> list[ReportTable]:
    """Errors of the response and losses by basis and n, and the recommended n with all that it loses."""
    known = any(row.response.known for row in study.rows)
    off = _by_number(study, "Largest error of the amplitude with n coordinates", _off, "modes")
    off.caption = f"bold: from the recommended n on, within {percent(study.within)}; >: flown up to there; –: not known"
    losses = _by_number(study, "Largest loss with n coordinates", _loss, "by_losses")
    losses.caption = f"bold: from the n on from which it stays within {percent(study.within)}; –: no such reduction"
    return [*([off] if known else []), losses, _recommended(study)]


def _by_number(study: ReductionStudy, title: str, cell: Callable[[Losses], str], least: str) -> ReportTable:
    """Cells of all bases over n, bold from the ``least`` n of a recommendation on."""
    counts = sorted({row.modes for row in study.rows})
    table = blank(title, "basis", *(f"{n}|" for n in counts))
    for each in study.recommended:
        if each.why:
            continue
        rows, first = {row.modes: row for row in study.of(each.basis)}, getattr(each, least)
        cells = [(cell(rows[n]), first is not None and n >= first) for n in counts]
        table.add_row(each.basis, *(Text(text, "bold" if bold and text != "–" else "") for text, bold in cells))
    return table


def _loss(row: Losses) -> str:
    return short(row.loss) if isfinite(row.loss) else "–"


def _off(row: Losses) -> str:
    if row.response.given_up:
        return f"> {short(min(row.response.worst, LARGEST))}" if isfinite(row.response.worst) else "other"
    return short(row.response.worst) if isfinite(row.response.worst) else "–"


def short(share: float) -> str:
    """A share as percent, to two digits."""
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def _recommended(study: ReductionStudy) -> ReportTable:
    names = ("basis", "n|", "off|", "at|", "rms|", "same motion|", "by losses|", "loss|", "decided by")
    table = blank(f"Recommended for {percent(study.within)}", *names)
    table.add("frequency|", "MAC|", "stiffness|", "mobility|", "1 − R₁|", "R₁|", "R|", "contact|", "sensor|", "impact|")
    frequencies = units_of(study.case).frequencies
    for each in study.recommended:
        if each.why:
            continue
        rows = [row for row in study.of(each.basis) if isfinite(row.loss)]
        above = f"> {rows[-1].modes}"
        number = "–" if study.claim.refused else above if each.modes is None else str(each.modes)
        response = (each.losses or rows[-1]).response
        off = (percent(response.worst), frequencies(response.mu), percent(response.rms)) if response.known else ()
        table.add_row(
            each.basis, number, *(off or ("", "", "")), f"{response.alike} of {response.known}" if off else "",
            above if each.by_losses is None else str(each.by_losses), *(_cells(each.losses) if each.losses else ()),
        )  # fmt: skip
    table.caption = (
        "off, rms: of the amplitude, worst and over all; same motion: of those known of all modes, how many it makes;\n"
        "by losses: the n from which on all losses are within, which claims nothing of the response; frequency: worst\n"
        "in the band; stiffness: static, at the contact; mobility: share lost; 1 − R₁: change of what mode 1 loses at\n"
        "an impact; R₁, R: restitution of mode 1 and of the contact; contact, sensor: transfer functions from the\n"
        "drive; impact: displacement in contact"
    )
    return table


def _cells(row: Losses) -> list[str]:
    return [
        short(row.loss),
        DECIDED[row.decided_by],
        percent(row.frequency),
        f"{row.mac:.5f}",
        percent(max(row.static_stiffness, 0.0)),
        percent(row.mobility),
        percent(row.restitution),
        coefficient(row.first_mode_restitution),
        coefficient(row.contact_restitution),
        percent(row.contact),
        percent(row.sensor),
        percent(row.impact),
    ]


def claim(study: ReductionStudy) -> str:
    """Claim of the recommendation and the points it is over, or why there is none."""
    said, whole = study.claim, f"all {study.claim.modes} modes"
    if said.refused:
        return f"No number of coordinates is recommended for {whole}: {said.refused}."
    parts = []
    if said.closed:
        parts.append(f"{said.closed} of {said.frequencies} frequencies in closed form, {said.struck} with impacts")
    if said.flown:
        why = f": {said.why_flown}" if said.why_flown else ""
        why = ", for models whose damping couples their modes" if said.closed == said.frequencies else why
        parts.append(f"{said.repeating} of the {said.flown} points of the sweep that were flown{why}")
    limit = f"within {percent(study.within)} of that of {whole} at each point where both make the same motion"
    return f"n is recommended by the amplitude, {limit}; known at {'; and at '.join(parts)}."


def sentences(study: ReductionStudy) -> list[str]:
    """Sentences: the question about the losses, and the limits of the answers."""
    units = units_of(study.case)
    low, high = (units.frequencies(end) for end in study.band)
    time = "not known: an impulse stands for it" if not isfinite(study.contact_time) else f"{study.contact_time:.4g} s"
    head = f"{study.size} coordinates; band {low} … {high}, with {study.in_band} of its modes; contact time {time}"
    about = {each.basis: each.frequency for each in study.recommended if each.frequency is not None and not each.why}
    return [head, *(f'{name}: about frequency = "{hertz:.6g} Hz"' for name, hertz in about.items()), *study.notes]


def as_data(study: ReductionStudy) -> dict[str, Any]:
    """Content for JSON: rows, recommendations, and for each basis the analysis in the names of pyMOR."""
    bases = dict.fromkeys(basis for basis, _, _ in study.curves)
    return {
        "claim": study.claim,
        "within": study.within,
        "band": study.band,
        "contact_time": study.contact_time,
        "rows": study.rows,
        "recommended": study.recommended,
        "analysis": {
            basis: {place: _analysis(study, basis, place) for place in ("contact", "sensor")} for basis in bases
        },
        "notes": study.notes,
    }


def _analysis(study: ReductionStudy, basis: str, place: str) -> dict[str, Any]:
    found = {n: each for (name, n, where), each in study.curves.items() if (name, where) == (basis, place)}
    names = ("max_error", "max_error_mu", "max_estimate", "max_estimate_mu")
    columns = {f"{name}s": [getattr(each, name) for each in found.values()] for name in names}
    arrays = {
        name: [getattr(each, name) for each in found.values()] for name in ("errors", "estimates", "effectivities")
    }
    return {"basis_sizes": [*found], "mus": next(iter(found.values())).mus, **columns, **arrays}


def rows(study: ReductionStudy) -> list[dict[str, Any]]:
    """Rows of the CSV file: the losses, the response's error in columns of its own."""
    found = [plain(row) for row in study.rows]
    return [row | {f"response_{name}": each for name, each in row.pop("response").items()} for row in found]


def reduction_figure(study: ReductionStudy) -> Figure:
    """Loss against n, one panel a kind, one line a basis."""
    from matplotlib.lines import Line2D

    from vibeam.figures.page import blank_page, legend, titled

    figure = blank_page((7.6, 5.0), study.case.figure)
    grid = figure.subplots(2, 3, sharex=True)
    bases = [each.basis for each in study.recommended if not each.why]
    looks = _looks(bases)
    for axes, (part, name) in zip(grid.flat, _panels(study).items(), strict=True):
        _panel(axes, study, part, looks)
        axes.set_title(name)
    for axes in grid[1]:
        axes.set_xlabel("coordinates n")
    for axes in grid[:, 0]:
        axes.set_ylabel("loss")
    handles = [Line2D([], [], label=basis, markersize=3.2, linewidth=1.0, **looks[basis]) for basis in bases]
    handles.append(Line2D([], [], color="0.5", linewidth=0.8, linestyle=":", label=f"within {percent(study.within)}"))
    legend(figure, handles)
    titled(figure, study.case.figure, study.case.title, "what a reduction loses, against its number of coordinates")
    return figure


def _panels(study: ReductionStudy) -> dict[str, str]:
    """Panels: the response where known; where R is held at the contact, what mode 1 sees in place of statics."""
    panels = dict(PANELS)
    panels.pop("loss" if any(row.response.known for row in study.rows) else "response")
    if any(row.restitution > ROUND_OFF for row in study.rows):
        panels.pop("static_stiffness")
        panels["restitution"] = "1 − R₁"
    return panels


def _value(row: Losses, part: str) -> float:
    if part == "response":
        return nan if row.response.given_up else row.response.worst
    return abs(float(getattr(row, part)))


def _looks(bases: Sequence[str]) -> dict[str, dict[str, Any]]:
    from vibeam.figures.style import COLOURS

    marks = "osD^vX*Ph<>"
    return {
        name: {
            "color": COLOURS[number % len(COLOURS)],
            "marker": marks[number % len(marks)],
            "linestyle": "-" if number < len(COLOURS) else "--",
        }
        for number, name in enumerate(bases)
    }


def _panel(axes: Any, study: ReductionStudy, part: str, looks: dict[str, dict[str, Any]]) -> None:
    from matplotlib.ticker import MaxNLocator

    drawn: list[float] = []
    for basis, look in looks.items():
        values = [(row.modes, _value(row, part)) for row in study.of(basis)]
        shown = [value if isfinite(value) and value > ROUND_OFF else nan for _, value in values]
        drawn += [value for value in shown if isfinite(value)]
        axes.plot([n for n, _ in values], shown, markersize=3.2, linewidth=1.0, gid=f"{part}-{basis}", **look)
    if drawn:
        axes.set_yscale("log")
        axes.set_ylim(10 ** floor(log10(min(drawn))) / ROOM, ROOM * min(10 ** ceil(log10(max(drawn))), LARGEST))
    axes.axhline(study.within, color="0.5", linewidth=0.8, linestyle=":", zorder=1)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlim(0.5, max(row.modes for row in study.rows) + 0.5)
