"""Motions of one model over the plane, swept up and down: how large, of which kind, how many coexist.

A motion that does not repeat within 16 drive periods has no amplitude of its own: it goes on for some more readings of
the hold's length, and what stands for it is their mean with its standard error. One that has settled by then was slow,
no more. Of the others the sign of the largest Lyapunov exponent says whether they are chaotic.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.batch.points import changed
from vibeam.case.grid_keys import FREQUENCY
from vibeam.flight.event_driven import EventDrivenSolver
from vibeam.flight.exact import exact_solver
from vibeam.flight.pause import pause
from vibeam.flight.tangent import tangent_fault
from vibeam.maps.evaluate import evaluate, grid_of
from vibeam.maps.points import GridPoints, grid_points
from vibeam.orbits.largest_exponents import largest_exponents
from vibeam.run.parallel import run_parallel
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.verdict.axes import VerdictAxis

Array = NDArray[np.float64]

Kinds = NDArray[np.int64]

WAYS = ("up", "down")

NO_CONTACT, IRREGULAR, CHAOTIC, FAILED = -1, 0, -2, -3  #: kinds beside the period 1 … 16

READINGS = 8  # of a motion that does not repeat

PERIODS = (200, 1000)  # drive periods of the mean of an exponent; more where its sign is open

APART = 1e-3  # difference of two amplitudes, as a share, that makes two motions of one kind

SURE = 3.0  # standard errors by which means must differ for two motions of one kind


@dataclass(frozen=True)
class Motions:
    """Motions of a model, arrays (ways, rows, columns): up and down over the frequencies, a row a value of the key.

    ``value`` in the output's unit (mean of a motion that does not repeat, ``error`` its standard error, else 0);
    ``kind``: period 1 … 16, or one of the constants above; ``exponent`` in 1/s, known where it does not repeat.
    ``count`` (rows, columns): motions that coexist, among those that the two sweeps find. ``cpu``: seconds a point.
    """

    name: str
    modes: int
    value: Array
    error: Array
    kind: Kinds
    exponent: Array
    count: NDArray[np.int64]
    state: Array
    resting: NDArray[np.bool_]
    points: GridPoints
    cpu: float


def motions(case: Case, name: str, frequency: Array, axis: VerdictAxis, quantity: str) -> Motions:
    """Sweep a model up and down at every value of the key; errors as in ``vibeam.evaluate``."""
    axes = {axis.key: axis.values, FREQUENCY: frequency}
    asked = (quantity, "period", "ended", "state", "resting", "cpu_seconds")
    found = evaluate(case, name, axes, quantities=asked, direction="both")
    grid = grid_of(
        case, name, axes, quantities=(quantity,), direction="both", frequency=None, settle=None, hold=None, output=None,
        strobes=0, starts=None,
    )  # fmt: skip
    points = grid_points(
        grid.text, grid.path, name, grid.axes, grid.frequency, np.arange(len(axis.values))
    )  # fmt: skip
    return motions_from(case, name, points, found, quantity)


class Evaluated(Protocol):
    """What motions are made of: arrays (ways, rows, columns, …) by name."""

    @property
    def values(self) -> Mapping[str, Any]:
        """The quantity, period, ended, state, resting and cpu_seconds."""
        ...


def motions_from(case: Case, name: str, points: GridPoints, found: Evaluated, quantity: str) -> Motions:
    """Motions of a model from swept points: those that do not repeat go on, and are judged."""
    plane = _Plane(case, points, found, quantity)
    plane.go_on()
    return Motions(
        name, points.systems[0].size, plane.value, plane.error, plane.kind, plane.exponent, plane.counted(),
        plane.state, plane.resting, points, float(np.mean(found.values["cpu_seconds"])),
    )  # fmt: skip


class _Plane:
    """Motions under way: arrays (ways, rows, columns)."""

    def __init__(self, case: Case, points: GridPoints, found: Evaluated, quantity: str) -> None:
        self.case, self.points, self.quantity = case, points, quantity
        self.value = np.array(found.values[quantity], dtype=float)
        self.state, self.resting = np.array(found.values["state"]), np.array(found.values["resting"]) > 0
        self.kind: Kinds = np.array(found.values["period"], dtype=np.int64)
        self.kind[np.array(found.values["ended"]) != Ended.COMPLETE.code] = FAILED
        self.error, self.exponent = np.zeros(self.value.shape), np.full(self.value.shape, np.nan)

    def go_on(self) -> None:
        """Go on with the motions that do not repeat, row by row, in threads."""
        rows = np.flatnonzero((self.kind == IRREGULAR).any(axis=(0, 2))).tolist()
        run_parallel(lambda row, _: self._row(row), rows)

    def _row(self, row: int) -> None:
        """All motions of a row that do not repeat: one solver, or as many as there are systems along the row."""
        places = np.argwhere(self.kind[:, row] == IRREGULAR)
        for system, mine in self._systems(row, places):
            runner = exact_solver(system, float(self.points.omega[row].min()))
            assert isinstance(runner, EventDrivenSolver)
            for way, column in mine:
                pause()
                self._read(runner, way, row, column)
            left = [(way, column) for way, column in mine if self.kind[way, row, column] == IRREGULAR]
            if left and not tangent_fault(system):
                self._judge(runner, row, left)

    def _systems(
        self, row: int, places: NDArray[np.int64]
    ) -> Iterator[tuple[ImpactSystem, list[tuple[int, int]]]]:  # fmt: skip
        """Systems of a row with the places (way, column) of each."""
        points, rebounds = self.points, self.points.restitution
        groups: dict[tuple[int, float, float | None], list[tuple[int, int]]] = {}
        for way, column in places.tolist():
            at = row, column
            key = int(points.which[at]), float(points.gap[at]), None if rebounds is None else float(rebounds[at])
            groups.setdefault(key, []).append((way, column))
        for (which, gap, rebound), mine in groups.items():
            base = points.systems[which]
            yield changed(base, gap, base.restitution if rebound is None else rebound, 1.0), mine

    def _read(self, runner: EventDrivenSolver, way: int, row: int, column: int) -> None:
        """Further readings of one motion: their mean, or where it settles after all."""
        at, plan = (way, row, column), self.case.sweep
        omega, amplitude = float(self.points.omega[row, column]), float(self.points.amplitude[row, column])
        omegas = np.full(READINGS, omega)
        response, after = runner.steady(omegas, amplitude, self._state(at), 0, plan.hold, plan.output)
        if np.any(response.ended != Ended.COMPLETE.code):
            self.kind[at] = FAILED
            return
        taken: Array = getattr(response, self.quantity)
        self.state[at], self.resting[at] = np.concatenate([after.displacement, after.velocity]), after.resting
        self.kind[at] = response.period[-1]
        settled = self.kind[at] != IRREGULAR
        self.value[at] = taken[-1] if settled else taken.mean()
        self.error[at] = 0.0 if settled else taken.std(ddof=1) / np.sqrt(READINGS)

    def _judge(self, runner: EventDrivenSolver, row: int, places: list[tuple[int, int]]) -> None:
        """Tell chaos from other motions that do not repeat, by the sign of the largest Lyapunov exponent."""
        drives = [
            Drive(float(self.points.omega[row, column]), float(self.points.amplitude[row, column]))
            for _, column in places
        ]
        states = [self._state((way, row, column)) for way, column in places]
        left = np.arange(len(places))
        for periods in PERIODS:
            some = left.tolist()
            found = largest_exponents(
                [runner.system] * len(some), [drives[i] for i in some], [states[i] for i in some], periods, runner
            )
            for i, exponent, sign in zip(some, found.exponents, found.signs, strict=True):
                at = places[i][0], row, places[i][1]
                self.exponent[at], self.kind[at] = exponent, CHAOTIC if sign > 0 else IRREGULAR
            left = left[found.signs == 0]
            if not len(left):
                return

    def _state(self, at: tuple[int, int, int]) -> State:
        values, n = self.state[at], self.points.systems[0].size
        return State(values[:n], values[n:], bool(self.resting[at]))

    def counted(self) -> NDArray[np.int64]:
        """Motions that coexist (rows, columns): 2 where up and down lead to different ones."""
        up, down = 0, 1
        apart = np.abs(self.value[up] - self.value[down])
        size = np.maximum(np.abs(self.value[up]), np.abs(self.value[down]))
        margin = np.maximum(APART * size, SURE * np.hypot(self.error[up], self.error[down]))
        several = (self.kind[up] != self.kind[down]) | (apart > margin)
        return np.where(several, 2, 1).astype(np.int64)
