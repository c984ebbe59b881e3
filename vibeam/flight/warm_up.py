"""A motion of no duration, run unmeasured: what an engine loads at its first call is no cost of a motion."""

from __future__ import annotations

from collections.abc import Hashable

from vibeam.flight.exact import exact_solver
from vibeam.system.impact_system import Drive, ImpactSystem

_READY: set[tuple[Hashable, ...]] = set()


def warm_up_motion(system: ImpactSystem, drive: Drive) -> None:
    """Run a motion of no duration, once a process for systems of the same kind."""
    kind = kind_of(system)
    if kind not in _READY:
        exact_solver(system, drive.omega, 1.0).simulate(drive, None, 0.0, 0.0, 1)
        _READY.add(kind)


def kind_of(system: ImpactSystem) -> tuple[Hashable, ...]:
    """What the system has beyond plain modes: it decides which code runs."""
    return type(system.law).__name__, system.coupling is None, system.second_gap is None, system.further is None
