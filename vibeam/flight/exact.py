"""The exact solver of a system: plain modes and one coefficient of restitution, or any regime and contact law."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.flight.regime_solver import RegimeSolver
    from vibeam.flight.solver import FlightSolver
    from vibeam.system.impact_system import ImpactSystem


def exact_solver(system: ImpactSystem, slowest: float, span: float = 0.0) -> FlightSolver | RegimeSolver:
    """The engine that takes ``system``, made for drives of ``slowest`` rad/s and more; the other is not imported."""
    if system.beyond_plain:
        from vibeam.flight.regime_solver import RegimeSolver

        return RegimeSolver(system, slowest, span)
    from vibeam.flight.solver import FlightSolver

    return FlightSolver(system, slowest, span)
