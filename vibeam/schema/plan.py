"""The tables of what is run and what it is checked against: sweep, fidelities, references, expected numbers."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from vibeam import units
from vibeam.entries.lists import Several
from vibeam.entries.range import POSITIVE
from vibeam.entries.single import Count, Quantity, Text, Word
from vibeam.entries.tables import Options, TableOr
from vibeam.schema.table import Table, key
from vibeam.schema.words import (
    DIRECTIONS,
    EXTENTS,
    MOST_ELEMENTS,
    MOST_POINTS,
    OUTPUTS,
    QUANTITIES,
    REDUCTIONS,
    Frequency,
    Periods,
    Ratio,
)
from vibeam.settings import Names, Settings, Value
from vibeam.show import LIMITS, READ
from vibeam.solvers import NAMES as SOLVERS


class GridTable(Table):
    """Evenly spaced drive frequencies."""

    from_: Annotated[float, Frequency] = Field(alias="from", description="first frequency", examples=["14 Hz"])
    to: Annotated[float, Frequency] = key("last frequency, itself included", "17 Hz")
    points: Annotated[int, Count(1, MOST_POINTS)] = key("how many", 121)


FrequencyGrid = TableOr(GridTable, Several(Frequency, limit=MOST_POINTS, ascending=True))


class SweepTable(Table):
    """The sweep that every fidelity runs: drive frequencies and, at each, periods to settle and to hold."""

    frequency: Annotated[GridTable | tuple[float, ...], FrequencyGrid] = key(
        "drive frequencies: from, to and points, or an ascending list of Hz",
        {"from": "14 Hz", "to": "17 Hz", "points": 121},
    )
    direction: Annotated[str, Word(DIRECTIONS)] = key("which way the frequencies are run", "both", "both")
    settle: Annotated[int, Periods] = key("drive periods left out before the reading", 300)
    hold: Annotated[int, Count(1, MOST_POINTS)] = key("drive periods read", 50)
    output: Annotated[str, Word(OUTPUTS)] = key("whose displacement is read", "sensor", "sensor")


class FidelityTable(Table):
    """A fidelity, one table each: which model of the rig is swept."""

    reduction: Annotated[str, Word(REDUCTIONS)] = key(
        "one mode, the static deflection; or the first few modes; or all of the finite elements", "static_mode"
    )
    modes: Annotated[int | None, Count(1, 2 * MOST_ELEMENTS)] = key("how many modes, for modal alone", 8, None)
    solver: Annotated[str, Word(SOLVERS)] = key("how its motion is found", "flight", "flight")
    options: Annotated[dict[str, str | float], Options()] = key(
        "of the solver, by name; absent = its own defaults", {"rtol": 1e-9}, {}, written=False
    )
    set: Annotated[dict[str, Any], Settings()] = key(
        "physics that is this fidelity's own: dotted keys and their values",
        {"stop.restitution": 0.6},
        {},
        written=False,
    )
    without: Annotated[tuple[str, ...], Names("dotted keys")] = key(
        "optional keys, or whole optional tables, of the physics that it leaves out",
        ["mass.rotary_inertia"],
        (),
        written=False,
    )
    label: Annotated[str | None, Text()] = key(
        "its name in figures; absent = the name of its table", "8 modes", None, written=False
    )


class ReferenceTable(Table):
    """A curve that a fidelity is checked against, one table each."""

    file: Annotated[str, Text()] = key("CSV file, from the case file's folder", "references/dtu_neutral_sdof.csv")
    fidelity: Annotated[str, Text()] = key("the fidelity that must meet it", "sdof")
    quantity: Annotated[str, Word(QUANTITIES)] = key("the column compared", "amplitude")
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key("largest relative difference", "0.0001 %")
    direction: Annotated[str | None, Word(DIRECTIONS)] = key(
        "the branches compared; absent = all that are swept", "both", None, written=False
    )


class ExpectTable(Table):
    """A number that a fidelity is checked against, by itself or against another fidelity, one table each."""

    fidelity: Annotated[str, Text()] = key("the fidelity that must meet it", "sdof")
    quantity: Annotated[str, Word(QUANTITIES + EXTENTS + LIMITS + READ)] = key(
        "what is compared; of those after largest_gap: that of a figure, with show", "amplitude"
    )
    frequency: Annotated[float | None, Frequency] = key(
        "where, one of the sweep's (of a limit or a figure anywhere); none for the peak, the range of period 1, modes",
        "15.3 Hz",
        None,
    )
    show: Annotated[str | None, Text()] = key(
        "the [show.NAME] that the quantity is read off, its mean unless number chooses one",
        "ringing",
        None,
        written=False,
    )
    number: Annotated[float | None, Ratio] = key(
        "number of the mode, or order of the harmonic, that is read off the figure of show", 2, None, written=False
    )
    against: Annotated[str | None, Text()] = key(
        "another fidelity: the value is then the relative difference to it", "beam", None
    )
    value: Annotated[float, Value()] = key("the number expected, in SI units (frequencies in Hz)", "34 %")
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "largest difference: relative to the value, or, with against or where the value is 0, of the number itself",
        "1 %",
    )
    direction: Annotated[str | None, Word(DIRECTIONS)] = key(
        "the branches compared; absent = all that are swept", "up", None
    )
