"""Picture, sheet and tables of maps: the page with title and legend, classes of motion, coexisting motions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from vibeam.figures.page import blank_page, legend, titled, write_page
from vibeam.figures.units import DisplayUnits, units_of
from vibeam.maps.axes import name_of_key
from vibeam.maps.motions import motions_of
from vibeam.maps.result import MapResult, MapRow, rows_of
from vibeam.report.maps.labels import quantity_label
from vibeam.report.output import StudySheet
from vibeam.report.tables import blank
from vibeam.runs.comparison.differences import listed
from vibeam.system.number_text import percent
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.maps.motions import CoexistingMotion
    from vibeam.report.tables import ReportTable

CAPTIONS = {
    "period": "period of the motion",
    "bifurcation": "bifurcation diagram: output at the end of each drive period",
    "basins": "coexisting motions",
    "spectra": "spectra along one axis",
}

HOMES = {
    "period": ("plane", "period"),
    "values": ("plane", "values"),
    "bifurcation": ("bifurcation", "bifurcation"),
    "basins": ("basins", "basins"),
    "spectra": ("spectra", "spectra"),
    "stability": ("stability", "stability"),
    "verdict": ("verdict", "verdict"),
}


def study_of(result: MapResult) -> Any:
    """A finished map as its picture takes it: itself where motions are shown, else the study of them."""
    if result.plan.picture == "verdict":
        from vibeam.studies.fidelity_map.study import fidelity_map_of

        return fidelity_map_of(result)
    if result.plan.picture == "stability":
        from vibeam.studies.stability import stability_of

        return stability_of(result)
    return result


def write_map(found: Any, *paths: Path, exact: bool = True) -> list[str]:
    """Draw a map to ``paths``, by their endings; ``exact``: with what is known in closed form. Returns notes on it.

    ``found``: as of ``study_of``.
    """
    notes: list[str] = []
    write_page(lambda: _figure(found, exact and found.plan.boundaries, notes), paths)
    return notes


def map_figure(found: Any, exact: bool = True) -> Figure:
    """The figure of a map, which is as of ``study_of``; ``exact``: with closed forms, which may take seconds."""
    return _figure(found, exact and found.plan.boundaries, [])


def _figure(found: Any, exact: bool, notes: list[str]) -> Figure:
    home, name = HOMES[found.plan.picture]
    module = loaded(f"vibeam.report.maps.{home}")
    figure = blank_page(module.size_of(found), found.case.figure)
    handles, said = getattr(module, name)(figure, found, exact)
    notes += said
    caption = "\n".join([_caption(found, module), *(said if found.plan.picture == "spectra" else ())])
    titled(figure, found.case.figure, found.case.title, caption)
    legend(figure, handles)
    return figure


def _caption(found: Any, module: Any) -> str:
    if not isinstance(found, MapResult):
        return str(module.caption(found))
    shows = CAPTIONS.get(found.plan.picture) or quantity_label(found, found.plan.quantity)
    return f"{shows}: {found.done} of {found.points} points" if found.done < found.points else shows


def sheet_of(found: Sequence[Any], notes: Mapping[str, Sequence[str]]) -> StudySheet:
    """Sheet of one map or several, each as of ``study_of``; ``notes`` on their pictures by name."""
    swept = [each for each in found if isinstance(each, MapResult)]
    own = [(each, loaded(f"vibeam.report.maps.{HOMES[each.plan.picture][0]}").sheet(each))
           for each in found if not isinstance(each, MapResult)]  # fmt: skip
    rows = {each.plan.name: rows_of(each) for each in swept}
    motions = {each.plan.name: motions_of(each) for each in swept if each.plan.picture == "basins"}
    told = [_named(f"{name}: ", each) for name, said in notes.items() for each in said]
    answers = [_answer(each, rows[each.plan.name], motions.get(each.plan.name)) for each in swept]
    data = [{"rows": rows[each.plan.name], "motions": motions.get(each.plan.name, []),
             "remarks": notes.get(each.plan.name, ())} | _head(each) for each in swept]  # fmt: skip
    return StudySheet(
        "\n".join([*answers, *(sheet.answer for _, sheet in own)]),
        [*_tables(swept, rows, motions), *_all("tables", own)],
        [*dict.fromkeys(told), *_all("notes", own)],
        _all("details", own),
        _all("more", own),
        data={"maps": [*data, *(_head(each) | sheet.data for each, sheet in own)]},
    )


def rows_of_csv(found: Any) -> Sequence[Any]:
    """Rows of a map's own CSV file: places of a fidelity map, points of boundaries of a stability map."""
    return () if isinstance(found, MapResult) else found.points


