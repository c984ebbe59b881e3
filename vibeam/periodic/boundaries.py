"""Bifurcations and ends of branches of periodic motions, along frequency, amplitude or gap.

They are bracketed along one parameter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from vibeam.periodic.bifurcation_functions import NAMES, DrivePerLevel, Kind, Line, MotionsAt, test_function
from vibeam.periodic.modal_sums import checked
from vibeam.periodic.multipliers import multipliers
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, Complex, ValueRecord

Range = float | tuple[float, float]
Found = tuple[float, Kind, int]
ENDS = (Kind.FOLD, Kind.GRAZING)
CLOSED = (Kind.FOLD, Kind.GRAZING, Kind.TOUCHING, Kind.PLUS_ONE, Kind.DOUBLING, Kind.NEIMARK_SACKER)
BRANCHES = {kind: (0,) if kind is Kind.FOLD else (0, 1) for kind in CLOSED}
TOUCH = 1e-9  # share of the motion's size by which the contact may pass the gap
JUMP = 1e-4  # a sign change whose value stays above this share of its neighbours' is a jump or a pole, no root
TOWARD_END = 10.0 ** -np.arange(0.5, 10.5, 0.5)  # grid refinements where a branch ends within a step


@dataclass(frozen=True, eq=False, repr=False)
class Boundary(ValueRecord):
    """One boundary of a branch. SI units.

    ``parameter``: the one it was located in, to round-off; ``branch``: 0 is the root with the harder impact, 1 the
    other. ``clear``: it keeps clear of the stop between its impacts, proved by bounds: only then is it the boundary of
    a motion. ``multipliers`` are empty and ``velocity`` is 0 at GRAZING.
    """

    kind: Kind
    parameter: str
    omega: float
    amplitude: float
    gap: float
    periods: int
    branch: int
    phase: float
    velocity: float
    multipliers: Complex
    clear: bool


def boundaries(
    system: ImpactSystem,
    amplitude: Range,
    omega: Range,
    periods: int = 1,
    *,
    gap: Range | None = None,
    points: int = 501,
    kinds: tuple[Kind, ...] = CLOSED,
    per_level: DrivePerLevel | None = None,
) -> tuple[Boundary, ...]:
    """Find all boundaries of both branches in a range of one parameter, in ascending order.

    Exactly one of ``omega`` (rad/s), ``amplitude`` (m) and ``gap`` (m; None: the system's) is a pair (from, to).
    ``per_level``: amplitude of the drive at level 1, a function of ``omega`` (points,), as of a constant acceleration;
    ``amplitude`` is then the level, and held. The range is looked at in ``points`` places, closer where a branch ends;
    each sign change is then bracketed down to round-off on the exact expressions, and an exact zero at a place is a
    boundary too. Two boundaries of one kind within one step are missed. ValueError where none or several of the three
    are ranges, and as in ``orbits``.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> [found.kind.name for found in vibeam.boundaries(system, 0.1, (1.2, 3.0)) if found.clear]
    ['DOUBLING']
    """
    given = {"omega": omega, "amplitude": amplitude, "gap": system.gap if gap is None else gap}
    line, low, high = _line(system, given, periods, per_level)
    grid, found = np.linspace(low, high, points), list[Found]()
    for group in (Kind.FOLD,), (Kind.GRAZING,), tuple(kind for kind in kinds if kind not in ENDS):
        new = [each for kind in group for branch in BRANCHES[kind] for each in crossings(line, kind, branch, grid)]
        grid, found = _refined(grid, high - low, [value for value, _, _ in new]), found + new
    known = [boundary(line, kind, branch, value) for value, kind, branch in found if kind in kinds]
    axis = line.name
    return tuple(sorted((b for b in known if b is not None), key=lambda b: float(getattr(b, axis))))


def crossings(line: Line, kind: Kind, branch: int, grid: Array) -> list[Found]:
    """Parameter values on ``grid`` at which the branch's test function passes through zero."""
    with np.errstate(invalid="ignore", over="ignore"):
        points = line.at(grid)
        values = np.where(points.amplitude != 0, test_function(line.system, kind, branch, points), np.nan)
        steps = np.flatnonzero(values[:-1] * values[1:] < 0)
    found = [bracketed(line, kind, branch, grid[i], grid[i + 1]) for i in steps]
    between = [value for value in found if value is not None]
    return [(value, kind, branch) for value in [*between, *grid[on_nodes(values)].tolist()]]


def on_nodes(values: Array) -> NDArray[np.int64]:
    """Nodes of a grid at which a test function, given there, is exactly zero and passes through it, or ends.

    None where it only touches zero, or is zero on neighbours too: of no damping and R = 1 some are zero all along.
    """
    zero, sign = values == 0, np.sign(values)
    before, after = np.append(np.nan, sign[:-1]), np.append(sign[1:], np.nan)
    known = np.isfinite(before) | np.isfinite(after)
    return np.flatnonzero(zero & known & (before != 0) & (after != 0) & (before != after))


def bracketed(line: Line, kind: Kind, branch: int, low: float, high: float) -> float | None:
    """Root between two parameter values, to round-off; None where the sign changes by a jump or a pole."""

    def test(value: float) -> float:
        return float(test_function(line.system, kind, branch, line.at(np.array([value])))[0])

    first, last = test(low), test(high)
    if not first * last < 0:
        return None
    root = brentq(test, low, high, xtol=1e-300, rtol=4 * np.finfo(float).eps, disp=False)
    return float(root) if abs(test(root)) <= JUMP * max(abs(first), abs(last)) else None


def boundary(line: Line, kind: Kind, branch: int, value: float) -> Boundary | None:
    """Boundary at a parameter value; None for a fold of motions that would pull at the stop."""
    points = _motions_at_fold(line, value) if kind is Kind.FOLD else line.at(np.array([value]))
    total, found = points.total, points.roots
    impulse, phase, velocity = (float(row[0, branch]) for row in (found.impulse, found.phase, found.velocity))
    if kind is Kind.FOLD and not impulse < 0:
        return None
    grazing = kind is Kind.GRAZING
    values = (
        np.zeros(0, dtype=complex)
        if grazing
        else multipliers(line.system, total.span, found.relative_acceleration[:, branch])[0]
    )
    place = {name: float(row[0]) for name, row in zip(NAMES, (total.omega, points.amplitude, points.gap), strict=True)}
    return Boundary(
        kind, line.name, **(place | {line.name: value}), periods=line.periods, branch=branch,
        phase=phase, velocity=0.0 if grazing else velocity, multipliers=values,
        clear=_clear(line, kind, branch, points),
    )  # fmt: skip


def _clear(line: Line, kind: Kind, branch: int, points: MotionsAt) -> bool:
    """Test whether the motion clears the stop; a grazing motion must hang clear under static forces alone."""
    if kind is Kind.GRAZING:
        return bool(points.gap[0] > points.total.offset)
    return bool(test_function(line.system, Kind.TOUCHING, branch, points)[0] > -TOUCH)


def _motions_at_fold(line: Line, value: float) -> MotionsAt:
    """Motions at a fold, or as near to it as round-off leaves both real."""
    nudges = [side * 2.0**k * np.finfo(float).eps for k in range(1, 30) for side in (1, -1)]
    for nudge in (0.0, *nudges):
        points = line.at(np.array([value * (1 + nudge)]))
        if np.isfinite(points.roots.impulse[0, 0]):
            break
    return points


def _refined(grid: Array, width: float, ends: list[float]) -> Array:
    """Grid refined towards every end from both sides."""
    near = [end + sign * width / 100 * TOWARD_END for end in ends for sign in (1, -1)]
    whole = np.unique(np.concatenate([grid, *near]))
    return np.asarray(whole[(whole >= grid[0]) & (whole <= grid[-1])])


def _line(
    system: ImpactSystem, given: dict[str, Range], periods: int, per_level: DrivePerLevel | None
) -> tuple[Line, float, float]:
    ranges = [name for name, value in given.items() if isinstance(value, tuple)]
    if len(ranges) != 1:
        raise ValueError(f"omega, amplitude, gap: exactly one must be a pair (from, to), not {len(ranges)}")
    low, high = (float(v) for v in given[ranges[0]])  # type: ignore[union-attr]
    if not low < high:
        raise ValueError(f"{ranges[0]}: the range must ascend, not go from {low} to {high}")
    if per_level is not None and ranges[0] == "amplitude":
        raise ValueError("per_level: the level of the drive is held: give a range of omega or gap")
    held = {name: low if name == ranges[0] else float(value) for name, value in given.items()}  # type: ignore[arg-type]
    checked(system, held["omega"], periods)
    place = held["omega"], held["amplitude"], held["gap"]
    return Line(system, int(periods), ranges[0], *place, per_level), low, high
