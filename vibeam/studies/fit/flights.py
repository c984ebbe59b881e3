"""Models of a fidelity at values of the keys, ready to fly: sweeps, flights over whole periods, tangent maps."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vibeam.case.fidelity import system
from vibeam.flight.solver import ExactSolver, exact_solver, reading_of
from vibeam.periodic.motion_at import Way, motion_at
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.studies.fit.surface import Forward
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.quantities import Ended
from vibeam.system.response import FrequencyResponse
from vibeam.system.state import State
from vibeam_models.arrays import Array
from vibeam_models.base_motion import drive_amplitude

KEPT = 64  # models kept ready to fly
LIMIT = 100_000  # impacts in one flight
ITERATIONS = 12  # of Newton's method


@dataclass(frozen=True)
class FlyingModel:
    """Model at one set of keys, ready to fly: its scene, system, solver, and the unit of each modal value (2n,).

    Rows (2n,) of states have the modes' ``signs``, which are arbitrary, as the models beside it.
    """

    scene: Any
    system: ImpactSystem
    solver: ExactSolver
    units: Array
    signs: Array
    output: str
    known: dict[bytes, Array] = field(default_factory=dict)  # base amplitudes that were asked for

    def base(self, omega: Array) -> Array:
        """Base amplitudes (points,), m, at drives ``omega`` (points,) rad/s."""
        if (mark := omega.tobytes()) not in self.known:
            found = np.asarray(drive_amplitude(self.scene, omega), dtype=float)
            self.known[mark] = np.broadcast_to(found, omega.shape)
        return self.known[mark]

    def drive(self, omega: float) -> Drive:
        """Drive at ``omega`` rad/s."""
        return Drive(omega, float(self.base(np.array([omega]))[0]))

    def row(self, state: State) -> Array:
        """State as one row (2n,)."""
        return np.asarray(self.signs * np.concatenate([state.displacement, state.velocity]))

    def state(self, row: Array, resting: bool) -> State:
        """State of a row (2n,)."""
        values, n = self.signs * row, len(row) // 2
        return State.reached(values[:n], values[n:], resting)

    def rest(self, found: FrequencyResponse) -> list[float]:
        """Shares of the time at rest on a rigid stop, one a point."""
        return [0.0] * len(found.rest) if self.system.contact_law.yields else found.rest.tolist()

    def swept(
        self, omega: Array, start: State | list[State] | None, settle: int, hold: int, quantity: str
    ) -> tuple[FrequencyResponse, list[State]]:  # fmt: skip
        """Points in turn, the state carried on or each from its own start, and the state after each."""
        states: list[State] = []
        reading = reading_of(quantity)
        found, _ = self.solver.steady(omega, self.base(omega), start, settle, hold, self.output, reading, states)
        return found, states

    def over(
        self, omega: Array, starts: list[State], periods: int, quantities: set[str] | None = None
    ) -> tuple[FrequencyResponse, Array]:  # fmt: skip
        """Flights over whole periods, each from its own start: what is read off, and states after (points, 2n).

        NaN where one fails.
        """
        quantity = "reach" if quantities and "reach" in quantities else "amplitude"
        found, after = self.swept(omega, starts, 0, periods, quantity)
        vectors = np.array([self.row(each) for each in after])
        vectors[found.ended != Ended.COMPLETE.code] = np.nan
        return found, vectors

    def orbit(self, omega: float, start: State, periods: int) -> Orbit:
        """The motion that a state at the drive's phase 0 leads to, its own state there; NoOrbit without."""
        section = StroboscopicMap(self.system, self.drive(omega), runner=self.solver)
        return motion_at(section, start, periods, ways=(Way.SHOT,), steps=ITERATIONS, kept=True)

    def tangent(self, orbit: Orbit) -> Array:
        """Tangent map of a motion over its span (2n, 2n), in the units and with the signs of the model."""
        own = np.where(self.system.omega > 0, self.system.omega, orbit.drive.omega)
        scale = self.signs * self.units / np.append(own, np.ones(self.system.size))
        return np.asarray(orbit.monodromy * (scale[:, None] / scale))


class OrbitModel:
    """Model of a fidelity that flies at drives of ``slowest`` rad/s and more, made once for each set of keys."""

    def __init__(self, forward: Forward, slowest: float) -> None:
        self.forward, self.slowest, self.ready = forward, slowest, OrderedDict[bytes, FlyingModel]()
        self.like = forward.system(np.array([each.start for each in forward.keys]))

    def at(self, x: Array) -> FlyingModel:
        """The model at shares ``x``; ValueError where there is none."""
        if (mark := x.tobytes()) not in self.ready:
            model = self.forward.at(self.forward.values(x))
            scene = model.scene()
            made = system(scene, model.fidelity)
            units = np.append(np.where(made.omega > 0, made.omega, self.slowest), np.ones(made.size))
            signs = np.tile(_signs(made, self.like), 2)
            self.ready[mark] = FlyingModel(
                scene, made, exact_solver(made, self.slowest), units, signs, self.forward.output
            )
            while len(self.ready) > KEPT:
                self.ready.popitem(last=False)
        return self.ready[mark]


def _signs(made: ImpactSystem, like: ImpactSystem) -> Array:
    """Signs (n,) of the modes by which they are those of another system."""
    total = np.zeros(made.size)
    rows = zip(made.outputs.values(), like.outputs.values(), strict=True)
    for one, other in ((made.contact, like.contact), (made.load, like.load), *rows):
        total += one * other / (float(np.abs(other).max()) or 1.0) ** 2
    return np.where(total < 0, -1.0, 1.0)