def _all(part: str, own: Iterable[tuple[Any, StudySheet]]) -> list[Any]:
    return [each for _, sheet in own for each in getattr(sheet, part)]


def _head(found: Any) -> dict[str, Any]:
    return {"map": found.plan.name, "picture": found.plan.picture}


def _named(name: str, said: str) -> str:
    return f"{name}{said}"


def _tables(
    swept: Sequence[MapResult], rows: Mapping[str, Sequence[MapRow]], motions: Mapping[str, list[CoexistingMotion]]
) -> list[ReportTable]:
    if not swept:
        return []
    every = [each for found in motions.values() for each in found]
    units = units_of(swept[0].case, length=max((each.amplitude for each in every), default=0.0))
    first = shares([row for each in rows.values() for row in each])
    return [first, *([coexisting(every, units)] if every else [])]


CLASSES = {
    "period_1": "repeat every drive period", "period_2": "every second one", "period_more": "after up to 16",
    "not_periodic": "do not repeat", "no_impact": "have no impact", "failed": "failed",
}  # fmt: skip


def _answer(found: MapResult, rows: Sequence[MapRow], motions: Sequence[CoexistingMotion] | None) -> str:
    """Shares of the classes of motion of all points, or how many motions coexist."""
    over = listed([name_of_key(found.case, axis.key) for axis in found.plan.axes])
    head, rest = f"{found.plan.name}: of {found.points} motions over {over}", "all else is as in the case"
    if motions:
        commonest = motions[0]
        kinds = f"{len(motions)} kinds, the commonest {commonest.name}, {percent(commonest.share)} of the starts"
        return f"{head} there are {kinds}; {rest}."
    total = sum(row.points for row in rows)
    shares = {name: sum(getattr(row, name) * row.points for row in rows) / total for name in CLASSES}
    said = [f"{percent(share)} {CLASSES[name]}" for name, share in shares.items() if share > 0]
    return f"{head} {listed(said)}; {rest}."


def shares(rows: Sequence[MapRow]) -> ReportTable:
    """Table of the shares of each class of motion."""
    table = blank("Maps", "map", "fidelity", "direction", "at", "points|")
    table.add("no impact|", "period 1|", "period 2|", "period 3 … 16|", "not periodic|", "failed|")
    for row in rows:
        found = (row.no_impact, row.period_1, row.period_2, row.period_more, row.not_periodic, row.failed)
        table.add_row(row.map, row.fidelity, row.direction, row.at, str(row.points), *map(percent, found))
    return table


def coexisting(found: Sequence[CoexistingMotion], units: DisplayUnits) -> ReportTable:
    """Table of the motions that starts lead to, the commonest of each fidelity first."""
    unit = f" ({units.length})" if units.length else ""
    table = blank(
        "Coexisting motions", "fidelity", "motion", "period|", "impacts|", f"amplitude{unit}|", "starts|", "share|"
    )
    for each in found:
        size = f"{each.amplitude * units.length_factor:.4g}"
        period = {0: "none", -1: "–"}.get(each.period, str(each.period))
        table.add_row(each.fidelity, each.name, period, str(each.impacts), size, str(each.starts), percent(each.share))
    return table
