"""Runs that are not measured: what a solver loads or compiles at its first call is no part of what a motion costs.

The first call of a solver reads its kernels from numba's cache (0.15 s, as much as a short sweep), imports what scipy
loads late and touches its memory for the first time; all that counts as CPU time of the thread.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np

from vibeam.flight.warm_up import kind_of
from vibeam.solvers import solver
from vibeam.system.impact_system import ImpactSystem

Options = Mapping[str, Any]
SETTLE, HOLD = 1, 2  # drive periods: the fewest in which a motion can repeat


_READY: set[tuple[Hashable, ...]] = set()


def warm_up(name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options) -> None:
    """One short point by a solver of its own, at ``omega`` rad/s and base ``amplitude`` m: nothing of it is kept."""
    made = solver(name, system, omega, **options)
    made.steady(np.array([omega]), amplitude, None, SETTLE, HOLD, output)
    _READY.add(_kind(name, system, options))


def warm_up_once(
    name: str, system: ImpactSystem, omega: float, amplitude: float, output: str, options: Options
) -> None:
    """``warm_up``, unless this process has done so with the same solver for a system of the same kind."""
    if _kind(name, system, options) not in _READY:
        warm_up(name, system, omega, amplitude, output, options)


def _kind(name: str, system: ImpactSystem, options: Options) -> tuple[Hashable, ...]:
    """What decides which code runs: the solver, its methods, and what the system has beyond plain modes."""
    methods = tuple(sorted(item for item in options.items() if isinstance(item[1], str)))
    return name, methods, *kind_of(system)
