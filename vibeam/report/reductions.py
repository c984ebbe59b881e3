"""Tables and figure of what reductions lose, and of the limit of infinitely many modes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, floor, isfinite, log10, nan
from typing import TYPE_CHECKING, Any

from vibeam.exchange.files import dotted
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank, coefficient
from vibeam.studies.modes_needed.losses import Losses
from vibeam.studies.modes_needed.reduction import Recommendation, ReductionStudy
from vibeam.system.number_text import percent, shown_in

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vibeam.studies.modes_needed.limit import LimitRow

PARTS = {
    "response": "amplitude over the sweep", "loss": "largest loss", "impact": "impact at the contact",
    "contact": "drive → contact", "sensor": "drive → sensor", "frequency": "natural frequencies",
    "static_stiffness": "static stiffness at the contact", "restitution": "1 − R₁",
}  # fmt: skip
LARGEST = 10.0  # loss up to which the figure goes
ROOM = 1.4  # beyond the first and the last decade
ROUND_OFF = 1e-9  # below which a loss is not drawn: static stiffness is known to about 10⁻¹⁰
DUST = 1e-6  # share below which a cell shows 0


def share(value: float) -> str:
    """Size of a share as percent."""
    return "0 %" if abs(value) < DUST else percent(abs(value))


def shown(value: float, unit: str) -> str:
    """A value of an SI unit to four digits, with the prefix that suits it; a dash for NaN."""
    name, factor = shown_in(unit, value)
    return f"{value * factor:.4g} {name.removeprefix('1')}".rstrip() if isfinite(value) else "–"


def short(value: float) -> str:
    """Size of a share as percent, to two digits; a dash for NaN."""
    if not DUST <= abs(value) <= LARGEST:
        return share(value)
    return f"{100 * abs(value):.2g} %" if abs(value) < 0.995 else f"{100 * abs(value):.0f} %"


def off(row: Losses, accuracy: float) -> str:
    """Largest error of the amplitude in a cell."""
    if row.response.strays(accuracy):
        return "other"
    return f"> {short(min(abs(row.response.worst), LARGEST))}" if row.response.given_up else short(row.response.worst)


def enough(study: ReductionStudy, each: Recommendation) -> str:
    """Number of coordinates that is enough in a basis; above which it lies where that is not known."""
    most = max(row.modes for row in study.of(each.basis) if isfinite(row.loss))
    return "–" if study.claim.refused else str(each.modes or f"> {most}")


COLUMNS: dict[str, Callable[[Losses], str]] = {
    "off|": lambda row: share(row.response.worst),
    "at|": lambda row: shown(row.response.mu, "Hz"),
    "rms|": lambda row: share(row.response.rms),
    "same motion|": lambda row: f"{row.response.points} of {row.response.total}",
    "loss|": lambda row: share(row.loss),
    "decided by": lambda row: PARTS[row.decided_by],
    "frequency|": lambda row: share(row.frequency),
    "MAC|": lambda row: f"{row.mac:.5f}",
    "stiffness|": lambda row: share(max(row.static_stiffness, 0.0)),
    "mobility|": lambda row: share(row.mobility),
    "1 − R₁|": lambda row: share(row.restitution),
    "R₁|": lambda row: coefficient(row.first_mode_restitution),
    "R|": lambda row: coefficient(row.contact_restitution),
    "contact|": lambda row: share(row.contact),
    "sensor|": lambda row: share(row.sensor),
    "impact|": lambda row: share(row.impact),
}


def sheet(study: ReductionStudy) -> StudySheet:
    """Sheet of a reduction study; as CSV a row for each basis and number of coordinates."""
    found = ", ".join(f"{each.basis} {enough(study, each)}" for each in study.recommended if not each.why)
    names = ("claim", "within", "band", "in_band", "contact_time", "size", "rows", "recommended", "notes")
    return StudySheet(
        f"Coordinates for {percent(study.within)} of the amplitude of all {study.claim.modes} modes: {found}.",
        losses(study),
        study.notes,
        data={name: getattr(study, name) for name in names},
        rows=[dict(dotted(plain(row))) for row in study.rows],
        draw=lambda: reduction_figure(study),
    )


def losses(study: ReductionStudy) -> list[ReportTable]:
    """Largest loss by basis and number of coordinates; all that is lost with the number that is enough."""
    counts = sorted({row.modes for row in study.rows})
    largest = blank("Largest loss with n coordinates", "basis", *(f"{n}|" for n in counts))
    parts = blank(f"Losses with the n for {percent(study.within)}, else the largest n", "basis", "n|", "by losses|")
    parts.add(*COLUMNS)
    for each in study.recommended:
        if not each.why:
            rows = study.of(each.basis)
            row = each.losses or [row for row in rows if isfinite(row.loss)][-1]
            largest.add_row(each.basis, *(short(row.loss) for row in rows))
            cells = (cell(row) for cell in COLUMNS.values())
            parts.add_row(each.basis, enough(study, each), str(each.by_losses or f"> {row.modes}"), *cells)
    parts.caption = (
        "off, rms: of the amplitude, worst and over all; same motion: of those known of all modes, how many it makes; "
        "by losses: the n from which on all losses are within, which claims nothing of the response; frequency: worst "
        "in the band; stiffness: static, at the contact; mobility: share lost; 1 − R₁: change of what mode 1 loses at "
        "an impact; R₁, R: restitution of mode 1 and of the contact; contact, sensor: transfer functions from the "
        "drive; impact: displacement in contact"
    )
    return [largest, parts]


def limits(rows: Sequence[LimitRow]) -> ReportTable:
    """Table of every quantity over the numbers of modes, its limit and the rate at which it gets there."""
    table = blank("Limit of infinitely many modes", "held", "quantity", *(f"N = {n}|" for n in rows[0].counts), heads=2)
    table.add("limit|", "±|", "rate|", "1 % from|", "by t_c|", "at|", "why none")
    for row in rows:
        values = (shown(value, row.unit) for value in (*row.values, row.limit))
        known = share(row.uncertainty / abs(row.limit)) if row.limit else "–"
        rate, counts = f"{row.rate:.1f}" if isfinite(row.rate) else "–", (row.enough, row.by_contact_time)
        at = shown(row.frequency, "Hz") if isfinite(row.frequency) else shown(row.speed, "m/s")
        table.add_row(row.held, row.quantity, *values, known, rate, *(str(each or "–") for each in counts), at, row.why)
    table.caption = (
        "of the exact motion with one impact a period at a frequency, or of a collision of mode 1 at a speed; rate p: "
        "what is left falls like N⁻ᵖ; 1 % from: fewest modes that are within 1 % of the limit from there on; by t_c: "
        "modes with less than one period in the contact time"
    )
    return table


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
    known, seen = any(r.response.total for r in study.rows), any(r.restitution > ROUND_OFF for r in study.rows)
    without = {"loss" if known else "response", "static_stiffness" if seen else "restitution"}
    return {part: name for part, name in PARTS.items() if part not in without}


def _value(row: Losses, part: str) -> float:
    if part == "response":
        return nan if row.response.given_up else abs(row.response.worst)
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
