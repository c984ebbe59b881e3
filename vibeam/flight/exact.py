"""The exact solver of a system: plain modes and one coefficient of restitution, any law, or several contacts.

What an engine loads at its first call is no cost of a motion: a motion of no duration is run unmeasured.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING

from vibeam.system.impact_system import Drive, ImpactSystem

if TYPE_CHECKING:
    from vibeam.flight.regime_solver import RegimeSolver
    from vibeam.flight.several.solver import ContactsSolver
    from vibeam.flight.solver import FlightSolver


def exact_solver(
    system: ImpactSystem, slowest: float, span: float = 0.0
) -> FlightSolver | RegimeSolver | ContactsSolver:
    """The engine that takes ``system``, made for drives of ``slowest`` rad/s and more; the others are not imported."""
    if system.further is not None:
        from vibeam.flight.several.solver import ContactsSolver

        return ContactsSolver(system, slowest, span)
    if system.beyond_plain:
        from vibeam.flight.regime_solver import RegimeSolver

        return RegimeSolver(system, slowest, span)
    from vibeam.flight.solver import FlightSolver

    return FlightSolver(system, slowest, span)


_READY: set[tuple[Hashable, ...]] = set()


def warm_up_motion(system: ImpactSystem, drive: Drive) -> None:
    """Run a motion of no duration, once a process for systems of the same kind."""
    kind = kind_of(system)
    if kind not in _READY:
        exact_solver(system, drive.omega, 1.0).simulate(drive, None, 0.0, 0.0, 1)
        _READY.add(kind)


def kind_of(system: ImpactSystem) -> tuple[Hashable, ...]:
    """What the system has beyond plain modes: it decides which code runs."""
    return system.contact_law.name, system.coupling is None, system.second_gap is None, system.further is None
