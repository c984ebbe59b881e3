"""``vibeam stability``: the maps, their boundaries, and their crossings with the case's own frequency line."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, table_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_sheet


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
    from vibeam.report.stability import sheet
    from vibeam.studies.stability.study import stability as mapped

    loaded = load(case, set_)
    path = table_path(loaded, out, "stability")
    found = sheet(of_case(case, lambda: mapped(loaded, over, low, high, points, frequencies, periods, fidelity)))
    print_sheet(found, as_json, found.write(path, loaded.figure))
