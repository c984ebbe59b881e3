"""Sheets, the numbers of a figure; the data of a run for its figures, whoever holds them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, ValuesView
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from vibeam.case.case import Case, quantity_of
from vibeam.case.plans import ShowPlan
from vibeam.figures import FIGURES
from vibeam_models.arrays import Array
from vibeam_models.outputs import DISPLACEMENT
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem
    from vibeam.system.response import Branches

#: what the rate of an output's quantity is called
RATES = {
    "displacement": "velocity",
    "velocity": "acceleration",
    "acceleration": "jerk",
    "slope": "rate",
    "strain": "rate",
}


def named_of(text: str, quantity: str) -> str:
    """Text about ``displacement`` and ``velocity``, made one about another quantity and its rate."""
    if quantity == DISPLACEMENT.name:
        return text
    return text.replace("velocity", RATES[quantity]).replace("displacement", quantity)


@dataclass(frozen=True)
class Column:
    """Row of numbers: its unit as in ``system.quantities`` (q: the output's, q/s: its rate's), and its meaning."""

    values: Array
    unit: str
    long_name: str


Columns = Mapping[str, Column]


@dataclass(frozen=True)
class Sheet:
    """Numbers of one fidelity at one ``frequency`` (Hz; NaN: over all).

    ``fault``: the reason for missing numbers, else empty.
    """

    fidelity: str
    frequency: float
    columns: Columns = field(default_factory=dict)
    fault: str = ""

    def __getitem__(self, name: str) -> Array:
        return self.columns[name].values

    def of(self, name: str) -> Array:
        """Column by name, empty where there are no numbers."""
        return self[name] if name in self.columns else np.empty(0)


class NoMotion(Exception):
    """No motion to show; the text gives the reason."""


def module_of(plan: ShowPlan) -> Any:
    """Module of the plan's kind."""
    return loaded(FIGURES[plan.kind].home)


def sheets(case: Case, plan: ShowPlan) -> tuple[Sheet, ...]:
    """Sheets of all fidelities of a plan, in order."""
    quantity = quantity_of(case, plan.output)
    found = tuple(sheet for name in plan.fidelities for sheet in _sheets_of(case, plan, name))
    return found if quantity is DISPLACEMENT else tuple(_named(sheet, quantity.name) for sheet in found)


def refusal(case: Case, plan: ShowPlan, fidelity: str, system: ImpactSystem) -> str:
    """Why the plan's kind cannot show a fidelity of this ``system``; empty where it can."""
    return str(module_of(plan).refusal(case, fidelity, system)) if FIGURES[plan.kind].refuses else ""


def _named(sheet: Sheet, quantity: str) -> Sheet:
    """The sheet whose columns of an output and its rate are said to be of its ``quantity``."""
    columns = {
        name: replace(column, long_name=named_of(column.long_name, quantity)) if column.unit in ("q", "q/s") else column
        for name, column in sheet.columns.items()
    }
    return replace(sheet, columns=columns)


def sheet_at(case: Case, plan: ShowPlan, fidelity: str, frequency: float | None, stored: tuple[Sheet, ...]) -> Sheet:
    """Sheet of one fidelity at one ``frequency`` (Hz; None: over all), computed unless it is among ``stored``."""
    at = float("nan") if frequency is None else frequency
    for sheet in stored:
        if sheet.fidelity == fidelity and np.isclose(sheet.frequency, at, rtol=1e-9, atol=0, equal_nan=True):
            return sheet
    narrowed = plan if frequency is None else replace(plan, frequency=(frequency,))
    return _computed(case, narrowed, fidelity)


@lru_cache(maxsize=64)
def _computed(case: Case, plan: ShowPlan, fidelity: str) -> Sheet:
    """First sheet of a fidelity, computed once for all numbers that are read off it."""
    return _sheets_of(case, plan, fidelity)[0]


def _sheets_of(case: Case, plan: ShowPlan, fidelity: str) -> list[Sheet]:
    """Sheets of one fidelity, the kind's own or one a frequency; none where the sweep has the numbers."""
    module = module_of(plan)
    if (sheets := getattr(module, "sheets", None)) is not None:
        return list(sheets(case, fidelity, plan))
    if (columns := getattr(module, "columns", None)) is None:
        return []
    return [sheet_of(fidelity, partial(columns, case, fidelity, each, plan), each) for each in plan.frequency]


def sheet_of(fidelity: str, columns: Callable[[], Columns], frequency: float = float("nan")) -> Sheet:
    """Sheet at one frequency (Hz; NaN: over all), empty and with the reason where there is no motion."""
    try:
        return Sheet(fidelity, frequency, columns())
    except (NoMotion, ValueError) as reason:  # ValueError: of an observer, for example with too few samples
        return Sheet(fidelity, frequency, fault=str(reason))


class Comparison(Protocol):
    """Branches of every fidelity by name, as a mapping, with the figures' further data."""

    @property
    def case(self) -> Case:
        """Case of the run."""

    @property
    def finest(self) -> Mapping[str, str]:
        """Finest fidelity of the same physics for each fidelity."""

    @property
    def held(self) -> str:
        """Restitution held equal in the fidelities, and what the other choice gives; empty without a comparison."""

    @property
    def shown(self) -> Mapping[str, tuple[Sheet, ...]]:
        """Numbers of the figures that the case asks for."""

    def __getitem__(self, fidelity: str, /) -> Branches: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def values(self) -> ValuesView[Branches]:
        """Branches in the case's order."""
