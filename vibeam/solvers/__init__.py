"""Solvers: state in, state out, nothing remembered."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibeam.solvers.flight import FlightSolver
    from vibeam.system import ImpactSystem

NAMES = ("flight",)
COMPILE_SECONDS = 20  # about, on two cores


def solver(name: str, system: ImpactSystem, slowest: float, span: float = 0.0) -> FlightSolver:
    """The solver of that name for one system and drives of ``slowest`` rad/s and more; ValueError names those known."""
    if name not in NAMES:
        raise ValueError(f"no solver {name!r}: there are {', '.join(NAMES)}")
    from vibeam.solvers.flight import FlightSolver

    return FlightSolver(system, slowest, span)


def compiled() -> bool:
    """Whether the kernels, as they are, lie compiled in numba's cache."""
    from vibeam.solvers.kernels.compiled import move
    from vibeam.solvers.kernels.jit import is_compiled

    return is_compiled(move)


def compile_kernels() -> None:
    """Compile the kernels, or load them from numba's cache, by running the smallest system for one period."""
    from vibeam.solvers.flight import FlightSolver
    from vibeam.system import ImpactSystem

    system = ImpactSystem.from_modes([1.0], 0.1, 1.0, 1.0, restitution=0.5)
    FlightSolver(system, 1.0).steady([1.0], 1.0, None, 1, 2, "contact")
