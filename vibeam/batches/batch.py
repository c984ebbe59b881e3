"""Batch of steady points: arrays of systems, drives and starts in, arrays of results out.

Plain systems go task by task by the compiled kernels alone, any other point by the solver that a sweep takes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vibeam.batches.points import BatchPoints, Systems, plain_points, points_of
from vibeam.batches.response import BatchPlan, BatchRecord
from vibeam.flight.engine.threads import pause
from vibeam.flight.kernels.layout import ELASTIC, PANEL
from vibeam.flight.points.points import SIDE_BY_SIDE, PointSettings, compute
from vibeam.runs.parallel import run_parallel
from vibeam.runs.sweep import HELD, LONGEST
from vibeam.solvers import solver
from vibeam.solvers.steady import warm_up_once
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.quantities import Ended
from vibeam.system.state import State
from vibeam_models.arguments import count, refuse
from vibeam_models.arrays import Array, Flags, Index

if TYPE_CHECKING:
    from collections.abc import Callable
    from threading import Event

    from vibeam.batches.response import BatchResponse

ALONE = 64  # points of one task of a thread, where each goes by itself
MOST, LEAST = 4096, 256  # points of one compiled task at most, and at least where there are as many
SHARED = 100_000  # drive periods of points, times modes: what is less takes some 5 ms, too little for two threads


def batch(
    systems: Systems,
    omega: ArrayLike,
    amplitude: ArrayLike,
    *,
    gap: ArrayLike | None = None,
    restitution: ArrayLike | None = None,
    damping: ArrayLike | None = None,
    state: ArrayLike | BatchResponse | None = None,
    settle: int = 200,
    hold: int = 50,
    output: str | None = None,
    strobes: int = 0,
    lyapunov: int = 0,
    lanes: bool = True,
    threads: int | None = None,
) -> BatchResponse:
    """Steady points of the exact flow, each on its own, in threads; all arrays broadcast to one shape.

    ``systems``: one ImpactSystem or an array of them, with the same number of modes; ``omega`` rad/s and ``amplitude``
    m of the base motion. ``gap`` (m) and ``restitution`` in place of the systems' own; ``damping``: factor on all
    their damping ratios. ``state``: starts (…, 2n), modal displacements, then velocities, or the BatchResponse that
    ended there; None: static equilibrium. The drive's phase is 0 at the start. ``settle`` and ``hold`` drive periods;
    ``output``: None for the contact. ``strobes``: how many values of the output at the ends of the last periods held
    are kept, at most ``hold``. ``threads``: None for one a core; results are the same to the bit for any number.

    ``lyapunov``: drive periods over which the largest exponent of a motion that does not repeat is a mean, at least
    20, after 50 in which a disturbance turns into its direction; of one that does it is that of its multipliers
    (``vibeam.lyapunov``). 0: it is not computed.

    ``lanes``: points of plain systems with at most eight modes fly side by side in the processor's lanes; they are
    those of ``vibeam.sweep`` at one frequency to round-off, so that chaotic motions differ. False, and any other
    system: to the bit. A point that fails is NaN with its reason in ``ended``.
    ValueError names every argument that is wrong, KeyError an unknown output.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> found = vibeam.batch(system, omega=[[1.9], [2.0]], amplitude=[0.1, 0.2])  # no gap: motions grow with the drive
    >>> (found.reach[:, 1] / found.reach[:, 0]).round(9).tolist()
    [2.0, 2.0]
    """
    points = points_of(systems, omega, amplitude, gap, restitution, damping, state)
    plan = _plan(points, settle, hold, output, strobes, bool(lanes), lyapunov, threads)
    record, compiled = BatchRecord(len(points.base), points.size, plan.strobes), is_compiled(points, plan.output)
    each = (plan.settle + plan.hold + plan.lyapunov) * points.size
    alone = threads == 1 or len(points.base) * each < SHARED
    least = MOST if alone else max(min(SHARED // each, LEAST), SIDE_BY_SIDE)
    tasks = [(run_task, which) for which in tasks_of(points, np.flatnonzero(compiled), least)]
    tasks += [(run_points, which) for which in _one_by_one(points, np.flatnonzero(~compiled), plan)]

    def task(item: tuple[Callable[..., None], Index], stop: Event) -> None:
        item[0](points, item[1], plan, record)

    if alone or len(tasks) == 1:
        for run, which in tasks:
            run(points, which, plan, record)
    else:
        run_parallel(task, tasks, threads if threads is None else int(threads))
    return record.response(points.shape)


def _one_by_one(points: BatchPoints, which: Index, plan: BatchPlan) -> list[Index]:
    """Points that no kernel takes as a whole, in tasks, those of one system together."""
    for i in np.unique(points.base[which]):
        warm_up_once("flight", points.bases[i], float(points.omega[0]), float(points.amplitude[0]), plan.output, {})
    keys = (points.omega, points.restitution, points.damping, points.gap, points.base)
    which = which[np.lexsort([each[which] for each in keys])]
    return [which[first : first + ALONE] for first in range(0, len(which), ALONE)]


def _plan(
    points: BatchPoints, settle: int, hold: int, output: str | None, strobes: int, lanes: bool, lyapunov: int,
    threads: int | None,
) -> BatchPlan:  # fmt: skip
    faults: list[str] = []
    settle = count("settle", settle, faults, most=LONGEST)
    hold = count("hold", hold, faults, least=1, most=HELD // points.size)
    strobes = count("strobes", strobes, faults, most=hold)
    name = "contact" if output is None else output
    derivatives = [base.derivative(name) for base in points.bases]
    if strobes and any(each is not None and each.order == 2 for each in derivatives):
        faults.append("strobes: an acceleration is not read at the ends of periods: take its displacement or velocity")
    periods = count("lyapunov", lyapunov, faults)
    if threads is not None:
        count("threads", threads, faults, least=1)
    if periods:
        from vibeam.batches.exponents import exponent_faults

        faults += exponent_faults(points, periods)
    refuse("batch", faults)
    return BatchPlan(settle, hold, name, lanes, strobes, periods)


def is_compiled(points: BatchPoints, output: str) -> Flags:
    """Mask of the points that the kernels take: those of plain systems, read as displacements."""
    plain = [not base.beyond_plain and base.derivative(output) is None for base in points.bases]
    return np.array(plain)[points.base]


def tasks_of(points: BatchPoints, which: Index, least: int) -> list[Index]:
    """The points ``which`` in tasks of what is packed alike, neighbours side by side, of ``least`` points or more."""
    level = np.floor(np.log2(PANEL / points.omega[which]))  # of the longest panels: see ``linear.packing.top_level``
    elastic = 1.0 - points.restitution[which] < ELASTIC
    order = np.lexsort((points.omega[which], points.damping[which], points.base[which], level, elastic))
    which, kind = which[order], np.stack([level, elastic])[:, order]
    found = []
    for part in np.split(which, np.flatnonzero(np.any(np.diff(kind), axis=0)) + 1):
        found += _portions(part, least)
    return sorted(found, key=len, reverse=True)


def _portions(part: Index, least: int) -> list[Index]:
    """Large tasks, which cost little beside their points, then smaller ones, so that all threads end about together."""
    found = []
    while len(part):
        size = min(MOST, max(least, len(part) // 3))
        found.append(part[:size])
        part = part[size:]
    return found


def run_task(points: BatchPoints, which: Index, plan: BatchPlan, record: BatchRecord) -> None:
    """Compute the points ``which`` and keep them in ``record``."""
    elastic = bool(1.0 - points.restitution[which[0]] < ELASTIC)
    most = SIDE_BY_SIDE if plan.lanes else 0
    settings = PointSettings(plan.settle, plan.hold, plan.output, plan.strobes, elastic, most)
    for some, results in compute(plain_points(points, which), settings):
        record.fill(which[some], results.response, results.states, results.resting, results.strobes)
    if plan.lyapunov:
        from vibeam.batches.exponents import largest_exponents

        record.exponents[:, which] = largest_exponents(points, which, plan.lyapunov, record)


def run_points(points: BatchPoints, which: Index, plan: BatchPlan, record: BatchRecord) -> None:
    """Compute the points ``which`` and note each in ``record``: what a sweep of one frequency gives, to the bit."""
    made: dict[tuple[float, ...], ImpactSystem] = {}
    for point in which.tolist():
        pause()
        key = (points.base[point], points.gap[point], points.restitution[point], points.damping[point])
        if key not in made:
            made = {key: points.system(point)}
        _run(points, point, made[key], plan, record)


def _run(points: BatchPoints, point: int, system: ImpactSystem, plan: BatchPlan, record: BatchRecord) -> None:
    omega, states, strobes = float(points.omega[point]), list[State](), list[Array]()
    response, after = solver("flight", system, omega).steady(
        np.array([omega]), float(points.amplitude[point]), points.start(point), plan.settle, plan.hold, plan.output,
        states=states, strobes=strobes,
    )  # fmt: skip
    record.note(point, response, after, plan.strobed(system, strobes[0]))
    if plan.lyapunov and response.ended[0] == Ended.COMPLETE.code:
        from vibeam.batches.exponents import largest_exponent

        record.exponents[:, point] = largest_exponent(points, point, plan.lyapunov, record)
