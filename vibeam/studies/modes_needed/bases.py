"""Reductions that a case can be asked about: those that count modes, and those of its fidelities with their keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

from vibeam.case.case import Case
from vibeam.case.fidelity import parameters_of
from vibeam_models.laws.restitution import Restitution
from vibeam_models.structure import Structure
from vibeam_reductions.declaration import REDUCTIONS, ReductionDeclaration
from vibeam_reductions.projection import Reduction


@dataclass(frozen=True)
class ReductionBasis:
    """A reduction with its ``parameters``; ``why``: why the case cannot have it, empty where it can."""

    name: str
    declared: ReductionDeclaration
    parameters: Mapping[str, Any] = field(default_factory=dict)
    why: str = ""

    def of(self, structure: Structure, n: int) -> Reduction:
        """The reduction to ``n`` coordinates; ValueError where there is none."""
        if self.why:
            raise ValueError(self.why)
        return self.declared.make(structure, n, **self.parameters)


def bases_of(case: Case, names: tuple[str, ...] | None) -> list[ReductionBasis]:
    """Bases of a case: all that count modes and need nothing more, then those that its fidelities say the keys of.

    ``names``: these alone; ValueError, with those that there are, for another.
    """
    found = {basis.name: basis for basis in (*_plain(case), *_of_fidelities(case))}
    unknown = [name for name in names or () if name not in found]
    if unknown:
        raise ValueError(f"basis: no {', '.join(unknown)}: there are {', '.join(found)}")
    return [found[name] for name in names or found]


def _plain(case: Case) -> Iterator[ReductionBasis]:
    """Without keys; a Krylov space about the middle of the sweep."""
    middle = float((case.sweep.frequency.min() + case.sweep.frequency.max()) / 2)
    for declared in REDUCTIONS.values():
        if declared.counts and not declared.needs:
            further = {"frequency": middle} if "frequency" in declared.takes else {}
            yield ReductionBasis(declared.name, declared, further, _refusal(case, declared))


def _of_fidelities(case: Case) -> Iterator[ReductionBasis]:
    """With their keys, or why there is no flight to make one of."""
    for name, fidelity in case.fidelities.items():
        declared, scene = REDUCTIONS[fidelity.reduction], cast(Any, case.scene_of(name))
        if declared.counts and fidelity.parameters:
            try:
                yield ReductionBasis(name, declared, parameters_of(scene, fidelity), _refusal(case, declared))
            except ValueError as refusal:
                yield ReductionBasis(name, declared, why=str(refusal))


def _refusal(case: Case, declared: ReductionDeclaration) -> str:
    """Reason why the stop cannot go with a contact without mass."""
    if not declared.massless or case.scene.stop is None:
        return ""
    try:
        law = case.scene.stop.law
        (Restitution(1.0) if law is None else law.contact(1.0)).in_series(1.0)
    except ValueError as refusal:
        return str(refusal).rpartition(": write")[0]
    return ""
