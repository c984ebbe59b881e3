"""Where a computation starts when nobody says: static equilibrium, pressed into a stop that yields."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.solvers.start import equilibrium, without_stop
from vibeam.state import State
from vibeam.system import ImpactSystem
from vibeam_models.compliant import HuntCrossley, LinearStop

Array = NDArray[np.float64]


def equilibrium_with_law(system: ImpactSystem) -> State:
    """The static equilibrium: of a hard stop as for every solver, of one that yields where the forces balance.

    Modes without stiffness start at zero displacement and carry no contact force.
    """
    free = without_stop(system)
    for row, gap in stops(system):
        beyond = float(row @ free) - gap
        if beyond <= 0:
            continue
        if not isinstance(system.law, LinearStop | HuntCrossley):
            found = equilibrium(replaced(system, gap, row))
            return State(found.displacement, found.velocity, True)
        give = np.where(system.omega > 0, row / np.where(system.omega > 0, system.omega, 1.0) ** 2, 0.0)
        force = balance(system.law, beyond, float(row @ give))
        return State(free - give * force, np.zeros(system.size))
    return State(free, np.zeros(system.size))


def stops(system: ImpactSystem) -> list[tuple[Array, float]]:
    """Row towards the stop and gap, of every stop."""
    second = [] if system.second_gap is None else [(-system.contact, system.second_gap)]
    return [(system.contact, system.gap), *second]


def replaced(system: ImpactSystem, gap: float, row: Array | None = None) -> ImpactSystem:
    """The system with one hard stop, elsewhere."""
    from dataclasses import replace

    contact = system.contact if row is None else row
    return replace(system, gap=gap, contact=contact, law=None, coupling=None, second_gap=None)


def balance(law: LinearStop | HuntCrossley, beyond: float, give: float) -> float:
    """The force F with F = k d^p and d = beyond − give F: ``beyond`` m into the stop without it, ``give`` m/N."""
    if isinstance(law, LinearStop):
        return law.stiffness * beyond / (1 + law.stiffness * give)
    low, high = 0.0, beyond
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        excess = middle + give * law.stiffness * middle**law.exponent - beyond
        low, high = (low, middle) if excess > 0 else (middle, high)
    return float(law.stiffness * high**law.exponent)
