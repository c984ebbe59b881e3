"""``vibeam limit``: what becomes of a rig with more and more modes, and what has no limit."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, load, number, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_sheet

if TYPE_CHECKING:
    from vibeam_models.laws import ContactLaw

LEAST = 8  # modes


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
    from vibeam.casefile.quantities import dimension
    from vibeam.figures.units import units_of
    from vibeam.report.limit import sheet
    from vibeam.studies.limit.study import limit as limits

    loaded = load(case, set_)
    path = None if out is None else table_path(loaded, out, "limit")
    at = None if frequency is None else number("--frequency", frequency, dimension("Hz"), positive=True)
    struck, laws = number("--speed", speed, dimension("m/s"), positive=True), list(_elastic(linear, hertz))
    found = sheet(of_case(case, lambda: limits(loaded, _counts(modes), at, struck, laws)), units_of(loaded, speed=0.05))
    print_sheet(found, as_json, [] if path is None else found.write(path, loaded.figure))


def _counts(modes: int) -> tuple[int, ...]:
    """Numbers of modes 1, 2, 4 … up to ``modes``."""
    if modes < LEAST or modes & (modes - 1):
        raise UsageError(f"--modes: {modes} must be a power of two from {LEAST} on")
    return tuple(2**k for k in range(modes.bit_length()))


def _elastic(linear: str | None, hertz: float | None) -> Iterator[ContactLaw]:
    """Elastic stops of these stiffnesses."""
    from vibeam.casefile.quantities import dimension
    from vibeam_models.laws.yielding import Elastic, Linear

    if linear is not None:
        yield Linear(number("--linear", linear, dimension("N/m"), positive=True), damping=0.0)
    if hertz is not None:
        if not (isfinite(hertz) and hertz > 0):
            raise UsageError(f"--hertz: {hertz:g} must be above 0")
        yield Elastic(hertz)
