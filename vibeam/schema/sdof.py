"""The tables of a single degree of freedom by itself."""

from __future__ import annotations

from typing import Annotated, Any

from vibeam import units
from vibeam.entries.lists import Several
from vibeam.entries.range import NOT_NEGATIVE, POSITIVE
from vibeam.entries.single import Quantity, Text, Word
from vibeam.entries.tables import Options
from vibeam.schema.plan import SweepTable
from vibeam.schema.table import Table, key
from vibeam.schema.words import (
    LAWS,
    Frequency,
    Ratio,
    Unity,
)
from vibeam.settings import Names, Settings
from vibeam.solvers import NAMES as SOLVERS


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency: Annotated[float, Quantity(units.ANGULAR_FREQUENCY, POSITIVE)] = key(
        "of free motion, with its unit; 1 rad/s = nondimensional time", "1 rad/s", 1.0
    )
    damping_ratio: Annotated[float, Ratio] = key("β, of critical", 0.015)


class SdofStopTable(Table):
    """The stop of the single degree of freedom."""

    gap: Annotated[float, Quantity(units.RATIO)] = key("gap at rest Δ, in the unit of the motion", 0.0)
    restitution: Annotated[float | None, Unity] = key("speed after over speed before an impact", 0.9, None)
    law: Annotated[str | None, Word(LAWS)] = key(
        "effect: what the stop does; absent = restitution, the same at every velocity", "linear", None, written=False
    )
    stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of a linear stop: force over mass and penetration", 400, None, written=False
    )
    damping: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "of a linear stop, force over mass and velocity; absent = what gives the restitution", 2.5, None, written=False
    )
    hertz_stiffness: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of hertz and hunt-crossley, force over mass and penetration^exponent", 1e4, None, written=False
    )
    exponent: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "of the penetration, absent = 1.5; of the velocity in R = R0 (v/v0)^-n, absent = 0.25", 1.5, None, written=False
    )
    velocity: Annotated[float | None, Quantity(units.RATIO, POSITIVE)] = key(
        "at which the restitution holds, for hunt-crossley and velocity restitution", 0.01, None, written=False
    )
    speeds: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO, POSITIVE), ascending=True)] = key(
        "of a table of restitutions, instead of restitution and velocity", [0.002, 0.02], None, written=False
    )
    restitutions: Annotated[tuple[float, ...] | None, Several(Unity)] = key(
        "at the speeds", [0.8, 0.6], None, written=False
    )
    second_gap: Annotated[float | None, Quantity(units.RATIO)] = key(
        "effect: gap to a second stop on the other side; absent = none", 0.01, None, written=False
    )
    drift_frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "effect: drive frequencies between which the gap drifts; absent = it stays",
        ["1.5 rad/s", "2.5 rad/s"],
        None,
        written=False,
    )
    drift: Annotated[tuple[float, ...] | None, Several(Quantity(units.RATIO))] = key(
        "what is added to the gap at these frequencies, linear between them", [0.0, 1e-4], None, written=False
    )
    wear: Annotated[float | None, Quantity(units.RATIO, NOT_NEGATIVE)] = key(
        "effect: what each impact adds to the gap, from point to point; absent = none", 1e-8, None, written=False
    )


class SdofDriveTable(Table):
    """The base motion of the single degree of freedom."""

    amplitude: Annotated[float, Ratio] = key("of the base B, in the unit of the motion", 0.5e-3)


class SdofSweepTable(SweepTable):
    """The sweep of the single degree of freedom."""

    output: Annotated[str, Word(("sensor", "contact"))] = key("both are the one motion", "sensor", "sensor")


class SdofFidelityTable(Table):
    """A fidelity of the single degree of freedom, which is one mode already; the table may be empty."""

    reduction: Annotated[str, Word(("static_mode",))] = key("one mode", "static_mode", "static_mode")
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
