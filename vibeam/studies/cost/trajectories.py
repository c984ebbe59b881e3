"""Two motions from the same start, compared as motions with impacts must be: an impact that comes a little later is a
small error, though the velocities between the two instants differ by all of the jump.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.equilibrium import equilibrium
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

APART = 0.1  # share of a drive period by which an impact may be shifted and still match
GRID = 200  # vertices a drive period of an exact path
VERTICES = 4000  # vertices of a longer path that are compared, besides its impacts


@dataclass(frozen=True)
class ComparedPath:
    """Motion of the output: ``at`` gives displacements (m,) at times (m,); ``times`` (k,): samples, s.

    ``impact_velocities``: contact velocities just before the impacts, m/s.
    """

    at: Callable[[Array], Array]
    times: Array
    impact_times: Array
    impact_velocities: Array
    evaluations: int = 0


def released(system: ImpactSystem, size: float) -> State:
    """Initial state of every path: at rest, the first mode deflected until the contact is ``size`` m off the stop.

    It is the same for any number of modes.
    """
    start = equilibrium(system)
    displacement = start.displacement.copy()
    displacement[0] -= size / system.contact[0]
    return State(displacement, np.zeros(system.size))


def path_of(runner: Any, motion: str, drive: Drive, state: State, end: float, output: str) -> ComparedPath | None:
    """Path from ``state`` until ``end`` s by a solver with a ``motion`` as declared; None where it keeps none."""
    if motion == "samples":
        return _sampled(runner.motion(drive, state, 0.0, end), output)
    return _exact(runner, drive, state, end, output) if motion == "exact" else None


def _exact(runner: Any, drive: Drive, state: State, end: float, output: str) -> ComparedPath:
    from vibeam.flight.trajectory import Trajectory

    ended, last, after, segments, stats = runner.simulate(drive, state, 0.0, end, runner.limit)
    found = Trajectory(runner.system, drive, 0.0, last, after, ended, stats, runner, segments)
    grid = np.linspace(0.0, last, max(2, round(GRID * last * drive.omega / (2 * np.pi)) + 1))
    times = np.union1d(grid, found.impact_times[found.impact_times <= last])
    impacts = found.impact_times, found.impact_velocities
    return ComparedPath(lambda t: found.at(np.clip(t, 0.0, last), output), times, *impacts, int(stats["evaluations"]))


def _sampled(motion: Any, output: str) -> ComparedPath:
    """Path between samples, by the cubic through values and slopes."""
    from vibeam.solvers.integration.samples import between

    values, slopes = motion.displacement(output), motion.velocity(output)
    return ComparedPath(
        lambda t: between(motion.times, values, slopes, t)[0], np.unique(motion.times), motion.impact_times,
        motion.impact_velocities, int(motion.stats["evaluations"]),
    )  # fmt: skip


def velocity_error(
    times: Array, velocities: Array, true_times: Array, true_velocities: Array, tolerance: float
) -> float:
    """Largest difference in velocity (m/s) of impacts and true ones: mutually nearest pairs ``tolerance`` s apart.

    NaN without such a pair. An impact that has none in the other motion shows in the path.
    """
    if not len(times) or not len(true_times):
        return float("nan")
    nearest, back = _nearest(times, true_times), _nearest(true_times, times)
    mine = np.flatnonzero((back[nearest] == np.arange(len(times))) & (np.abs(times - true_times[nearest]) <= tolerance))
    wrong = np.abs(velocities[mine] - true_velocities[nearest[mine]])
    return float(wrong.max()) if len(mine) else float("nan")


def _nearest(of: Array, among: Array) -> NDArray[np.int64]:
    right = np.clip(np.searchsorted(among, of), 0, len(among) - 1)
    left = np.maximum(right - 1, 0)
    return np.asarray(np.where(np.abs(among[left] - of) <= np.abs(among[right] - of), left, right))


def hausdorff(one: Array, other: Array) -> float:
    """Hausdorff distance of two polylines (m, 2) over ascending first coordinates, taken at their vertices."""
    return max(_directed(one, other), _directed(other, one))


def _directed(vertices: Array, line: Array) -> float:
    """Distance of the vertex farthest from ``line``.

    The distance straight up or down bounds that of each vertex, and the stretch of the line in which to look for a
    nearer point; vertices with bounds below the largest distance found need no look.
    """
    level = np.interp(vertices[:, 0], line[:, 0], line[:, 1])
    over = np.maximum(line[0, 0] - vertices[:, 0], vertices[:, 0] - line[-1, 0]).clip(0.0)
    bound = np.hypot(vertices[:, 1] - level, over)
    worst = 0.0
    for i in np.argsort(-bound):
        if bound[i] <= worst:
            break
        first, last = np.searchsorted(line[:, 0], vertices[i, 0] + np.array([-bound[i], bound[i]]))
        near = line[max(first - 1, 0) : last + 1]
        worst = max(worst, min(float(bound[i]), _to_line(vertices[i], near)))
    return worst


def _to_line(point: Array, line: Array) -> float:
    start, along = line[:-1], np.diff(line, axis=0)
    length = np.sum(along**2, axis=1)
    share = np.sum((point - start) * along, axis=1) / np.where(length > 0, length, 1.0)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * along
    return float(np.min(np.hypot(*(point - nearest).T), initial=np.inf))


def distance(path: ComparedPath, truth: ComparedPath, period: float, size: float) -> float:
    """Hausdorff distance of the graphs (t, u), with times in periods and displacements in ``size`` m."""
    end = min(path.times[-1], truth.times[-1])
    sampled = np.union1d(path.times, truth.times)
    impacts = np.concatenate([path.impact_times, truth.impact_times])
    times = np.union1d(sampled[:: 1 + len(sampled) // VERTICES], impacts)
    times = times[(times >= 0) & (times <= end)]
    return hausdorff(*(np.stack([times / period, each.at(times) / size], axis=1) for each in (path, truth)))
