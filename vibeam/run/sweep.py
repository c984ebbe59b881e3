"""Frequency sweep of any system by any solver over any grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.solvers import SOLVERS
from vibeam.solvers import solver as solver_named
from vibeam.solvers.warm_up import warm_up_once
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arguments import count, floats, number, refuse, require
from vibeam_models.laws.compliant import CompliantStop

Array = NDArray[np.float64]

Direction = Literal["up", "down", "both"]

LONGEST = 10**9  # largest number of drive periods to settle a point: at 0.2 µs each, minutes

HELD = 10**8  # largest number of modal states, one a drive period, held for a point: 1.6 GB


def march(
    system: ImpactSystem,
    omega: ArrayLike,
    amplitude: ArrayLike,
    *,
    settle: int = 200,
    hold: int = 50,
    solver: str = "flight",
    output: str = "contact",
    state: State | None = None,
    block: int = 1,
    slowest: float | None = None,
    options: Mapping[str, Any] | None = None,
    drift: ArrayLike | None = None,
    wear: float | None = None,
    struck: int = 0,
) -> Iterator[tuple[FrequencyResponse, State]]:
    """Steady points in the order of ``omega`` (rad/s), ``block`` at a time, each with the state after it.

    The state is carried from point to point (displacement and velocity relative to the base; the drive's phase starts
    at 0 at every point); ``state`` None: static equilibrium. ``amplitude``: of the base, m, one number or one for each
    frequency (they then come one at a time, whatever ``block`` is). ``slowest``: the lowest frequency of the whole
    sweep, where ``omega`` is only its rest: numbers are then the same to the bit.
    ``options``: the solver's own. ``drift`` (points,): growth of the gap at each point, m. ``wear``: growth of the
    gap by each impact, for the points after it, m, settling included; ``struck`` impacts came before the first.
    A point that fails is NaN with its reason, and the next one starts from equilibrium.
    ``settle`` is at most 10⁹, ``hold`` at most 10⁸ over the number of modes. ValueError for a grid, periods, solver or
    type of argument that makes no sense, KeyError for an unknown output.
    """
    require("system", system, ImpactSystem)
    require("state", state, State, none_too=True)
    grid = np.atleast_1d(floats("omega", omega))
    if grid.ndim != 1 or not len(grid) or not np.all(np.isfinite(grid) & (grid > 0)):
        raise ValueError("omega: must be one or more positive frequencies in rad/s")
    settle, hold, block, struck = _counts(system, settle, hold, block, struck)
    drives = _amplitudes(amplitude, grid)
    system.output(output)
    rate = float(grid.min()) if slowest is None else slowest
    warm_up_once(solver, system, float(grid[0]), float(drives.flat[0]), output, options or {})
    if drift is not None or wear is not None:
        drives, changes = np.broadcast_to(drives, grid.shape), _gap_changes(grid, drift, wear, struck, solver)
        yield from _drifting(system, grid, drives, settle, hold, solver, output, state, rate, options or {}, changes)
        return
    runner = solver_named(solver, system, rate, **(options or {}))
    step = block if drives.ndim == 0 else 1
    for first in range(0, len(grid), step):
        drive = float(drives if drives.ndim == 0 else drives[first])
        response, state = runner.steady(grid[first : first + step], drive, state, settle, hold, output)
        yield response, state


def _counts(system: ImpactSystem, *given: Any) -> tuple[int, int, int, int]:
    """Return settle, hold, block and struck as ints; ValueError with every fault."""
    faults: list[str] = []
    settle, hold, block, struck = given
    found = (
        count("settle", settle, faults, most=LONGEST),
        count("hold", hold, faults, least=1, most=HELD // system.size),
        count("block", block, faults, least=1),
        count("struck", struck, faults),
    )
    refuse("", faults)
    return found


def _amplitudes(amplitude: ArrayLike, grid: Array) -> Array:
    """Return one number, or one for each frequency; ValueError for anything else."""
    drives = floats("amplitude", amplitude)
    if drives.shape not in ((), grid.shape):
        raise ValueError(f"amplitude: must be one number or one for each of the {len(grid)} frequencies")
    if not np.all(np.isfinite(drives)):
        raise ValueError(f"amplitude: {drives} is not finite")
    return drives


@dataclass(frozen=True)
class _GapChanges:
    """Changes of the gap along the sweep: drift at each point, wear an impact, impacts so far."""

    drift: Array
    wear: float
    struck: int


def _gap_changes(grid: Array, drift: ArrayLike | None, wear: float | None, struck: int, solver: str) -> _GapChanges:
    added = np.zeros(grid.shape) if drift is None else floats("drift", drift)
    if added.shape != grid.shape or not np.all(np.isfinite(added)):
        raise ValueError(f"drift: must be {len(grid)} finite numbers, one a frequency")
    faults: list[str] = []
    worn = 0.0 if wear is None else number("wear", wear, faults, least=0.0)
    refuse("", faults)
    if wear is not None and solver in SOLVERS and SOLVERS[solver].stationary:
        raise ValueError(f"wear: solver {solver!r} counts no impacts on the way to a steady motion: 'flight' does")
    return _GapChanges(added, worn, struck)


def _drifting(
    system: ImpactSystem, grid: Array, drives: Array, settle: int, hold: int, solver: str, output: str,
    state: State | None, rate: float, options: Mapping[str, Any], changes: _GapChanges,
) -> Iterator[tuple[FrequencyResponse, State]]:  # fmt: skip
    """Sweep point by point, each with its own gap; a state beyond the moved stop is put back onto it."""
    struck = changes.struck
    for omega, drive, more in zip(grid, drives, changes.drift, strict=True):
        moved = replace(system, gap=system.gap + float(more) + changes.wear * struck)
        start = None if state is None else _onto_stop(moved, state)
        response, state = solver_named(solver, moved, rate, **options).steady(
            np.array([omega]), float(drive), start, settle, hold, output
        )
        struck += int(response.impacts[0])
        yield response, state


def _onto_stop(system: ImpactSystem, state: State) -> State:
    """State admissible to a hard stop; one that rested on the stop before it moved moves along."""
    if isinstance(system.law, CompliantStop):
        return state
    beyond = float(system.contact @ state.displacement) - system.gap
    if beyond <= 0 and not state.resting:
        return state
    back = system.contact * (beyond / float(system.contact @ system.contact))
    return State(state.displacement - back, state.velocity, state.resting)


def sweep(
    system: ImpactSystem,
    *,
    omega: ArrayLike,
    amplitude: ArrayLike,
    direction: Direction = "up",
    settle: int = 200,
    hold: int = 50,
    solver: str = "flight",
    output: str = "contact",
    state: State | None = None,
    options: Mapping[str, Any] | None = None,
    drift: Callable[[Array], Array] | None = None,
    wear: float | None = None,
) -> FrequencyResponse | Branches:
    """Sweep over ``omega`` (rad/s): the frequency-response curve in the order swept, or Branches(up, down) for "both".

    Arguments and errors as in ``march``; amplitudes that are one for each frequency are in the order of ``omega``.
    ``drift``: growth of the gap (m) as a function of frequency in rad/s; ``wear`` persists in the downward sweep.
    "both" goes up, then down again from where the way up ended.
    """
    if direction not in ("up", "down", "both"):
        raise ValueError(f"direction: {direction!r} is none of 'up', 'down', 'both'")
    given = np.atleast_1d(floats("omega", omega))
    drives = _amplitudes(amplitude, given)
    order = np.argsort(given, kind="stable") if given.ndim == 1 else np.arange(len(given))
    legs = {"up": [order], "down": [order[::-1]], "both": [order, order[::-1]]}[direction]
    found: list[FrequencyResponse] = []
    for leg in legs:
        blocks = list(
            march(
                system, given[leg], drives if drives.ndim == 0 else drives[leg], settle=settle, hold=hold,
                solver=solver, output=output, state=state, block=len(leg), options=options,
                drift=None if drift is None else drift(given[leg]), wear=wear,
                struck=sum(int(response.impacts.sum()) for response in found),
            )
        )  # fmt: skip
        found.append(join([response for response, _ in blocks]))
        state = blocks[-1][1]
    return found[0] if len(found) == 1 else Branches(found[0], found[1])
