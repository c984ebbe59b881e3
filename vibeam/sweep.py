"""THE sweep: any system, any solver, any grid; the same call for every fidelity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.response import Branches, FrequencyResponse
from vibeam.solvers import solver as solver_named
from vibeam.state import State
from vibeam.system import ImpactSystem

Array = NDArray[np.float64]
Direction = Literal["up", "down", "both"]


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
) -> Iterator[tuple[FrequencyResponse, State]]:
    """Steady points in the order of ``omega`` (rad/s), ``block`` at a time, each with the state after it.

    The state is carried from point to point (displacement and velocity relative to the base; the drive's phase starts
    at 0 at every point); ``state`` None: static equilibrium. ``amplitude``: of the base, m, one number or one for each
    frequency (they then come one at a time, whatever ``block`` is). ``slowest``: the lowest frequency of the whole
    sweep, where ``omega`` is only what is left of it: numbers are then the same to the bit.
    ``options``: the solver's own. A point that fails is NaN with its reason, and the next one starts from equilibrium.
    ValueError for a grid, periods or solver that make no sense, KeyError for an unknown output.
    """
    grid = np.atleast_1d(np.asarray(omega, dtype=float))
    if grid.ndim != 1 or not len(grid) or not np.all(np.isfinite(grid) & (grid > 0)):
        raise ValueError("omega: must be one or more positive frequencies in rad/s")
    if settle < 0 or hold < 1 or block < 1:
        raise ValueError(f"settle {settle} must be ≥ 0, hold {hold} and block {block} ≥ 1")
    drives = _amplitudes(amplitude, grid)
    system.output(output)
    runner = solver_named(solver, system, float(grid.min()) if slowest is None else slowest, **(options or {}))
    step = block if drives.ndim == 0 else 1
    for first in range(0, len(grid), step):
        drive = float(drives if drives.ndim == 0 else drives[first])
        response, state = runner.steady(grid[first : first + step], drive, state, settle, hold, output)
        yield response, state


def _amplitudes(amplitude: ArrayLike, grid: Array) -> Array:
    """One number, or one for each frequency; ValueError for anything else."""
    drives = np.asarray(amplitude, dtype=float)
    if drives.shape not in ((), grid.shape):
        raise ValueError(f"amplitude: must be one number or one for each of the {len(grid)} frequencies")
    if not np.all(np.isfinite(drives)):
        raise ValueError(f"amplitude: {drives} is not finite")
    return drives


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
) -> FrequencyResponse | Branches:
    """The frequency-response curve over ``omega`` (rad/s), in the order swept, or Branches(up, down) for "both".

    Arguments and errors as in ``march``; amplitudes that are one for each frequency are in the order of ``omega``.
    "both" goes up, then down again from where the way up ended.
    """
    if direction not in ("up", "down", "both"):
        raise ValueError(f"direction: {direction!r} is none of 'up', 'down', 'both'")
    given = np.atleast_1d(np.asarray(omega, dtype=float))
    drives = _amplitudes(amplitude, given)
    order = np.argsort(given, kind="stable") if given.ndim == 1 else np.arange(len(given))
    legs = {"up": [order], "down": [order[::-1]], "both": [order, order[::-1]]}[direction]
    found = []
    for leg in legs:
        blocks = list(
            march(
                system, given[leg], drives if drives.ndim == 0 else drives[leg], settle=settle, hold=hold,
                solver=solver, output=output, state=state, block=len(leg), options=options,
            )
        )  # fmt: skip
        found.append(join([response for response, _ in blocks]))
        state = blocks[-1][1]
    return found[0] if len(found) == 1 else Branches(found[0], found[1])


def join(parts: list[FrequencyResponse]) -> FrequencyResponse:
    """Consecutive points as one response."""
    values = {f.name: np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(FrequencyResponse)}
    return FrequencyResponse(**values)
