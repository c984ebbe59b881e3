"""Systems of a case's fidelities, their properties, and the overview of rig and sweep before a run.

The overview is one sentence, sizes, masses, modes, damping and gap, and what is implausible in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import isfinite, nan, pi
from typing import TYPE_CHECKING

import numpy as np

from vibeam.exchange.faults import CaseError, Fault
from vibeam.system.number_text import FREQUENCIES, LENGTHS, MASSES, Steps, prefixed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem

MOST = 32  # modes that the closed contact is made of


def open_frequencies(system: ImpactSystem) -> tuple[float, float, float]:
    """Frequencies of the first two elastic modes in Hz (NaN: there is none), damping ratio of the first."""
    order = np.argsort(system.omega)[rigid_of(system) :][:2]
    first, second = [float(each) / (2 * pi) for each in system.omega[order]] + [nan] * (2 - len(order))
    return first, second, float(system.zeta[order[0]]) if len(order) else nan


def rigid_of(system: ImpactSystem) -> int:
    """Number of its rigid-body modes, at 0 Hz."""
    return int(np.count_nonzero(system.omega == 0))


def closed_frequency(system: ImpactSystem) -> float:
    """Frequency of the first elastic mode in Hz with the contact held at rest; NaN where that leaves none.

    The modes are those of Ω² in the coordinates that are orthogonal to the contact's row.
    """
    order = np.argsort(system.omega)[:MOST]
    rates, contact = system.omega[order], system.contact[order]
    rates, contact = (each[np.isfinite(rates)] for each in (rates, contact))
    if len(rates) < 2 or not contact.any():
        return nan
    free = np.linalg.qr(contact[:, None], mode="complete")[0][:, 1:]
    elastic = np.linalg.eigvalsh(free.T @ (rates[:, None] ** 2 * free))[max(rigid_of(system) - 1, 0) :]
    return float(np.sqrt(max(elastic[0], 0.0)) / (2 * pi)) if len(elastic) else nan


def gap_at_rest(system: ImpactSystem) -> float:
    """Gap that is left where the static loads have bent the open system, in m (or the unit of the motion)."""
    held = system.omega > 0
    return float(system.gap - system.contact[held] @ (system.static[held] / system.omega[held] ** 2))


@dataclass(frozen=True)
class ModelProperties:
    """Number of modes of a fidelity, restitution R of its contact and R₁ of its mode 1 (NaN: the law has no one).

    ``rigid``: number of its rigid-body modes; ``first``, ``second``: frequencies of the first elastic ones in Hz,
    ``closed``: of the first with the contact held at rest (NaN: there is none), ``damping_ratio``: of the first;
    ``gap`` at rest in m, or in the unit of the motion.
    """

    modes: int
    rigid: int
    restitution: float
    first_mode_restitution: float
    first: float
    second: float
    damping_ratio: float
    closed: float
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

    own = *open_frequencies(system), closed_frequency(system), gap_at_rest(system)
    known = restitutions(case.scene_of(name), case.fidelities[name])
    return ModelProperties(system.size, rigid_of(system), *known, *own)


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
    """Faults of fidelities that a figure cannot show."""
    from vibeam.figures.sheet import refusal

    for plan in case.shows.values():
        for name in plan.fidelities:
            if name in systems and (reason := refusal(case, plan, name, systems[name])):
                yield case.fault("show", plan.name, "fidelities", message=f"{name}: {reason}")


NEAR = (0.3, 3.0)  # shares of the sweep's ends between which a mode answers it


@dataclass(frozen=True)
class Overview:
    """Rig and sweep in SI: ``sizes`` of the beam, its length first, ``mass`` of the beam and ``moving_mass`` in kg.

    ``model``: properties of the finest fidelity; ``sweep``: lowest and highest frequency in Hz. Empty or NaN: not
    known; ``plain``: lengths have no dimension.
    """

    sizes: tuple[float, ...]
    mass: float
    moving_mass: float
    model: ModelProperties
    sweep: tuple[float, float]
    plain: bool = False

    def __str__(self) -> str:
        return "; ".join(self._parts())

    def _parts(self) -> Iterator[str]:
        model = self.model
        if self.sizes:
            yield f"beam {' × '.join(map(_length, self.sizes))}, {_shown(MASSES, self.mass)}"
        if isfinite(self.moving_mass):
            yield f"moving mass {_shown(MASSES, self.moving_mass)}"
        closed = f", with the contact closed at {_hertz(model.closed)}" if isfinite(model.closed) else ""
        if model.rigid:
            yield f"a free body, {model.rigid} rigid-body mode{'s' * (model.rigid > 1)} at 0 Hz"
        if isfinite(model.first):
            yield f"mode {model.rigid + 1} at {_hertz(model.first)} (ζ {100 * model.damping_ratio:.3g} %){closed}"
        if isfinite(model.second):
            yield f"mode {model.rigid + 2} at {_hertz(model.second)}"
        yield from self._driven()
        yield f"static gap {f'{model.gap:.4g}' if self.plain else _length(model.gap)} at the contact"

    def _driven(self) -> Iterator[str]:
        """Clause on what drives it."""
        model, (low, high), number = self.model, self.sweep, self.model.rigid + 1
        over = f" = {low / model.first:.3g} … {high / model.first:.3g} × mode {number}" if model.first > 0 else ""
        yield f"sweep {_hertz(low)} … {_hertz(high)}{over}"

    @property
    def cure(self) -> str:
        """Cure that brings the rig to its stop: where the sweep leaves the first elastic mode out, to sweep over it."""
        if self.model.rigid:
            return (
                "nothing brings a free body back to its stop: hold it by a spring, add a stop beyond, or write [record]"
            )
        beside = not self.sweep[0] <= self.model.first <= self.sweep[1]
        return f"sweep over mode 1, at {_hertz(self.model.first)}, " * beside + "narrow the gap, or drive harder"

    def warnings(self) -> Iterator[str]:
        """Sentences on a sweep far from the first modes, and on a mode 1 that is overdamped."""
        model, (low, high) = self.model, self.sweep
        known = [each for each in (model.first, model.second, model.closed) if isfinite(each) and each > 0]
        if known and not model.rigid and not any(NEAR[0] * low <= each <= NEAR[1] * high for each in known):
            closed = f" ({_hertz(model.closed)} with the contact closed)" if isfinite(model.closed) else ""
            swept = f"the sweep, {_hertz(low)} … {_hertz(high)}: look at the units of the rig, or move the sweep"
            yield f"mode 1 at {_hertz(model.first)}{closed} is far from {swept}"
        if model.damping_ratio >= 1:
            yield f"a damping ratio of {model.damping_ratio:.3g} leaves mode 1 no resonance (1 % is 0.01)"


def overview_of(case: Case, models: Mapping[str, ModelProperties]) -> Overview:
    """The overview of a case by its finest fidelity with the case's own rig."""
    plain = [name for name in models if not (case.fidelities[name].changes or case.fidelities[name].without)]
    name = max(plain or models, key=lambda each: models[each].modes)
    scene, swept = case.scene_of(name), (float(case.sweep.frequency.min()), float(case.sweep.frequency.max()))
    return Overview(*scene.bulk, models[name], swept, scene.natural_unit is not None)


def _shown(steps: Steps, value: float) -> str:
    unit, factor = prefixed(steps, abs(value))
    return f"{value * factor:.4g} {unit}"


def _length(value: float) -> str:
    return _shown(LENGTHS, value)


def _hertz(value: float) -> str:
    return _shown(FREQUENCIES, value) if value > 0 and isfinite(value) else f"{value:g} Hz"
