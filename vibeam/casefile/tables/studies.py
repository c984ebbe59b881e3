"""Tables of the studies of cost, influence and fit; rules between their keys."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

from vibeam.case.study_plans import CostPlan, FitPlan, InfluencePlan
from vibeam.casefile.field_tables import settings
from vibeam.casefile.fields import Each, Word
from vibeam.casefile.tables.declared import table
from vibeam.casefile.tables.table import named_fidelity, plan_keys
from vibeam.exchange.faults import Complaint
from vibeam.solvers import SOLVERS


def study_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the studies that a case asks for."""
    if getattr(case, "influence", None) is not None:
        yield from named_fidelity(case, ("influence", "fidelity"), case.influence.fidelity)
    yield from _numbers(case)


def _numbers(case: SimpleNamespace) -> Iterator[Complaint]:
    number = getattr(case.uncertainty, "samples", None)
    if number is not None and number.bit_count() != 1:
        yield ("uncertainty", "samples"), f"{number} is no power of two: write {1 << (number.bit_length() - 1)}"


CostTable = table(
    "CostTable",
    "Plan of vibeam verdict --only solvers; absent = the defaults.",
    plan_keys(CostPlan, solvers=Each(Word(SOLVERS))),
)
InfluenceTable = table(
    "InfluenceTable", "Plan of vibeam verdict --only effects; absent = the defaults.", plan_keys(InfluencePlan)
)


FitTable = table("FitTable", "Plan of vibeam fit.", plan_keys(FitPlan, keys=settings()))
