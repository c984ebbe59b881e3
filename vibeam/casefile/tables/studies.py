"""Tables of the studies of cost, influence and fit; rules between their keys."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.case.plans import CostPlan, InfluencePlan
from vibeam.casefile.field_tables import settings
from vibeam.casefile.fields import TEXT, Each, Word
from vibeam.casefile.tables.table import Table, key, named_fidelity, not_there, plan_keys, table
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


CostTable: Any = table(
    "CostTable", "Plan of vibeam cost; absent = the defaults.", plan_keys(CostPlan, solvers=Each(Word(SOLVERS)))
)
InfluenceTable: Any = table(
    "InfluenceTable", "Plan of vibeam influence; absent = the defaults.", plan_keys(InfluencePlan)
)


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
        ["controlled"],
        None,
        written=False,
    )
