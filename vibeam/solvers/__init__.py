"""Solvers of an impact system: pure functions from state to state.

A solver is built for one system and returns steady points or a motion; it never knows which reduction made
its system. ``solver`` builds one by name; ``SOLVERS`` declares them all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vibeam.solvers.declaration import CostSettings, SolverDeclaration
from vibeam_models.extensions import absent
from vibeam_models.registry import Registry

if TYPE_CHECKING:
    from vibeam.system.impact_system import ImpactSystem

SOLVERS = Registry(
    "solver",
    SolverDeclaration(
        "flight",
        "vibeam.flight.solver:FlightSolver",
        beyond_plain="vibeam.flight.solver:RegimeSolver",
        several="vibeam.flight.contacts.solver:ContactsSolver",
        motion="exact",
        blocks=True,
        derivatives=True,
        harmonics=True,
        records=True,
        marker=("*", 9.0),
    ),
    SolverDeclaration(
        "orbit",
        "vibeam.solvers.orbit:OrbitSolver",
        beyond_plain="vibeam.solvers.shot_orbit:ShotOrbitSolver",
        several="vibeam.solvers.shot_orbit:ShotOrbitSolver",
        stationary=True,
        derivatives=True,
        curves=True,
        marker=("P", 6.0),
    ),
    SolverDeclaration(
        "direct",
        "vibeam.solvers.integration.direct:DirectSolver",
        beyond_plain="vibeam.solvers.integration.direct:DirectSolver",
        harmonics=True,
        records=True,
        motion="samples",
        settings=CostSettings(methods=("LSODA", "RK23", "RK45", "DOP853"), limit=200),
        marker=("o", 4.0),
    ),
    SolverDeclaration(
        "moreau",
        "vibeam.solvers.integration.moreau:MoreauSolver",
        harmonics=True,
        records=True,
        motion="samples",
        settings=CostSettings(steps=True),
        marker=("s", 3.8),
    ),
)


def register_solver(declaration: SolverDeclaration) -> None:
    """Register a further solver for case files; ValueError where the name is taken.

    >>> import vibeam
    >>> from vibeam.flight.solver import FlightSolver
    >>> vibeam.register_solver(vibeam.SolverDeclaration("mine", FlightSolver, motion="exact"))
    >>> vibeam.load("cases/dtu_neutral.toml", {"fidelity.sdof.solver": "mine"}).fidelities["sdof"].solver
    'mine'
    """
    SOLVERS.add(declaration)


def solver(name: str, system: ImpactSystem, slowest: float, span: float = 0.0, **options: Any) -> Any:
    """Build a solver by name for one system and drives of ``slowest`` rad/s and more.

    ValueError names the known solvers or options, or says why this one cannot take the system.
    """
    if name not in SOLVERS:
        there = f"there are {', '.join(SOLVERS)}"
        raise ValueError(f"no solver {name!r}: {absent(name) or there}")
    return SOLVERS[name].make(system, slowest, span, options)


def require_readable(name: str, system: ImpactSystem, output: str) -> None:
    """KeyError for an output that the system does not have, ValueError for one that the solver does not read."""
    derivative = system.derivative(output)
    if derivative is not None and name in SOLVERS and not SOLVERS[name].derivatives:
        able = " and ".join(each for each, declared in SOLVERS.items() if declared.derivatives)
        raise ValueError(f"output {output!r}: solver {name!r} reads no {derivative.called}: {able} do")
