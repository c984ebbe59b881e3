"""``vibeam limit``: what becomes of a rig with more and more modes, and what has no limit."""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, table_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_sheet


def limit(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    modes: Annotated[int, typer.Option("--modes", help="The largest number of modes: a power of two from 8 on.")] = 64,
    frequency: Annotated[
        str | None, typer.Option("--frequency", help="Of the drive; absent = the sweep's middle.", show_default=False)
    ] = None,
    speed: Annotated[str, typer.Option("--speed", help="Of the contact in a collision.")] = "50 mm/s",
    linear: Annotated[
        str | None, typer.Option("--linear", help="A linear elastic stop too, of this stiffness.", show_default=False)
    ] = None,
    hertz: Annotated[
        float | None, typer.Option("--hertz", help="A Hertz stop too, in N/m^1.5.", show_default=False)
    ] = None,
) -> None:
    """Tabulate a rig over the number of modes, with each restitution held and with stops that yield.

    The limit and the rate are observed; where there is no limit it says why.
    """
    from vibeam.figures.units import units_of
    from vibeam.report.limit import sheet
    from vibeam.studies.limit.study import LimitRow, counts, laws_of, quantity
    from vibeam.studies.limit.study import limit as limits

    loaded = load(case, set_)
    path = None if out is None else table_path(loaded, out, "limit")

    def made() -> list[LimitRow]:
        at = None if frequency is None else quantity("--frequency", frequency, "Hz")
        return limits(loaded, counts(modes), at, quantity("--speed", speed, "m/s"), laws_of(linear, hertz))

    found = sheet(of_case(case, made), units_of(loaded, speed=0.05))
    print_sheet(found, as_json, [] if path is None else found.write(path, loaded.figure))
