"""The tables of the cases whose structure is given, by matrices or modes; loaded where a case is one."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, ClassVar

from vibeam.casefile.tables.cases import ASIDE, AnyCase, Registered, _Checks, _Influence
from vibeam.casefile.tables.effects import effect_tables
from vibeam.casefile.tables.figures import MeasurementTable
from vibeam.casefile.tables.given import GivenDriveTable, GivenShowTable, GivenSweepTable, given_stop_table
from vibeam.casefile.tables.matrices import MatricesTable
from vibeam.casefile.tables.modes import ModesTable
from vibeam.casefile.tables.sweep import FidelityTable
from vibeam.casefile.tables.table import Table, key, table
from vibeam_models.effects import EFFECTS
from vibeam_models.laws import LAWS


class _GivenPlan(Table):
    measurement: MeasurementTable | None = key("the measuring chain", None, None, written=False, numbers=False)
    sweep: GivenSweepTable = key("the sweep of every fidelity", physics=False)
    fidelity: dict[str, FidelityTable] = key("models of the rig", physics=False)


class _GivenChecks(_Checks):
    show: dict[str, GivenShowTable] = key(  # type: ignore[assignment]
        "further figures", None, {}, written=False, **ASIDE
    )


class _Matrices(Table):
    matrices: MatricesTable

    kind: ClassVar[str] = "matrices"


class _Modes(Table):
    modes: ModesTable

    kind: ClassVar[str] = "modes"


class MatricesCase(_Influence, _GivenChecks, _GivenPlan, _Matrices, AnyCase):
    """Case of matrices of one's own, without stop and effects: ``matrices_case`` adds these."""


class ModesCase(_Influence, _GivenChecks, _GivenPlan, _Modes, AnyCase):
    """Case of modes, measured or computed, without stop and effects: ``modes_case`` adds these."""


def matrices_case() -> type[MatricesCase]:
    """The declaration of a case of matrices, with the effects and contact laws that are registered now."""
    return _matrices_case(tuple(EFFECTS.items()), tuple(LAWS.items()))


@lru_cache(maxsize=8)
def _matrices_case(effects: Registered, laws: Registered) -> type[MatricesCase]:
    made: type[MatricesCase] = _given_case("MatricesCase", "A structure by its own matrices.", _Matrices)
    return made


def modes_case() -> type[ModesCase]:
    """The declaration of a case of modes, with the effects and contact laws that are registered now."""
    return _modes_case(tuple(EFFECTS.items()), tuple(LAWS.items()))


@lru_cache(maxsize=8)
def _modes_case(effects: Registered, laws: Registered) -> type[ModesCase]:
    made: type[ModesCase] = _given_case("ModesCase", "A structure by its modes.", _Modes)
    return made


def _given_case(name: str, meaning: str, own: type[Table]) -> Any:
    stop_and_drive = {"stop": (given_stop_table(), ...), "drive": (GivenDriveTable, ...)}
    parts = (AnyCase, own, stop_and_drive, effect_tables("base"), _GivenPlan, _GivenChecks, _Influence)
    return table(name, meaning, *parts)
