"""Kinds of swept motions: period, no contact, chaos or another motion that does not repeat; the mean of the latter.

A motion that does not repeat within 16 drive periods has no amplitude of its own: it goes on for some more readings of
the hold's length, and what stands for it is their mean with its standard error. One that has settled by then was slow,
no more. Of the others the sign of the largest Lyapunov exponent says whether they are chaotic. One mode that rests on
the stop is not: the rest leaves nothing of a disturbance, so that the motion repeats in the end, however seldom it
rests.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.batches.batch import batch
from vibeam.batches.points import changed
from vibeam.flight.disturbance.maps import tangent_fault
from vibeam.flight.engine.threads import pause
from vibeam.flight.solver import exact_solver, reading_of
from vibeam.maps.points import GridPoints
from vibeam.store.blocks import Values
from vibeam.system.response import Ended
from vibeam.system.state import State

NO_CONTACT, IRREGULAR, CHAOTIC, FAILED = -1, 0, -2, -3  #: kinds beside the period 1 … 16

READINGS = 8  # of a motion that does not repeat, the sweep's own among them

# drive periods of the mean of an exponent, and standard errors by which it must differ from 0: more periods where it
# does not. One mode begins with the second stage: a rest, which decides, may be seldom.
STAGES = ((60, 4.0), (200, 2.0), (1000, 2.0))
Place = tuple[int, int, int]  # row, way, column


def judged(points: GridPoints, found: Values, quantity: str, hold: int, output: str) -> Values:
    """Judge swept motions, arrays (rows, ways, columns, …): the quantity, error, kind, exponent, CPU time.

    ``found``: quantity, period, ended, state, resting and cpu_seconds of the sweeps over ``points`` (rows, columns).
    """
    plane = _Plane(points, found, quantity, hold, output)
    plane.go_on()
    return {
        quantity: plane.value, "error": plane.error, "kind": plane.kind, "exponent": plane.exponent,
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
        self.error, self.exponent = np.zeros(self.value.shape), np.full(self.value.shape, np.nan)
        self.one_mode = points.systems[0].size == 1
        self._slowest = float(points.omega.min())
        self._solvers: dict[tuple[int, float, float | None], Any] = {}

    def go_on(self) -> None:
        """Go on with the motions that do not repeat."""
        for at in self._irregular():
            pause()
            self._read(at)
        left = [
            at for at in self._irregular()
            if np.isnan(self.exponent[at]) and not tangent_fault(self._solver(at).system)
        ]  # fmt: skip
        if left:
            self._judge(left)

    def _irregular(self) -> list[Place]:
        places = np.argwhere(self.kind == IRREGULAR).tolist()
        return [(row, way, column) for row, way, column in sorted(places, key=lambda at: (at[1], at[0], at[2]))]

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
        response, after = self._solver(at).steady(
            omegas, float(self.points.amplitude[at[::2]]), self._state(at), 0, self.hold, self.output,
            reading_of(self.quantity),
        )  # fmt: skip
        if np.any(response.ended != Ended.COMPLETE.code):
            self.kind[at] = FAILED
            return
        taken = np.append(self.value[at], getattr(response, self.quantity))
        self.state[at], self.resting[at] = np.concatenate([after.displacement, after.velocity]), after.resting
        self.kind[at] = response.period[-1]
        settled = self.kind[at] != IRREGULAR
        self.value[at] = taken[-1] if settled else taken.mean()
        self.error[at] = 0.0 if settled else taken.std(ddof=1) / np.sqrt(READINGS)
        if not settled and self.one_mode and np.any(response.rest > 0):
            self.exponent[at] = -np.inf

    def _judge(self, places: list[Place]) -> None:
        """Tell chaos from other motions that do not repeat, by the sign of the largest Lyapunov exponent."""
        points = self.points
        for periods, margin in STAGES[self.one_mode :]:
            at = tuple(np.transpose(places))
            here = at[::2]
            found = batch(
                np.array(points.systems)[points.which[here]], points.omega[here], points.amplitude[here],
                gap=points.gap[here], restitution=None if points.restitution is None else points.restitution[here],
                state=self.state[at], settle=0, hold=self.hold, lyapunov=periods, threads=1,
            )  # fmt: skip
            exponent, sure = found.lyapunov, margin * found.lyapunov_error
            self.exponent[at], self.kind[at] = exponent, np.where(exponent > sure, CHAOTIC, IRREGULAR)
            places = [place for place, near in zip(places, ~(np.abs(exponent) > sure), strict=True) if near]
            if not places:
                return

    def _state(self, at: Place) -> State:
        values, n = self.state[at], self.points.systems[0].size
        return State(values[:n], values[n:], bool(self.resting[at]))
