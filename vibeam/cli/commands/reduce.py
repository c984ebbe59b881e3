"""``vibeam reduce``: what a reduction loses with n coordinates, and the n that is enough."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, number, table_path
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_sheet

if TYPE_CHECKING:
    pass


def reduce(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    within: Annotated[str, typer.Option("--within", help="Accuracy by which n is recommended.")] = "5 %",
    low: Annotated[str, typer.Option("--from", help="Lower end of the band, with unit.")] = "0 Hz",
    high: Annotated[
        str | None,
        typer.Option("--to", help="Its upper end; absent = ten times the highest drive frequency.", show_default=False),
    ] = None,
    contact_time: Annotated[
        str | None,
        typer.Option(
            "--contact-time", help="How long an impact lasts; absent = that of a linear stop.", show_default=False
        ),
    ] = None,
    basis: Annotated[
        list[str] | None, typer.Option("--basis", help="This basis alone. Repeatable.", show_default=False)
    ] = None,
    most: Annotated[int, typer.Option("--most", min=1, help="Largest number of coordinates.")] = 12,
) -> None:
    """Tabulate what a reduction loses with n coordinates.

    The n that is enough is recommended by the response over the sweep, flown where it is not known in closed form.
    """
    from vibeam.casefile import quantities as units
    from vibeam.report.reduce import sheet
    from vibeam.studies.reduce.study import WIDER
    from vibeam.studies.reduce.study import reduce as reduced

    loaded = load(case, set_)
    path = table_path(loaded, out, "reduce")
    share, begin = number("--within", within, units.RATIO), number("--from", low, units.FREQUENCY)
    end = None if high is None else number("--to", high, units.FREQUENCY)
    time = None if contact_time is None else number("--contact-time", contact_time, units.TIME)
    band = None if end is None and begin == 0 else (begin, end or WIDER * float(loaded.sweep.frequency.max()))
    study = of_case(case, lambda: reduced(loaded, within=share, band=band, contact_time=time, bases=basis, most=most))
    found = sheet(study)
    print_sheet(found, as_json, found.write(path, loaded.figure))
