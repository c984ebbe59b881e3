"""Batch of steady points: arrays of systems, drives and starts in, arrays of results out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.batches.points import Points, Systems, points_of
from vibeam.batches.response import Plan, Record
from vibeam.batches.tasks import is_compiled, run_points, run_task, tasks_of
from vibeam.runs.parallel import run_parallel
from vibeam.runs.sweep import HELD, LONGEST
from vibeam.solvers.steady import warm_up_once
from vibeam_models.arguments import count, refuse

if TYPE_CHECKING:
    from collections.abc import Callable
    from threading import Event

    from vibeam.batches.response import BatchResponse

TASK = 64  # points of one task of a thread


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
    """
    points = points_of(systems, omega, amplitude, gap, restitution, damping, state)
    plan = _plan(points, settle, hold, output, strobes, bool(lanes), lyapunov)
    workers = None if threads is None else _count("threads", threads, least=1)
    record, compiled = Record(len(points.base), points.size, plan.strobes), is_compiled(points, plan.output)
    tasks = [(run_task, which) for which in tasks_of(points, np.flatnonzero(compiled))]
    tasks += [(run_points, which) for which in _one_by_one(points, np.flatnonzero(~compiled), plan)]

    def task(item: tuple[Callable[..., None], NDArray[np.int64]], stop: Event) -> None:
        item[0](points, item[1], plan, record)

    if workers == 1 or len(tasks) == 1:
        for run, which in tasks:
            run(points, which, plan, record)
    else:
        run_parallel(task, tasks, workers)
    return record.response(points.shape)


def _one_by_one(points: Points, which: NDArray[np.int64], plan: Plan) -> list[NDArray[np.int64]]:
    """Points that no kernel takes as a whole, in tasks, those of one system together."""
    for i in np.unique(points.base[which]):
        warm_up_once("flight", points.bases[i], float(points.omega[0]), float(points.amplitude[0]), plan.output, {})
    keys = (points.omega, points.restitution, points.damping, points.gap, points.base)
    which = which[np.lexsort([each[which] for each in keys])]
    return [which[first : first + TASK] for first in range(0, len(which), TASK)]


def _plan(
    points: Points, settle: int, hold: int, output: str | None, strobes: int, lanes: bool, lyapunov: int
) -> Plan:  # fmt: skip
    faults: list[str] = []
    settle = count("settle", settle, faults, most=LONGEST)
    hold = count("hold", hold, faults, least=1, most=HELD // points.size)
    strobes = count("strobes", strobes, faults, most=hold)
    name = "contact" if output is None else output
    derivatives = [base.derivative(name) for base in points.bases]
    if strobes and any(each is not None and each.order == 2 for each in derivatives):
        faults.append("strobes: an acceleration is not read at the ends of periods: take its displacement or velocity")
    periods = count("lyapunov", lyapunov, faults)
    if periods:
        from vibeam.batches.exponents import exponent_faults

        faults += exponent_faults(points, periods)
    refuse("batch", faults)
    return Plan(settle, hold, name, lanes, strobes, periods)


def _count(name: str, value: int, least: int) -> int:
    faults: list[str] = []
    found = count(name, value, faults, least=least)
    refuse("batch", faults)
    return found
