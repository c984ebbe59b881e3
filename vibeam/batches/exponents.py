"""Largest Lyapunov exponents of a batch's points, from the states in which they ended: those of ``vibeam.lyapunov``.

Of plain systems compiled code carries the disturbances of all points along, those of one task together:

- a motion that repeats after k periods: the monodromy matrix M, a column for each of the 2n directions, and Newton's
  method x ← x − (M − 1)⁻¹ (P(x) − x) for all points at once, until x is on the cycle to round-off; λ = log|μ|/kT;
- any other: one disturbance, made of size 1 in every period, over ``ALIGNED`` periods and those of the mean.

Alone, by ``vibeam.lyapunov``, goes what meets rests, completed chatter or plastic impacts, a cycle to which Newton's
method does not lead, and a mean below zero, which may be that of a cycle which no state has reached yet.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vibeam.batches.points import plain_points
from vibeam.flight.disturbance.maps import tangent_fault
from vibeam.flight.engine.threads import pause
from vibeam.flight.kernels.layout import ELASTIC
from vibeam.periodic.lyapunov import ALIGNED, BATCHES, lyapunov, mean_exponents
from vibeam.periodic.stroboscopic import GIVEN, NEAR, ROUND_OFF, STALLED, StroboscopicMap
from vibeam.system.impact_system import Drive
from vibeam.system.quantities import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array, Flags, Index

if TYPE_CHECKING:
    from vibeam.batches.points import BatchPoints
    from vibeam.batches.response import BatchRecord
    from vibeam.flight.points.points import PlainPoints


NEWTON = 8  # steps, before a point goes alone


def exponent_faults(points: BatchPoints, periods: int) -> list[str]:
    """Reasons why exponents of these points cannot be had as means over ``periods``."""
    found = [] if periods >= BATCHES else [f"lyapunov: {periods} must be at least {BATCHES} drive periods, or 0"]
    reasons = {tangent_fault(base): None for base in points.bases}
    return found + [f"lyapunov: not known for {reason}" for reason in reasons if reason]


def largest_exponents(points: BatchPoints, which: Index, periods: int, record: BatchRecord) -> Array:
    """Largest exponents (1/s) of the points ``which`` of plain systems in ``record``, and their errors: (2, points).

    NaN where a point failed; one whose motion fails only now is recorded as failed.
    """
    found = np.full((2, len(which)), np.nan)
    done = record.values["ended"][which] == Ended.COMPLETE.code
    repeats = record.values["period"][which]
    alone = done.copy()
    for some, compute in ((done & (repeats != 0), _of_cycles), (done & (repeats == 0), _of_means)):
        if some.any():
            found[:, some] = compute(points, which[some], periods, record)
            alone[some] = np.isnan(found[0, some])
    for at in np.flatnonzero(alone):
        found[:, at] = largest_exponent(points, int(which[at]), periods, record)
    return found


def largest_exponent(points: BatchPoints, point: int, periods: int, record: BatchRecord) -> tuple[float, float]:
    """Largest exponent of one point by ``vibeam.lyapunov``, and its error; what fails now is recorded as failed."""
    pause()
    n, values = points.size, record.state[point]
    state = State(values[:n], values[n:], bool(record.resting[point]))
    drive = Drive(float(points.omega[point]), float(points.amplitude[point]))
    try:
        system = points.system(point)
        found = None
        if record.values["period"][point] == 0:
            found = mean_exponents(*StroboscopicMap(system, drive).in_flight(state), periods, 1)
        if found is None or not found.largest > 0:
            found = lyapunov(system, drive, state, settle=0, periods=periods, count=1)
        return found.largest, float(found.errors[0])
    except ArithmeticError:
        record.values["ended"][point] = Ended.EVENT_LIMIT.code
        return float("nan"), float("nan")


def _of_means(points: BatchPoints, which: Index, periods: int, record: BatchRecord) -> Array:
    """Means of motions that do not repeat, and their errors by batches; NaN for those that go alone."""
    from vibeam.flight.points.disturbances import carry

    plain, elastic = _plain(points, which, record)
    units, n = _units(points, which), points.size
    start = np.random.default_rng(0).standard_normal((2 * n, 1))[:, 0]
    columns = (start / np.linalg.norm(start) / units).reshape(len(which), 1, 2, n)
    spans = np.full(len(which), ALIGNED + periods)
    carried = carry(plain, elastic, spans, columns, single=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(carried.growth[:, ALIGNED:])
        parts = np.stack([part.mean(axis=1) for part in np.array_split(logs, BATCHES, axis=1)])
        found = logs.mean(axis=1) * points.omega[which] / (2 * np.pi)
        error = parts.std(axis=0, ddof=1) * points.omega[which] / (2 * np.pi * np.sqrt(BATCHES))
    mean, lost = carried.known & (found > 0), _forgotten(points, which, carried.lost)
    return np.where(mean, [found, error], [lost, np.where(np.isnan(lost), np.nan, 0.0)])


def _forgotten(points: BatchPoints, which: Index, lost: Flags) -> Array:
    """−∞ for one mode that has rested or whose impacts have come to an end: there both directions are lost."""
    return np.where(lost & (points.size == 1) & (points.restitution[which] > 0), -np.inf, np.nan)


def _of_cycles(points: BatchPoints, which: Index, periods: int, record: BatchRecord) -> Array:
    """Exponents of motions that repeat, by their multipliers, without error; NaN for those that go alone."""
    from vibeam.flight.points.disturbances import carry

    plain, elastic = _plain(points, which, record)
    m, n = len(which), points.size
    units, lengths = _units(points, which), np.abs(record.values["period"][which])
    assert plain.starts is not None
    begun = plain.starts.reshape(m, 2 * n) * units
    size = np.maximum(np.linalg.norm(begun, axis=1), np.finfo(float).tiny)
    identity = np.broadcast_to(np.eye(2 * n), (m, 2 * n, 2 * n)) / units[:, None, :]
    found, here, last = np.full(m, np.nan), begun.copy(), np.full(m, np.inf)
    todo = np.arange(m)
    for _ in range(NEWTON):
        some = replace(plain.of(todo), starts=(here[todo] / units[todo]).reshape(-1, 2, n))
        columns = identity[todo].reshape(-1, 2 * n, 2, n)
        carried = carry(some, elastic, lengths[todo], columns, single=False)
        after = carried.states.reshape(-1, 2 * n) * units[todo]
        matrix = np.swapaxes(carried.columns.reshape(-1, 2 * n, 2 * n), 1, 2) * units[todo][:, :, None]
        found[todo] = _forgotten(points, which[todo], carried.lost)
        step = _newton(matrix, after - here[todo])
        with np.errstate(invalid="ignore"):
            length = np.linalg.norm(step, axis=1) / size[todo]
            there = (length <= ROUND_OFF) | ((length < STALLED) & (length >= last[todo] / 2))
            on = carried.known & (length <= 1)
        largest = _largest(matrix, on & there)
        away = np.linalg.norm(here[todo] - begun[todo], axis=1) / size[todo]
        near = np.where(lengths[todo] == record.values["period"][which[todo]], NEAR, np.inf)  # without contact any
        fine = on & there & ((away <= GIVEN) | ((away <= near) & (largest < 1)))
        at = todo[fine]
        with np.errstate(divide="ignore"):
            found[at] = np.log(largest[fine]) * points.omega[which[at]] / (2 * np.pi * lengths[at])
        ahead = on & ~there
        here[todo[ahead]] -= step[ahead]
        last[todo] = length
        todo = todo[ahead]
        if not len(todo):
            break
    return np.stack([found, np.zeros(m)])


def _newton(matrix: Array, apart: Array) -> Array:
    """(M − 1)⁻¹ (P(x) − x) of each point; NaN where there is none."""
    fine = np.all(np.isfinite(matrix), axis=(1, 2)) & np.all(np.isfinite(apart), axis=1)
    step = np.full_like(apart, np.nan)
    inverse = np.linalg.pinv(matrix[fine] - np.eye(matrix.shape[-1]), rcond=1e-14)
    step[fine] = (inverse @ apart[fine][:, :, None])[:, :, 0]
    return step


def _largest(matrix: Array, which: Flags) -> Array:
    """Largest modulus of the eigenvalues of some matrices; elsewhere NaN."""
    found = np.full(len(matrix), np.nan)
    found[which] = np.abs(np.linalg.eigvals(matrix[which])).max(axis=-1)
    return found


def _units(points: BatchPoints, which: Index) -> Array:
    """Factors (m, 2n) that bring displacements and velocities to units of velocity."""
    own = np.array([base.omega for base in points.bases])[points.base[which]]
    return np.concatenate([np.where(own > 0, own, points.omega[which][:, None]), np.ones_like(own)], axis=1)


def _plain(points: BatchPoints, which: Index, record: BatchRecord) -> tuple[PlainPoints, bool]:
    """The points from the states in which they ended, and whether their impacts are all but elastic."""
    found = replace(
        plain_points(points, which),
        starts=record.state[which].reshape(len(which), 2, points.size),
        resting=record.resting[which],
    )
    return found, bool(1.0 - points.restitution[which[0]] < ELASTIC)
