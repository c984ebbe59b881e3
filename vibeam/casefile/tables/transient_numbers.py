"""Numbers of a record case that [expect.NAME] and [measured.NAME] compare: their signals, dimensions and rules."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from vibeam.case.transient_quantities import QUANTITIES
from vibeam.casefile import quantities as units
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.quantities import Dimension
from vibeam.casefile.tables.outputs import quantity_named
from vibeam.casefile.tables.table import NAME
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message
from vibeam_models.laws import CONSTANT, LAWS

FORCE = "contact_force"
RATES = ("", "_velocity", "_acceleration")  # what a displacement's signals are called
ENERGY = Dimension("an energy", "J", "0.01 J", ("mJ", "J"))
MOTION = (units.LENGTH, units.SPEED, units.ACCELERATION)
OF_SWEEP = ("frequency", "direction")  # keys of a number off a sweep
OF_RECORD = ("output", "at", "seed")  # … off a record


def signals(case: Any) -> dict[str, Dimension]:
    """Dimensions of the signals of a record case by name."""
    found: dict[str, Dimension] = {}
    for name in (case.record and case.record.outputs) or ():
        quantity = quantity_named(case, name)
        if quantity.name == "displacement":
            found |= {f"{name}{rate}": kind for rate, kind in zip(RATES, MOTION, strict=True)}
        else:
            found[name] = units.dimension(quantity.unit.replace(" s-1", "/s").replace(" s-2", "/s^2").replace("1", ""))
    if LAWS[case.stop.law or CONSTANT].load().compliant or getattr(case, "further_stop", None):
        found[FORCE] = units.FORCE
    return found


def transient_dimension(case: Any, reading: Any) -> Dimension:
    """Dimension of a number of a record case."""
    if getattr(reading, "against", None) is not None and reading.quantity != "horizon":
        return units.RATIO
    declared = QUANTITIES.get(reading.quantity)
    unit = "1" if declared is None else declared.unit
    plain, known = KINDS[case.kind].plain, signals(case)
    if unit in ("q", "c/s", "E") and plain:
        return units.RATIO
    if unit == "q":
        return known.get(reading.output or next(iter(known), ""), units.LENGTH)
    others = {"c/s": units.SPEED, "E": ENERGY, "s": units.TIME, "s-1": units.dimension("1/s"), "1": units.RATIO}
    return others[unit]


def transient_checks(case: SimpleNamespace, path: KeyPath, reading: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about a number of a record case."""
    declared, known = QUANTITIES.get(reading.quantity), signals(case)
    if reading.quantity is not None and declared is None:
        said = f'"{reading.quantity}" is of a [sweep]; of a [record]: {", ".join(QUANTITIES)}'
        yield (*path, "quantity"), said
    for name in OF_SWEEP:
        if getattr(reading, name) is not None:
            yield (*path, name), "is of a [sweep]: take it out"
    if reading.output is not None and reading.output not in known:
        there = ", ".join(filter(NAME.fullmatch, known))
        yield (*path, "output"), f"no signal {as_shown_in_message(reading.output)}: there are {there}"
    if declared is None:
        return
    if declared.of != "signal" and reading.output is not None:
        yield (*path, "output"), f'"{reading.quantity}" is of the whole motion: take it out'
    if declared.of != "energy" and reading.number is not None:
        yield (*path, "number"), "is that of a mode, of an energy: take it out"
    if declared.of == "pair" and reading.against is None:
        yield (*path, "against"), f'missing: "{reading.quantity}" is of two fidelities; name the other'
    if reading.seed is not None and reading.seed not in _seeds(case):
        yield (*path, "seed"), "is not among the realisations: drive.seed is the first, record.realisations how many"


def _seeds(case: SimpleNamespace) -> range:
    first = case.drive.seed
    return range(0) if first is None else range(first, first + (case.record.realisations or 1))


def swept_number_checks(path: KeyPath, reading: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about keys and quantities of a record in a case that sweeps."""
    for name in OF_RECORD:
        if getattr(reading, name) is not None:
            yield (*path, name), "is of a [record]: take it out"
