"""Warm-up runs, not measured: loading and compiling at a solver's first call are no part of its cost.

The first call of a solver reads its kernels from numba's cache (0.15 s, as much as a short sweep), imports what scipy
loads late and touches its memory for the first time; all that counts as CPU time of the thread.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np

from vibeam.flight.exact import kind_of
from vibeam.solvers import solver
from vibeam.system.impact_system import ImpactSystem

Options = Mapping[str, Any]
SETTLE, HOLD = 1, 2  # drive periods: the smallest number in which a motion can repeat


_READY: set[tuple[Hashable, ...]] = set()


def warm_up(name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options) -> None:
    """Run one short point with a solver of its own, at ``omega`` rad/s and base ``amplitude`` m; discard the result."""
    made = solver(name, system, omega, **options)
    made.steady(np.array([omega]), amplitude, None, SETTLE, HOLD, output)
    _READY.add(_kind(name, system, options))


def warm_up_once(
    name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options
) -> None:
    """Warm up once in this process for each solver and type of system."""
    if _kind(name, system, options) not in _READY:
        warm_up(name, system, omega, amplitude, output, options)


def _kind(name: str, system: ImpactSystem, options: Options) -> tuple[Hashable, ...]:
    """Key of the code that a run executes: the solver, its methods, and the system's features beyond plain modes."""
    methods = tuple(sorted(item for item in options.items() if isinstance(item[1], str)))
    return name, methods, *kind_of(system)
