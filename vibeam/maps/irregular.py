"""Kinds of swept motions: period, no contact, or one that does not repeat; the mean of the latter.

A motion that does not repeat within 16 drive periods has no amplitude of its own: it goes on for some more readings of
the hold's length, and what stands for it is their mean with its standard error. One that has settled by then was slow,
no more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.batches.points import changed
from vibeam.flight.engine.threads import pause
from vibeam.flight.solver import exact_solver, reading_of
from vibeam.maps.points import GridPoints
from vibeam.store.blocks import Values
from vibeam.system.response import Ended
from vibeam.system.state import State

NO_CONTACT, IRREGULAR, FAILED = -1, 0, -2  #: kinds beside the period 1 … 16

READINGS = 8  # of a motion that does not repeat, the sweep's own among them
Place = tuple[int, int, int]  # row, way, column


def judged(points: GridPoints, found: Values, quantity: str, hold: int, output: str) -> Values:
    """Judge swept motions, arrays (rows, ways, columns, …): the quantity, error, kind, CPU time.

    ``found``: quantity, period, ended, state, resting and cpu_seconds of the sweeps over ``points`` (rows, columns).
    """
    plane = _Plane(points, found, quantity, hold, output)
    plane.go_on()
    return {
        quantity: plane.value, "error": plane.error, "kind": plane.kind,
        "cpu_seconds": np.array(found["cpu_seconds"], dtype=float),
    }  # fmt: skip


class _Plane:
    """Motions under way: arrays (rows, ways, columns)."""

    def __init__(self, points: GridPoints, found: Values, quantity: str, hold: int, output: str) -> None:
        self.points, self.quantity, self.hold, self.output = points, quantity, hold, output
        self.value = np.array(found[quantity], dtype=float)
        self.state, self.resting = np.array(found["state"], dtype=float), np.array(found["resting"]) > 0
        self.kind: NDArray[np.int64] = np.array(found["period"], dtype=np.int64)
        self.kind[np.array(found["ended"]) != Ended.COMPLETE.code] = FAILED
        self.error = np.zeros(self.value.shape)
        self._slowest = float(points.omega.min())
        self._solvers: dict[tuple[int, float, float | None], Any] = {}

    def go_on(self) -> None:
        """Go on with the motions that do not repeat."""
        for row, way, column in np.argwhere(self.kind == IRREGULAR).tolist():
            pause()
            self._read((row, way, column))

    def _solver(self, at: Place) -> Any:
        """The solver of a place, one for all places of its system."""
        points, place = self.points, at[::2]
        rebound = None if points.restitution is None else float(points.restitution[place])
        key = int(points.which[place]), float(points.gap[place]), rebound
        if key not in self._solvers:
            base = points.systems[key[0]]
            system = changed(base, key[1], base.restitution if rebound is None else rebound, 1.0)
            self._solvers[key] = exact_solver(system, self._slowest)
        return self._solvers[key]

    def _read(self, at: Place) -> None:
        """Further readings of one motion: their mean, or where it settles after all."""
        omegas = np.full(READINGS - 1, self.points.omega[at[::2]])
        response, _ = self._solver(at).steady(
            omegas, float(self.points.amplitude[at[::2]]), self._state(at), 0, self.hold, self.output,
            reading_of(self.quantity),
        )  # fmt: skip
        if np.any(response.ended != Ended.COMPLETE.code):
            self.kind[at] = FAILED
            return
        taken = np.append(self.value[at], getattr(response, self.quantity))
        self.kind[at] = response.period[-1]
        settled = self.kind[at] != IRREGULAR
        self.value[at] = taken[-1] if settled else taken.mean()
        self.error[at] = 0.0 if settled else taken.std(ddof=1) / np.sqrt(READINGS)

    def _state(self, at: Place) -> State:
        values, n = self.state[at], self.points.systems[0].size
        return State(values[:n], values[n:], bool(self.resting[at]))
