"""Tables of the studies of cost, influence and fit; rules between their keys."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.casefile import quantities as units
from vibeam.casefile.field_tables import settings
from vibeam.casefile.fields import POSITIVE, TEXT, Count, Each, Quantity, Several, Word
from vibeam.casefile.tables.table import (
    MOST_ELEMENTS,
    MOST_POINTS,
    OF_INFLUENCE,
    Frequency,
    Periods,
    Table,
    key,
    named_fidelity,
    not_there,
)
from vibeam.exchange.faults import Complaint, as_shown_in_message
from vibeam.solvers import SOLVERS


def study_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the studies that a case asks for."""
    yield from _cost(case)
    if getattr(case, "influence", None) is not None:
        yield from named_fidelity(case, ("influence", "fidelity"), case.influence.fidelity)
    yield from _accuracy(case)


def _cost(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.cost is None:
        return
    name, path = case.cost.reference, ("cost", "reference")
    if name is None:
        return
    if name not in case.reference:
        yield path, f"no reference {not_there(name, case.reference)}"
    elif case.reference[name].quantity not in ("amplitude", None):
        yield (
            path,
            f"{as_shown_in_message(name)} gives {case.reference[name].quantity}: accuracy is that of the amplitude",
        )


def _accuracy(case: SimpleNamespace) -> Iterator[Complaint]:
    if case.accuracy is None and case.accuracy_of is not None:
        yield ("accuracy_of",), 'goes with an accuracy: write accuracy = "1 %" beside it'


class CostTable(Table):
    """Plan of vibeam cost; absent = the defaults."""

    frequency: Annotated[tuple[float, ...] | None, Several(Frequency, limit=MOST_POINTS, ascending=True)] = key(
        "drive frequencies; absent = nine of the sweep's", ["14 Hz", "15 Hz", "16 Hz"], None, written=False
    )
    settle: Annotated[int | None, Periods] = key(
        "drive periods left out; absent = the sweep's, 100 at most", 100, None, written=False
    )
    hold: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods read; absent = the sweep's, 10 at most", 10, None, written=False
    )
    solvers: Annotated[tuple[str, ...] | None, Each(Word(SOLVERS))] = key(
        "those compared; absent = all", ["flight", "orbit", "direct"], None, written=False
    )
    modes: Annotated[tuple[int, ...] | None, Each(Count(1, 2 * MOST_ELEMENTS))] = key(
        "the finest fidelity cut off after so many modes, each; absent = 1, 2, 4, 8 … below its own",
        [1, 2, 4, 8],
        None,
        written=False,
    )
    reference: Annotated[str | None, TEXT] = key(
        "the [reference.NAME] whose amplitudes are the truth; absent = the finest fidelity",
        "exact",
        None,
        written=False,
    )
    repeats: Annotated[int, Count(1, 1000)] = key("how often a run is timed, where that is short", 3, 3)
    budget: Annotated[float, Quantity(units.TIME, POSITIVE)] = key("CPU time of the runs compared", "60 s", 60.0)


class InfluenceTable(Table):
    """Plan of vibeam influence; absent = the defaults."""

    fidelity: Annotated[str | None, TEXT] = key(
        "whose effects are taken away; absent = the one with most modes", "beam", None, written=False
    )
    quantities: Annotated[tuple[str, ...], Each(Word(OF_INFLUENCE))] = key(
        "what must stay as it is", ["peak", "peak_frequency"], OF_INFLUENCE, written=False
    )
    frequency: Annotated[float | None, Frequency] = key(
        "where ringing and apparent restitution are read; absent = at the peak, each model's own", "15.3 Hz", None,
        written=False,
    )  # fmt: skip
    tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "relative, of the peak, the ringing and its frequency", "1 %", 0.01
    )
    frequency_tolerance: Annotated[float, Frequency] = key(
        "of the peak's frequency and the ends of period 1", "0.1 Hz", 0.1
    )
    restitution_tolerance: Annotated[float, Quantity(units.RATIO, POSITIVE)] = key(
        "of the apparent restitution", 0.01, 0.01
    )
    points: Annotated[int, Count(3, MOST_POINTS)] = key(
        "drive frequencies, of the sweep's, at most; peaks and ends are then narrowed down between them", 31, 31
    )
    settle: Annotated[int | None, Periods] = key(
        "drive periods left out; absent = the sweep's", 300, None, written=False
    )
    hold: Annotated[int | None, Count(1, MOST_POINTS)] = key(
        "drive periods read; absent = the sweep's", 50, None, written=False
    )
    repeats: Annotated[int, Count(1, 1000)] = key("how often a sweep is timed", 3, 3)


class FitTable(Table):
    """Plan of vibeam fit."""

    keys: Annotated[dict[str, Any], settings()] = key(
        "what is estimated: dotted keys of the case with [lowest, highest]",
        {"drive.gain": ["3e-4", "9e-4"], "stop.restitution": [0.5, 0.95]},
    )
    references: Annotated[tuple[str, ...] | None, Each(TEXT)] = key(
        "the [reference.NAME] that it is estimated from; absent = all", ["laser"], None, written=False
    )
    unstable: Annotated[tuple[str, ...] | None, Each(TEXT)] = key(
        "those of them measured by control-based continuation: their points may lie on unstable branches",
        ["controlled"], None, written=False,
    )  # fmt: skip
