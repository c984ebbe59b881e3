"""``vibeam stability``: the maps, their boundaries, and their crossings with the case's own frequency line."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, table_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_result


def stability(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    over: Annotated[str, typer.Option("--over", help="What changes beside the frequency: gap or drive.")] = "gap",
    low: Annotated[str | None, typer.Option("--from", help="Its first value, with unit.", show_default=False)] = None,
    high: Annotated[str | None, typer.Option("--to", help="Its last value, with unit.", show_default=False)] = None,
    points: Annotated[int, typer.Option("--points", min=2, help="How many values of it.")] = 101,
    frequencies: Annotated[int, typer.Option("--frequencies", min=2, help="How many drive frequencies.")] = 161,
    periods: Annotated[int, typer.Option("--periods", min=1, help="Drive periods from impact to impact.")] = 1,
    fidelity: Annotated[
        str | None, typer.Option("--fidelity", help="This one alone; absent = all.", show_default=False)
    ] = None,
) -> None:
    """Map where periodic motions exist and are stable.

    The axes are frequency and gap or drive.
    """
    from vibeam.figures.files import paths_of
    from vibeam.figures.units import units_of
    from vibeam.report import output
    from vibeam.report.stability import write_stability
    from vibeam.studies.stability.study import stability as mapped

    loaded = load(case, set_)
    path = table_path(loaded, out, "stability")
    found = of_case(case, lambda: mapped(loaded, over, low, high, points, frequencies, periods, fidelity))
    figures = paths_of(path, loaded.figure)
    write_stability(found, *figures)
    output.write_csv(found.points, path)
    files = [path, *figures]
    units = units_of(loaded, speed=max((each.velocity for each in found.crossings), default=0.0))
    notes = found.notes
    print_result(
        {"crossings": found.crossings, "maps": found.shares, "remarks": notes, "files": files}, as_json,
        lambda tables: [tables.crossings(found.crossings, found.axis.text(found.maps[0].own), units)], [*notes, *files],
    )  # fmt: skip
