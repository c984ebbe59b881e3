"""Systems and yardsticks for the solvers that step through time: the flight solver is exact, they converge to it."""

from __future__ import annotations

from typing import Any

import numpy as np

import vibeam
from vibeam.extensions.paper.ivanov import IvanovSolver
from vibeam.extensions.paper.zhuravlev import ZhuravlevSolver
from vibeam.solvers.integration.direct import DirectSolver
from vibeam.solvers.integration.moreau import MoreauSolver

SOLVERS = {
    "direct": DirectSolver,
    "zhuravlev": ZhuravlevSolver,
    "ivanov": IvanovSolver,
    "moreau": MoreauSolver,
}
DRIVE = vibeam.Drive(2.0, 0.5e-3)
B = 0.5e-3


def sdof(gap: float = 0.0, restitution: float = 0.9, **more: Any) -> vibeam.ImpactSystem:
    """The paper's nominal model."""
    return vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, gap=gap, restitution=restitution, **more)


def three_modes() -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [1.0, 6.3, 17.5], 0.02, [1.0, -0.8, 0.6], [1.0, 0.5, 0.2], gap=0.0, restitution=0.7
    )


def start(size: int = 1, scale: float = 1.0) -> vibeam.State:
    """Off the stop, moving toward it."""
    return vibeam.State(np.full(size, -2e-3 * scale) / size, np.full(size, 4e-3 * scale) / size)


def error(solver: Any, exact: Any, t_end: float, state: vibeam.State) -> float:
    """Root-mean-square error of the impact velocities over the largest of them; all impacts must be there."""
    path = solver.motion(DRIVE, state, 0.0, t_end)
    assert len(path.impact_velocities) == len(exact), f"{len(path.impact_velocities)} impacts, not {len(exact)}"
    return float(np.sqrt(np.mean((path.impact_velocities - exact) ** 2)) / np.max(exact))


def observed_order(
    name: str,
    options: list[dict[str, Any]],
    sizes: list[float],
    system: vibeam.ImpactSystem,
    t_end: float,
    scales: tuple[float, ...] = (1.0,),
) -> tuple[float, list[float]]:
    """Slope of log error over log ``sizes`` (tolerance or step), and the errors, averaged over ``scales`` of starts."""
    truth = three_modes() if system.size == 3 else sdof()
    errors = np.zeros(len(sizes))
    for scale in scales:
        state = start(system.size, scale)
        exact = vibeam.simulate(truth, DRIVE, t_end, state).impact_velocities
        solvers = [SOLVERS[name](system, 2.0, **o) for o in options]
        errors += [error(solver, exact, t_end, state) / len(scales) for solver in solvers]
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0]), list(errors)


def mean_energy(system: vibeam.ImpactSystem, omega: float, state: vibeam.State, periods: int) -> np.ndarray:
    """Time-mean energy (n,) of each mode over the exact path: midpoint rule, far finer than any mode."""
    span = periods * 2 * np.pi / omega
    path = vibeam.simulate(system, vibeam.Drive(omega, B), span, state)
    values = path.modes_at((np.arange(200_000) + 0.5) * span / 200_000)
    return np.mean(values[:, 1] ** 2 + system.omega**2 * values[:, 0] ** 2, axis=0) / 2


def jumps(times: np.ndarray, velocity: np.ndarray, most: float) -> np.ndarray:
    """Indices i of the intervals in which the velocity changes by more than an acceleration ``most`` explains."""
    return np.flatnonzero(np.abs(np.diff(velocity)) > most * np.diff(times) + 1e-9)
