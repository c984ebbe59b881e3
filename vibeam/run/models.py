"""The models that are compared: the case's fidelities, and its finest one cut off after fewer modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.case.fidelity import Fidelity, system
from vibeam_models.laws.restitution import contact_restitution, first_mode_restitution
from vibeam_models.scene import SdofScene

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


COUNTS = (1, 2, 4, 8, 16, 32, 64)

CUT_SOLVERS = ("flight", "orbit")  # of a model that is there for its number of modes


@dataclass(frozen=True)
class Model:
    """A fidelity with its system; ``cut``: not in the case, there to show what modes cost.

    ``like``: the fidelity of the case whose scene it has.
    """

    name: str
    fidelity: Fidelity
    system: ImpactSystem
    cut: bool = False
    like: str = ""


def models(case: Case, counts: tuple[int, ...] | None = None) -> tuple[list[Model], dict[str, str]]:
    """The models in the case's order, then the cut ones by ``counts`` of modes; and which names stand for which model.

    ``counts`` None: 1, 2, 4, 8 … below the finest fidelity's. Fidelities that differ in their solver alone are one
    model. ValueError for a fidelity that cannot be built.
    """
    found: list[Model] = []
    same: dict[str, str] = {}
    for name, fidelity in case.fidelities.items():
        _add(found, same, Model(name, fidelity, case.system(name), like=name))
    if isinstance(case.scene, SdofScene):
        return found, same
    top = finest(found)
    for count in [n for n in COUNTS if n < top.system.size] if counts is None else counts:
        fidelity = replace(top.fidelity, name=f"modes_{count}", reduction="modal", modes=count)
        _add(found, {}, Model(fidelity.name, fidelity, built(case, fidelity, top.name), True, top.name))
    return found, same


def built(case: Case, fidelity: Fidelity, like: str) -> ImpactSystem:
    """The system of a fidelity that the case does not name, in the scene of the one that it is ``like``."""
    return system(case.scene_of(like), fidelity)


def finest(found: list[Model]) -> Model:
    """The model with most modes, the first of several."""
    return max(found, key=lambda model: model.system.size)


def _add(found: list[Model], same: dict[str, str], new: Model) -> None:
    twin = next((model for model in found if equal(model.system, new.system)), None)
    if twin is None:
        found.append(new)
    else:
        same[new.name] = twin.name


def equal(one: ImpactSystem, other: ImpactSystem) -> bool:
    """Whether two systems are the same to the bit, outputs included."""
    if one.outputs.keys() != other.outputs.keys() or not one.moves_as(other):
        return False
    return all(np.array_equal(row, other.outputs[name]) for name, row in one.outputs.items())


def seen(model: ImpactSystem) -> float:
    """R₁: the restitution that the first mode sees; NaN where the law has no one coefficient."""
    if model.law is not None:
        return float("nan")
    return first_mode_restitution(model.restitution, float(model.contact[0]), float(np.sum(model.contact**2)))


def with_seen(model: ImpactSystem, restitution: float) -> ImpactSystem:
    """The system whose first mode sees ``restitution``; ValueError where no contact restitution gives that."""
    if model.law is not None or np.isnan(restitution):
        raise ValueError("the contact law has no one coefficient of restitution that could be carried over")
    mobility = float(np.sum(model.contact**2))
    return replace(model, restitution=contact_restitution(restitution, float(model.contact[0]), mobility))
