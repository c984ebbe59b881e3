"""``vibeam verdict``: the fidelity map, its table, and the verdict in plain words."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Fresh, Overrides, TableFile, load, run_study, table_path
from vibeam.cli.output import print_sheet

Over = Annotated[str, typer.Option("--over", help="frequency and gap, drive, restitution or any dotted key.")]


def verdict(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    over: Over = "frequency,gap",
    low: Annotated[str | None, typer.Option("--from", help="First value, with unit.", show_default=False)] = None,
    high: Annotated[str | None, typer.Option("--to", help="Last value, with unit.", show_default=False)] = None,
    points: Annotated[int, typer.Option("--points", min=2, help="How many values of it.")] = 61,
    frequencies: Annotated[int, typer.Option("--frequencies", min=2, help="How many drive frequencies.")] = 61,
    accuracy: Annotated[str, typer.Option("--accuracy", help="How near the finest model.")] = "1 %",
    quantity: Annotated[str, typer.Option("--quantity", help="Of what: amplitude or reach.")] = "amplitude",
    verify: Annotated[int, typer.Option("--verify", min=0, help="At how many places to fly anew.")] = 24,
    fidelity: Annotated[
        list[str] | None, typer.Option("--fidelity", help="This one; repeatable; absent = all.", show_default=False)
    ] = None,
    fresh: Fresh = False,
) -> None:
    """Map the cheapest model that suffices, and where models differ in kind; or continue such a map.

    The axes are frequency and another key of the case. Kinds: period, coexisting motions, chaos.
    """
    from vibeam.report.verdict import sheet
    from vibeam.studies.verdict.planes import kept_beside
    from vibeam.studies.verdict.study import verdict as judge

    loaded = load(case, set_)
    path = table_path(loaded, out, "verdict")
    asked = over, low, high, points, frequencies, accuracy, quantity, fidelity, verify
    with kept_beside(path, fresh) as folder:
        found = sheet(run_study(case, loaded, lambda own, tell: judge(own, *asked, tell, folder)))
        files = found.write(path, loaded.figure)
    print_sheet(found, as_json, files)
