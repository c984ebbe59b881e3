"""Tables, CSV, JSON and figure of what reductions lose."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil, floor, isfinite, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.text import Text

from vibeam.figures.units import percent, units_of
from vibeam.report.output import write_csv
from vibeam.report.table_widths import ReportTable
from vibeam.report.tables import blank, coefficient
from vibeam.studies.reduce.losses import Losses
from vibeam.studies.reduce.study import Recommendation, ReductionStudy

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


def reduction_tables(study: ReductionStudy) -> list[ReportTable]:
    """Losses by basis and n, and the recommended n with all that it loses."""
    return [_overview(study), _recommended(study)]


def _overview(study: ReductionStudy) -> ReportTable:
    counts = sorted({row.modes for row in study.rows})
    table = blank("Largest loss with n coordinates", "basis", *(f"{n}|" for n in counts))
    for each in study.recommended:
        if each.why:
            continue
        losses = {row.modes: row for row in study.of(each.basis)}
        table.add_row(each.basis, *(_loss(losses[n], each) for n in counts))
    table.caption = f"bold: from the recommended n on, within {percent(study.within)}; –: no such reduction"
    return table


def _loss(row: Losses, each: Recommendation) -> Text:
    if not isfinite(row.loss):
        return Text("–", style="dim")
    return Text(short(row.loss), style="bold" if each.modes is not None and row.modes >= each.modes else "")


def short(share: float) -> str:
    """A share as percent, to two digits."""
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def _recommended(study: ReductionStudy) -> ReportTable:
    names = (
        "basis",
        "n|",
        "loss|",
        "decided by",
        "frequency|",
        "MAC|",
        "stiffness|",
        "mobility|",
        "1 − R₁|",
    )
    table = blank(f"Recommended for {percent(study.within)}", *names)
    table.add("R₁|", "R|", "contact|", "sensor|", "impact|")
    for each in study.recommended:
        if each.why:
            continue
        if each.losses is None:
            table.add_row(each.basis, f"> {max(row.modes for row in study.of(each.basis) if isfinite(row.loss))}")
            continue
        table.add_row(each.basis, str(each.modes), *_cells(each.losses))
    table.caption = (
        "frequency: worst in the band; stiffness: static, at the contact; mobility: share lost; 1 − R₁: change of\n"
        "what mode 1 loses at an impact; R₁, R: restitution of mode 1 and of the contact; contact, sensor: transfer\n"
        "functions from the drive; impact: displacement in contact"
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


def sentences(study: ReductionStudy) -> list[str]:
    """What was asked, and the limits of the answers."""
    units = units_of(study.case)
    low, high = (units.frequencies(end) for end in study.band)
    time = "not known: an impulse stands for it" if not isfinite(study.contact_time) else f"{study.contact_time:.4g} s"
    head = f"{study.size} coordinates; band {low} … {high}, with {study.in_band} of its modes; contact time {time}"
    return [head, *study.notes]


def as_data(study: ReductionStudy) -> dict[str, Any]:
    """Content for JSON: rows, recommendations, and for each basis the analysis in the names of pyMOR."""
    bases = dict.fromkeys(basis for basis, _, _ in study.curves)
    return {
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


def write_rows(study: ReductionStudy, path: Path) -> None:
    """Write the losses as CSV."""
    write_csv(study.rows, path)


def write_reduction(study: ReductionStudy, paths: Iterable[Path]) -> None:
    """Draw and write the figure; the format follows each path's ending."""
    from vibeam.figures.page import write_page

    write_page(lambda: reduction_figure(study), paths)


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
    legend(figure, handles, [str(handle.get_label()) for handle in handles])
    titled(figure, study.case.figure, study.case.title, "what a reduction loses, against its number of coordinates")
    return figure


def _panels(study: ReductionStudy) -> dict[str, str]:
    """Kinds of loss that are drawn; where R is held at the contact, what mode 1 sees of it in place of statics."""
    if not any(row.restitution > ROUND_OFF for row in study.rows):
        return PANELS
    return {part: name for part, name in PANELS.items() if part != "static_stiffness"} | {"restitution": "1 − R₁"}


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
        values = [(row.modes, abs(getattr(row, part))) for row in study.of(basis)]
        shown = [(n, value) for n, value in values if isfinite(value) and value > ROUND_OFF]
        drawn += [value for _, value in shown]
        across, upward = [n for n, _ in shown], [value for _, value in shown]
        axes.plot(across, upward, markersize=3.2, linewidth=1.0, gid=f"{part}-{basis}", **look)
    if drawn:
        axes.set_yscale("log")
        axes.set_ylim(10 ** floor(log10(min(drawn))) / ROOM, ROOM * min(10 ** ceil(log10(max(drawn))), LARGEST))
    axes.axhline(study.within, color="0.5", linewidth=0.8, linestyle=":", zorder=1)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlim(0.5, max(row.modes for row in study.rows) + 0.5)
