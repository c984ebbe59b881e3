"""Systems of a case's fidelities, and what a report needs of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.faults import CaseError, Fault
from vibeam.runs.first_modes import closed_frequency, gap_at_rest, open_frequencies

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


@dataclass(frozen=True)
class ModelProperties:
    """Number of modes of a fidelity, restitution R of its contact and R₁ of its mode 1 (NaN: the law has no one).

    ``first``, ``second``: frequencies of its first modes in Hz, ``closed``: of mode 1 with the contact held at rest
    (NaN: there is none); ``damping_ratio`` of mode 1; ``gap`` at rest in m, or in the unit of the motion.
    """

    modes: int
    restitution: float
    first_mode_restitution: float
    first: float
    second: float
    closed: float
    damping_ratio: float
    gap: float


class Systems(Mapping[str, "ImpactSystem"]):
    """System of every fidelity of a case by name, all built when the first is asked for.

    CaseError then names all that cannot be built or that their solver or a figure cannot take.
    """

    def __init__(self, case: Case) -> None:
        self._case = case

    @cached_property
    def _built(self) -> dict[str, ImpactSystem]:
        return _systems(self._case)

    def __getitem__(self, name: str) -> ImpactSystem:
        return self._built[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._case.fidelities)

    def __len__(self) -> int:
        return len(self._case.fidelities)


def require_runnable(case: Case) -> None:
    """CaseError where a fidelity cannot be built, or a solver or a figure cannot take it."""
    _systems(case)


def properties_of(case: Case, name: str, system: ImpactSystem) -> ModelProperties:
    """Properties of one fidelity's model, which is ``system``."""
    from vibeam.case.fidelity import restitutions

    first, second, damping_ratio = open_frequencies(system)
    own = first, second, closed_frequency(system), damping_ratio, gap_at_rest(system)
    return ModelProperties(system.size, *restitutions(case.scene_of(name), case.fidelities[name]), *own)


def _systems(case: Case) -> dict[str, ImpactSystem]:
    from vibeam.solvers import solver
    from vibeam.system.impact_system import Drive

    systems, faults = {}, []
    slowest = 2 * np.pi * float(np.min(case.sweep.frequency))
    for name, fidelity in case.fidelities.items():
        try:
            systems[name] = case.system(name)
            solver(fidelity.solver, systems[name], slowest, 0.0, **fidelity.options)
            if harmonics := case.scene_of(name).harmonics:
                from vibeam.solvers.harmonic_point import several_of

                several_of(systems[name], Drive(slowest, 0.0), harmonics, fidelity.solver)
        except ValueError as error:
            faults.append(case.fault("fidelity", name, message=str(error)))
    for name in case.fidelities:
        try:
            case.amplitude_of(name, 2 * np.pi * case.sweep.frequency)
        except ValueError as error:
            where = "drive" if getattr(case.scene_of(name), "platform", None) is None else "platform"
            faults.append(case.fault(where, message=str(error)))
    faults += _not_shown(case, systems)
    if faults:
        raise CaseError(faults)
    return systems


def _not_shown(case: Case, systems: Mapping[str, ImpactSystem]) -> Iterator[Fault]:
    """What a figure cannot show."""
    from vibeam.figures.sheet import refusal

    for plan in case.shows.values():
        for name in plan.fidelities:
            if name in systems and (reason := refusal(case, plan, name, systems[name])):
                yield case.fault("show", plan.name, "fidelities", message=f"{name}: {reason}")
