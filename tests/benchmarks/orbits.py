"""What a Newton step of shooting costs: flight of its period, product of its tangent maps, linear equations.

Beside the flight alone, of the same system made ready once, and beside ``vibeam.simulate``, which makes it ready.

python tests/benchmarks/orbits.py
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.solver import exact_solver
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

ROUNDS, SETTLED = 30, 200
MODES = np.arange(1, 9)
DRIVE = vibeam.Drive(60.0, 2e-4)
PERIOD = 2 * np.pi / DRIVE.omega
LAWS: dict[str, dict[str, Any]] = {
    "hard stop": {"restitution": 0.7},
    "hard stop, two, coupled damping": {"restitution": 0.7, "second_gap": 5e-4, "coupling": np.diag(MODES**2.0) + 0.3},
    "linear stop": {"law": LinearStop(1e5)},
    "linear stop, damped": {"law": LinearStop(1e5, 50.0)},
    "Hertz": {"law": Hertz(1e7)},
    "Hunt-Crossley": {"law": HuntCrossley(1e7, 0.3)},
    "Hertz, stiff": {"law": Hertz(3e9)},
    "Hertz, two stops": {"law": Hertz(1e7), "second_gap": 5e-4},
}


def rig(**more: Any) -> vibeam.ImpactSystem:
    """A cantilever of eight modes, about."""
    return vibeam.ImpactSystem.from_modes(
        50.0 * (2 * MODES - 1.0) ** 2, 0.01, 2.0 * (-1.0) ** MODES, 0.8 / (2 * MODES - 1), gap=1e-4, **more
    )


def least(call: Callable[[], object]) -> float:
    """Least CPU time of a call, µs."""
    found = np.inf
    for _ in range(ROUNDS):
        begun = time.thread_time()
        call()
        found = min(found, time.thread_time() - begun)
    return 1e6 * found


def compare(name: str, own: vibeam.ImpactSystem) -> None:
    """Print a line."""
    solver = exact_solver(own, DRIVE.omega)
    assert isinstance(solver, EventDrivenSolver)
    start = solver.simulate(DRIVE, None, 0.0, SETTLED * PERIOD, 10**6)[2]
    units = np.concatenate([own.omega, np.ones(own.size)])

    def flown() -> Any:
        return solver.simulate(DRIVE, start, 0.0, PERIOD, 10**6)

    def newton() -> object:
        _, _, last, segments, _ = flown()
        matrix = TangentMaps(own, DRIVE, segments, last).product() * (units[:, None] / units)
        apart = np.concatenate([last.displacement - start.displacement, last.velocity - start.velocity])
        return np.linalg.solve(matrix - np.eye(len(matrix)), apart * units)

    impacts = int(flown()[4]["impacts"])
    flight, step, whole = least(flown), least(newton), least(lambda: vibeam.simulate(own, DRIVE, PERIOD, start))
    print(f"{name:32s} {impacts:3d} {flight:8.0f} {step:8.0f} {step / flight:6.2f} {whole:8.0f} {step / whole:6.2f}")


def main() -> None:
    """Eight modes with every law."""
    print(f"{'µs':28s} impacts   flight   Newton  ratio simulate  ratio")
    for name, more in LAWS.items():
        compare(name, rig(**more))


if __name__ == "__main__":
    main()
