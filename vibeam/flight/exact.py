"""The exact solver of a system: plain modes and one coefficient of restitution, any law, or several contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.flight.regime_solver import RegimeSolver
    from vibeam.flight.several.solver import ContactsSolver
    from vibeam.flight.solver import FlightSolver
    from vibeam.system.impact_system import ImpactSystem


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
