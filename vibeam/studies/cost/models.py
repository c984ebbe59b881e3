"""Compared models: the case's fidelities, and its finest one truncated to fewer modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from vibeam.case.fidelity import Fidelity, system
from vibeam.observe.restitution import first_mode_restitution

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


COUNTS = (1, 2, 4, 8, 16, 32, 64)
CUT_SOLVERS = ("flight", "orbit")  # prefix of a truncated model


@dataclass(frozen=True)
class CostModel:
    """Fidelity with its system; ``cut``: not in the case, truncated to show the effect of the number of modes.

    ``like``: the fidelity of the case whose scene it uses.
    """

    name: str
    fidelity: Fidelity
    system: ImpactSystem
    cut: bool = False
    like: str = ""


def models(case: Case, counts: tuple[int, ...] | None = None) -> tuple[list[CostModel], dict[str, str]]:
    """Models in the case's order, then truncated ones by ``counts`` of modes; and the model of each name.

    ``counts`` None: 1, 2, 4, 8 … below the finest fidelity's. Fidelities that differ in their solver alone are one
    model. ValueError for a fidelity that cannot be built.
    """
    found: list[CostModel] = []
    same: dict[str, str] = {}
    for name, fidelity in case.fidelities.items():
        _add(found, same, CostModel(name, fidelity, case.system(name), like=name))
    if case.scene.given_mode is not None:
        return found, same
    top = finest(found)
    for count in [n for n in COUNTS if n < top.system.size] if counts is None else counts:
        cut: dict[str, Any] = {"reduction": "modal", "modes": count, "parameters": {}}
        fidelity = replace(top.fidelity, name=f"modes_{count}", **cut)
        _add(found, {}, CostModel(fidelity.name, fidelity, built(case, fidelity, top.name), True, top.name))
    return found, same


def built(case: Case, fidelity: Fidelity, like: str) -> ImpactSystem:
    """System of a fidelity not named by the case, in the scene of the fidelity ``like``."""
    return system(case.scene_of(like), fidelity)


def finest(found: list[CostModel]) -> CostModel:
    """CostModel with most modes, the first of several."""
    return max(found, key=lambda model: model.system.size)


def _add(found: list[CostModel], same: dict[str, str], new: CostModel) -> None:
    twin = next((model for model in found if model.system == new.system), None)
    if twin is None:
        found.append(new)
    else:
        same[new.name] = twin.name


def first_mode_restitution_of(model: ImpactSystem) -> float:
    """First-mode restitution R₁; NaN where the law has no single coefficient."""
    return first_mode_restitution(model) if model.law is None else float("nan")
