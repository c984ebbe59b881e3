"""Frequency sweep of any system by any solver over any grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import isfinite
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from vibeam.solvers import SOLVERS, require_readable
from vibeam.solvers import solver as solver_named
from vibeam.solvers.steady import warm_up_once
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Branches, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arguments import count, floats, number, refuse, require
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.solvers.several_harmonics import Shares


Direction = Literal["up", "down", "both"]
LONGEST = 10**9  # largest number of drive periods to settle a point: at 0.2 µs each, minutes
BLOCK, MOST = 0.05, 16  # seconds and largest number of points of a block: what a run that is killed may lose
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
    harmonics: Shares = (),
) -> Iterator[tuple[FrequencyResponse, State]]:
    """Steady points in the order of ``omega`` (rad/s), ``block`` at a time, each with the state after it.

    The state is carried from point to point (displacement and velocity relative to the base; the drive's phase starts
    at 0 at every point); ``state`` None: static equilibrium. ``amplitude``: of the base, m, one number or one for each
    frequency. ``slowest``: the lowest frequency of the whole sweep, where ``omega`` is only its rest: numbers are then
    the same to the bit.
    ``options``: the solver's own. ``drift`` (points,): growth of the gap at each point, m. ``wear``: growth of the
    gap by each impact, for the points after it, m, settling included; ``struck`` impacts came before the first.
    A point that fails is NaN with its reason, and the next one starts from equilibrium.
    ``harmonics``: further ones of the drive, each (order, share of the first's Ω²B, phase in rad).
    ``settle`` is at most 10⁹, ``hold`` at most 10⁸ over the number of modes. ValueError for a grid, periods, solver or
    type of argument that makes no sense, or an output that the solver does not read; KeyError for an unknown output.
    """
    for response, states in march_blocks(
        system, omega, amplitude, settle=settle, hold=hold, solver=solver, output=output, state=state, block=block,
        slowest=slowest, options=options, drift=drift, wear=wear, struck=struck, harmonics=harmonics,
    ):  # fmt: skip
        yield response, states[-1]


def march_blocks(
    system: ImpactSystem, omega: ArrayLike, amplitude: ArrayLike, *, settle: int, hold: int, solver: str, output: str,
    state: State | None, block: int | None = None, slowest: float | None = None,
    options: Mapping[str, Any] | None = None, drift: ArrayLike | None = None, wear: float | None = None,
    struck: int = 0, harmonics: Shares = (),
) -> Iterator[tuple[FrequencyResponse, list[State]]]:  # fmt: skip
    """As ``march``, with the states after the last points of each block, as many as are known.

    ``block`` None: as many points as take about ``BLOCK`` seconds, with the states after all of them.
    """
    require("system", system, ImpactSystem)
    require("state", state, State, none_too=True)
    grid = np.atleast_1d(floats("omega", omega))
    if grid.ndim != 1 or not len(grid) or not ((least := float(grid.min())) > 0 and grid.max() < np.inf):
        raise ValueError("omega: must be one or more positive frequencies in rad/s")
    settle, hold, size, struck = _counts(system, settle, hold, 1 if block is None else block, struck)
    drives = _amplitudes(amplitude, grid)
    require_readable(solver, system, output)
    rate = least if slowest is None else slowest
    warm_up_once(solver, system, float(grid[0]), float(drives.flat[0]), output, options or {})
    further = tuple(harmonics)
    if drift is not None or wear is not None or further:
        drives, changes = np.broadcast_to(drives, grid.shape), _gap_changes(grid, drift, wear, struck, solver)
        for response, after in _drifting(
            system, grid, drives, settle, hold, solver, output, state, rate, options or {}, changes, further
        ):
            yield response, [after]
        return
    runner, blocks = solver_named(solver, system, rate, **(options or {})), SOLVERS[solver].blocks
    size = 1 if drives.ndim and not blocks else size
    first = 0
    while first < len(grid):
        points, states, begun = slice(first, first + size), list[State](), monotonic()
        drive = drives[points] if drives.ndim and blocks else float(drives if drives.ndim == 0 else drives[first])
        response, state = runner.steady(
            grid[points], drive, state, settle, hold, output, **({"states": states} if blocks else {})
        )
        yield response, states or [state]
        first += size
        size = _next_size(size, monotonic() - begun) if block is None and blocks else size


def _next_size(size: int, seconds: float) -> int:
    """Number of points of the next block, after one of ``size`` points that took ``seconds``."""
    if seconds > BLOCK:
        return max(1, size // 2)
    return min(MOST, 2 * size) if seconds < BLOCK / 2 else size


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
    if drives.ndim == 0 and isfinite(drives):
        return drives
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
    state: State | None, rate: float, options: Mapping[str, Any], changes: _GapChanges, harmonics: Shares,
) -> Iterator[tuple[FrequencyResponse, State]]:  # fmt: skip
    """Sweep point by point, each with its own gap and harmonics; a state beyond the stop is put back onto it."""
    struck = changes.struck
    for omega, drive, more in zip(grid, drives, changes.drift, strict=True):
        moved = replace(system, gap=system.gap + float(more) + changes.wear * struck)
        start = None if state is None else _onto_stop(moved, state)
        if harmonics:
            from vibeam.solvers.harmonic_point import several_of, steady_point

            several = several_of(moved, Drive(float(omega), float(drive)), harmonics, solver)
            response, state = steady_point(
                several, start, settle, hold, solver_name=solver, output=output, slowest=rate, options=options
            )
        else:
            response, state = solver_named(solver, moved, rate, **options).steady(
                np.array([omega]), float(drive), start, settle, hold, output
            )
        struck += int(response.impacts[0])
        yield response, state


def _onto_stop(system: ImpactSystem, state: State) -> State:
    """State admissible to a hard stop; one that rested on the stop before it moved moves along."""
    if system.contact_law.yields:
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
    harmonics: Shares = (),
) -> FrequencyResponse | Branches:
    """Sweep over ``omega`` (rad/s): the frequency-response curve in the order swept, or Branches(up, down) for "both".

    Arguments and errors as in ``march``; amplitudes that are one for each frequency are in the order of ``omega``.
    ``drift``: growth of the gap (m) as a function of frequency in rad/s; ``wear`` persists in the downward sweep.
    "both" goes up, then down again from where the way up ended.
    """
    if direction not in ("up", "down", "both"):
        raise ValueError(f"direction: {direction!r} is none of 'up', 'down', 'both'")
    given, further = np.atleast_1d(floats("omega", omega)), tuple(harmonics)
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
                struck=sum(int(response.impacts.sum()) for response in found), harmonics=further,
            )
        )  # fmt: skip
        found.append(join([response for response, _ in blocks]))
        state = blocks[-1][1]
    return found[0] if len(found) == 1 else Branches(found[0], found[1])
