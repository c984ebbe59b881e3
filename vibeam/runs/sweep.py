"""Frequency sweep of any system by any solver over any grid."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.solvers import SOLVERS, require_readable
from vibeam.solvers import solver as solver_named
from vibeam.solvers.steady import SteadySolver, warm_up_once
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Branches, FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arguments import count, floats, number, refuse, require
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.system.several_harmonics import Shares


Direction = Literal["up", "down", "both"]
LONGEST = 10**9  # largest number of drive periods to settle a point: at 0.2 µs each, minutes
BLOCK, MOST = 0.05, 64  # seconds and largest number of points of a block: what a run that is killed may lose
HELD = 10**8  # largest number of modal states, one a drive period, held for a point: 1.6 GB


@dataclass(frozen=True)
class SweepSettings:
    """Settings of every point of a sweep: ``settle`` and ``hold`` in drive periods, the solver and its ``options``.

    ``output`` is what is read; ``wear``: growth of the gap by each impact, for the points after it, m, settling
    included; ``harmonics``: further ones of the drive, each (order, share of the first's Ω²B, phase in rad).
    """

    settle: int = 200
    hold: int = 50
    solver: str = "flight"
    output: str = "contact"
    options: Mapping[str, Any] | None = None
    wear: float | None = None
    harmonics: Shares = ()

    def checked(self, system: ImpactSystem) -> SweepSettings:
        """Settings that make sense for a system; ValueError with every fault, KeyError for an unknown output.

        ``settle`` is at most 10⁹, ``hold`` at most 10⁸ over the number of modes.
        """
        require("system", system, ImpactSystem)
        faults: list[str] = []
        settle = count("settle", self.settle, faults, most=LONGEST)
        hold = count("hold", self.hold, faults, least=1, most=HELD // system.size)
        worn = None if self.wear is None else number("wear", self.wear, faults, least=0.0)
        refuse("", faults)
        require_readable(self.solver, system, self.output)
        if worn is not None and self.solver in SOLVERS and SOLVERS[self.solver].stationary:
            said = f"solver {self.solver!r} counts no impacts on the way to a steady motion: 'flight' does"
            raise ValueError(f"wear: {said}")
        harmonics, options = tuple(self.harmonics), self.options or {}
        return replace(self, settle=settle, hold=hold, wear=worn, options=options, harmonics=harmonics)


@dataclass(frozen=True, eq=False)
class SweepPoints:
    """Points in the order swept: ``omega`` (points,) rad/s, ``amplitude`` of the base, m, one or (points,).

    ``drift`` (points,): growth of the gap, m. ``slowest``: the lowest frequency of the whole sweep, where these are
    only its rest: numbers are then the same to the bit.
    """

    omega: Array
    amplitude: Array
    slowest: float
    drift: Array | None = None

    @classmethod
    def of(
        cls, omega: ArrayLike, amplitude: ArrayLike, slowest: float | None = None, drift: ArrayLike | None = None
    ) -> SweepPoints:
        """Points by numbers of any kind; ValueError for those that make no sense."""
        grid = np.atleast_1d(floats("omega", omega))
        if grid.ndim != 1 or not len(grid) or not ((least := float(grid.min())) > 0 and grid.max() < np.inf):
            raise ValueError("omega: must be one or more positive frequencies in rad/s")
        added = None if drift is None else floats("drift", drift)
        if added is not None and (added.shape != grid.shape or not np.all(np.isfinite(added))):
            raise ValueError(f"drift: must be {len(grid)} finite numbers, one a frequency")
        return cls(grid, _amplitudes(amplitude, grid), least if slowest is None else slowest, added)

    def at(self, leg: NDArray[np.int64]) -> SweepPoints:
        """Some of the points, in another order."""
        amplitude = self.amplitude if self.amplitude.ndim == 0 else self.amplitude[leg]
        return replace(
            self, omega=self.omega[leg], amplitude=amplitude, drift=None if self.drift is None else self.drift[leg]
        )


def _amplitudes(amplitude: ArrayLike, grid: Array) -> Array:
    """Return one number, or one for each frequency; ValueError for anything else."""
    drives = floats("amplitude", amplitude)
    if drives.shape not in ((), grid.shape):
        raise ValueError(f"amplitude: must be one number or one for each of the {len(grid)} frequencies")
    if not np.all(np.isfinite(drives)):
        raise ValueError(f"amplitude: {drives} is not finite")
    return drives


Block = tuple[FrequencyResponse, list[State]]


def march(
    system: ImpactSystem, omega: ArrayLike, amplitude: ArrayLike, *, state: State | None = None, block: int = 1,
    slowest: float | None = None, drift: ArrayLike | None = None, **settings: Any,
) -> Iterator[tuple[FrequencyResponse, State]]:  # fmt: skip
    """Steady points in the order of ``omega`` (rad/s), ``block`` at a time, each with the state after it.

    The state is carried from point to point (displacement and velocity relative to the base; the drive's phase starts
    at 0 at every point); ``state`` None: static equilibrium. ``amplitude``, ``slowest``, ``drift`` as in
    ``SweepPoints``, ``settings`` those of ``SweepSettings``. A point that fails is NaN with its reason, and the next
    one starts from equilibrium. ValueError for a grid, periods, solver or type of argument that makes no sense, or an
    output that the solver does not read; KeyError for an unknown output.
    """
    made, points = SweepSettings(**settings).checked(system), SweepPoints.of(omega, amplitude, slowest, drift)
    require("state", state, State, none_too=True)
    faults: list[str] = []
    size = count("block", block, faults, least=1)
    refuse("", faults)
    for response, states in march_blocks(system, points, made, state, block=size):
        yield response, states[-1]


def march_blocks(
    system: ImpactSystem, points: SweepPoints, settings: SweepSettings, state: State | None = None, struck: int = 0,
    block: int | None = None,
) -> Iterator[Block]:  # fmt: skip
    """Blocks of steady points, with the states after the last points of each, as many as are known; all is checked.

    ``struck``: impacts before the first point, by which the gap is worn. ``block`` None: as many points as take about
    ``BLOCK`` seconds, with the states after all of them.
    """
    first = float(points.omega[0]), float(points.amplitude.flat[0])
    warm_up_once(settings.solver, system, *first, settings.output, settings.options or {})
    if points.drift is not None or settings.wear is not None or settings.harmonics:
        yield from _one_by_one(system, points, settings, state, struck)
    else:
        yield from _side_by_side(system, points, settings, state, block)


def _side_by_side(
    system: ImpactSystem, points: SweepPoints, settings: SweepSettings, state: State | None, block: int | None
) -> Iterator[Block]:
    """Blocks of points of one system."""
    runner = solver_named(settings.solver, system, points.slowest, **(settings.options or {}))
    blocks, drives = SOLVERS[settings.solver].blocks, points.amplitude
    size = 1 if block is None or (drives.ndim and not blocks) else block
    first = 0
    while first < len(points.omega):
        here, states, begun = slice(first, first + size), list[State](), monotonic()
        drive = drives[here] if drives.ndim and blocks else float(drives if drives.ndim == 0 else drives[first])
        response, state = runner.steady(
            points.omega[here], drive, state, settings.settle, settings.hold, settings.output,
            **({"states": states} if blocks else {}),
        )  # fmt: skip
        yield response, states or [state]
        first += size
        size = _next_size(size, monotonic() - begun) if block is None and blocks else size


def _next_size(size: int, seconds: float) -> int:
    """Number of points of the next block, after one of ``size`` points that took ``seconds``."""
    if seconds > BLOCK:
        return max(1, size // 2)
    return min(MOST, 2 * size) if seconds < BLOCK / 2 else size


def _one_by_one(
    system: ImpactSystem, points: SweepPoints, settings: SweepSettings, state: State | None, struck: int
) -> Iterator[Block]:
    """Points each with its own gap and harmonics; a state beyond the stop is put back onto it."""
    drift = np.zeros(len(points.omega)) if points.drift is None else points.drift
    drives = np.broadcast_to(points.amplitude, points.omega.shape)
    for omega, drive, more in zip(points.omega, drives, drift, strict=True):
        moved = replace(system, gap=system.gap + float(more) + (settings.wear or 0.0) * struck)
        start = None if state is None else _onto_stop(moved, state)
        response, state = _point(moved, Drive(float(omega), float(drive)), settings, start, points.slowest)
        struck += int(response.impacts[0])
        yield response, [state]


def _point(
    system: ImpactSystem, drive: Drive, settings: SweepSettings, state: State | None, slowest: float
) -> tuple[FrequencyResponse, State]:
    """One point, under one harmonic or several."""
    name, options, periods = settings.solver, settings.options or {}, (settings.settle, settings.hold)
    if not settings.harmonics:
        runner: SteadySolver = solver_named(name, system, slowest, **options)
        return runner.steady(np.array([drive.omega]), drive.amplitude, state, *periods, settings.output)
    from vibeam.solvers.harmonic_point import several_of, steady_point

    several = several_of(system, drive, settings.harmonics, name)
    return steady_point(
        several, state, *periods, solver_name=name, output=settings.output, slowest=slowest, options=options
    )


def _onto_stop(system: ImpactSystem, state: State) -> State:
    """State admissible to a hard stop; one that rested on the stop before it moved moves along."""
    if system.contact_law.yields:
        return state
    beyond = float(system.contact @ state.displacement) - system.gap
    if beyond <= 0 and not state.resting:
        return state
    back = system.contact * (beyond / system.mobility)
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

    Settings and errors as in ``march``; amplitudes that are one for each frequency are in the order of ``omega``.
    ``drift``: growth of the gap (m) as a function of frequency in rad/s; ``wear`` persists in the downward sweep.
    "both" goes up, then down again from where the way up ended.

    >>> import vibeam
    >>> free = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=9.0)
    >>> up = vibeam.sweep(free, omega=[0.5, 1.0], amplitude=0.1, settle=60, hold=2)
    >>> up.amplitude.round(6).tolist()  # Ω²B/|1 − Ω² + 0.1iΩ|
    [0.03326, 1.0]
    """
    if direction not in ("up", "down", "both"):
        raise ValueError(f"direction: {direction!r} is none of 'up', 'down', 'both'")
    settings = SweepSettings(settle, hold, solver, output, options, wear, harmonics).checked(system)
    points = SweepPoints.of(omega, amplitude)
    require("state", state, State, none_too=True)
    order = np.argsort(points.omega, kind="stable")
    found: list[FrequencyResponse] = []
    for leg in {"up": [order], "down": [order[::-1]], "both": [order, order[::-1]]}[direction]:
        part = points.at(leg)
        part = part if drift is None else SweepPoints.of(part.omega, part.amplitude, drift=drift(part.omega))
        struck = sum(int(response.impacts.sum()) for response in found)
        blocks = list(march_blocks(system, part, settings, state, struck, block=len(leg)))
        found.append(join([response for response, _ in blocks]))
        state = blocks[-1][1][-1]
    return found[0] if len(found) == 1 else Branches(found[0], found[1])
