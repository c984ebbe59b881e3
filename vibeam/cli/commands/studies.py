"""Studies: ``vibeam cost``, ``influence``, ``uncertainty``, ``reduce``, ``limit``; ``study`` for registered ones."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.cli.arguments import AsJson, CaseFile, Overrides, TableFile, folder, load, number, run_study, table_path
from vibeam.cli.errors import UsageError, of_case
from vibeam.cli.output import print_result, print_sheet, write_table

if TYPE_CHECKING:
    from vibeam_models.laws import ContactLaw


def cost(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FOLDER", help="The folder for plot and table, made if new; absent = the current one.",
            show_default=False,
        ),
    ] = None,
) -> None:  # fmt: skip
    """Measure accuracy against time.

    Every fidelity by every solver, and the sources of the error.
    """
    from vibeam.report.cost import sheet
    from vibeam.studies.cost.study import cost as costs

    loaded = load(case, set_)
    place = folder(out or Path())
    found = sheet(run_study(case, loaded, costs), loaded)
    print_sheet(found, as_json, found.write(place / f"{case.stem}_cost.csv", loaded.figure))


def influence(case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Measure what each effect changes, costs and is needed for."""
    from vibeam.report.influence import sheet
    from vibeam.studies.influence.study import influence as influences

    loaded = load(case, set_)
    path = table_path(loaded, out, "influence")
    found = sheet(run_study(case, loaded, influences), loaded.figure)
    print_sheet(found, as_json, found.write(path, loaded.figure))


def uncertainty(
    case: CaseFile,
    set_: Overrides = None,
    as_json: AsJson = False,
    out: TableFile = None,
    samples: Annotated[int, typer.Option("--samples", min=16, help="A power of two: of runs an input.")] = 128,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the samples.")] = 0,
) -> None:
    """Carry what [uncertain] says through the sweep: bands, sensitivity, errors side by side."""
    from vibeam.report.uncertainty import sheet
    from vibeam.studies.uncertainty.study import uncertainty as study_of

    loaded = load(case, set_)
    path = table_path(loaded, out, "uncertainty")
    found = sheet(run_study(case, loaded, lambda own, tell: study_of(own, tell, samples=samples, seed=seed)))
    print_sheet(found, as_json, found.write(path, loaded.figure))


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


Name = Annotated[str, typer.Argument(metavar="NAME", help="The study's name.", show_default=False)]


def study(name: Name, case: CaseFile, set_: Overrides = None, as_json: AsJson = False, out: TableFile = None) -> None:
    """Run a registered study of a case (see --load)."""
    from vibeam.exchange.faults import suggest
    from vibeam.studies.declaration import STUDIES

    registered = [each for each, declared in STUDIES.items() if not declared.own_command]
    if name not in registered:
        known = suggest(name, registered) if registered else "none is registered: write vibeam --load MODULE study …"
        raise UsageError(f"vibeam {name} is a command of its own" if name in STUDIES else f"no study {name!r}; {known}")
    declared, loaded = STUDIES[name], load(case, set_)
    rows = list(of_case(case, lambda: declared.of(loaded)))
    write_table(rows, None if out is None else table_path(loaded, out, name))
    print_result(rows, as_json, lambda tables: [tables.rows_of(declared.meaning, rows)])
