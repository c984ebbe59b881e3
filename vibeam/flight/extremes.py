"""Extremes of outputs over a motion under a record: of all of it, or bin by bin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vibeam.flight.engine.entries import extremes_loaded
from vibeam.flight.engine.threads import resumed
from vibeam.flight.kernels.contacts.course import WALK, OutputWatch
from vibeam.flight.kernels.layout import COMPLETE
from vibeam.flight.record.solver import RecordSolver
from vibeam.flight.trajectory import Trajectory
from vibeam_models.arguments import floats
from vibeam_models.arrays import Array


@dataclass(frozen=True, eq=False)
class OutputExtremes:
    """Least and greatest values of outputs (o, b) in bins of time, and when; a bin holds both of its ends."""

    outputs: tuple[str, ...]
    edges: Array  #: (b + 1,) s
    least: Array
    least_time: Array
    greatest: Array
    greatest_time: Array

    @property
    def peak(self) -> Array:
        """(o,) the largest size of each output over all bins."""
        return np.asarray(np.maximum(np.nanmax(self.greatest, axis=1), -np.nanmin(self.least, axis=1)))

    @property
    def peak_time(self) -> Array:
        """(o,) when that is, s."""
        high, low = np.nanargmax(self.greatest, axis=1), np.nanargmin(self.least, axis=1)
        each = np.arange(len(self.outputs))
        above = self.greatest[each, high] >= -self.least[each, low]
        return np.asarray(np.where(above, self.greatest_time[each, high], self.least_time[each, low]))


def extremes(path: Trajectory, outputs: Sequence[str], edges: ArrayLike | None = None) -> OutputExtremes:
    """Extremes of ``outputs`` of a motion under a record, in bins between the ``edges``, s (None: all of it).

    NaN in a bin that the motion does not reach. To round-off; in a contact that is integrated to about 1e-6 of the
    value. At an impact a velocity counts before and after it, the acceleration of the impulse does not. KeyError for an
    unknown name, ValueError for a motion under a sine, for edges that do not ascend, and where a mode rings so fast
    beside the record that it takes more than 10⁹ / (n + 8) panels.

    >>> import vibeam
    >>> free = vibeam.ImpactSystem.from_modes(1.0, 0.0, 1.0, 1.0, gap=9.0)  # 1 − cos t under a step
    >>> path = vibeam.simulate(free, vibeam.Record.step(-1.0, 10.0), 10.0)
    >>> found = vibeam.extremes(path, ("contact",))
    >>> found.greatest.round(12).tolist(), found.greatest_time.round(6).tolist()
    ([[2.0]], [[3.141593]])
    """
    solver, system = path._solver, path.system
    if not isinstance(solver, RecordSolver):
        raise ValueError("extremes: the motion is under a sine, not under a record")
    bins = np.array([path.t_start, path.t_end]) if edges is None else floats("edges", edges)
    if bins.ndim != 1 or len(bins) < 2 or np.any(np.diff(bins) < 0):
        raise ValueError("edges: must be two or more times that ascend")
    solver._make_all(path.segments.trace)
    rows = np.zeros((len(outputs), system.size + 2))
    signals = np.zeros((len(solver.sets.engine.sets), len(outputs), 2 * system.size + 2))
    for place, name in enumerate(outputs):
        wanted = system.derivative(name)
        row = system.output(name) if wanted is None else wanted.row
        order, base = (0, 0.0) if wanted is None else (wanted.order, wanted.base)
        rows[place, :-2], rows[place, -2:] = row, (order, base)
        for slot in range(len(solver.sets)):
            signals[slot, place] = solver.sets.derivative(slot, np.array(row), order, base)
    before, beyond = int(bins[0] > path.t_start), int(bins[-1] < path.t_end)
    edges = np.concatenate([[-np.inf] * before, bins, [np.inf] * beyond])  # what lies outside has bins of its own
    found = np.empty((len(outputs), len(edges) - 1, 4))
    found[..., 0], found[..., 2], found[..., 1::2] = np.inf, -np.inf, np.nan
    watch = OutputWatch(signals, edges, rows, found, np.zeros((6, len(outputs))), np.zeros(WALK))
    motion = solver.sets.engine, path.segments.trace, np.ascontiguousarray(path.segments.poses), watch
    if resumed(lambda first: extremes_loaded(*motion, first)) != COMPLETE:
        raise ValueError("extremes: a mode rings too fast beside the record for all its turns to be looked at")
    found[np.isinf(found)] = np.nan
    found = found[:, before : before + len(bins) - 1]
    return OutputExtremes(tuple(outputs), bins, *(found[..., i] for i in range(4)))
