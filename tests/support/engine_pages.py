"""Motions that a page flies, and what Python finds of the same ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.solver import FlightSolver
from vibeam.flight.trajectory import Trajectory
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse

Place = Mapping[str, float]
ENGINE = "const { open } = await load('explore/engine/engine.js'); const engine = await open(given.payload);"
GROWN = 1e-6  # predicted error of an impact velocity, as a share of the largest, up to which it is first order
ROUND_OFF = 50.0  # times the predicted error by which two computations of one motion may differ
EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Flown:
    """A motion from equilibrium over drive periods, and the steady point after settling, as Python finds them."""

    path: Trajectory
    point: FrequencyResponse

    @classmethod
    def of(
        cls, system: ImpactSystem, settings: Mapping[str, float], periods: int, settle: int, output: str = "contact"
    ) -> Flown:
        """The same at a model's own numbers, as ``engine.settings`` gives them."""
        here = replace(
            system, gap=settings["gap"], restitution=settings["restitution"], zeta=system.zeta * settings["damping"]
        )
        omega, amplitude = settings["omega"], settings["amplitude"]
        path = vibeam.simulate(here, vibeam.Drive(omega, amplitude), periods * 2 * np.pi / omega)
        point, _ = FlightSolver(here, omega).steady([omega], amplitude, None, settle, periods, output)
        return cls(path, point)

    def differences(self, flight: Mapping[str, Any]) -> list[str]:
        """In what the page's ``fly`` is another motion than this, beyond round-off as ``path.errors`` predicts it."""
        errors, times, speeds = self.path.errors, self.path.impact_times, self.path.impact_velocities
        mine, theirs = np.array(flight["impactTimes"]), np.array(flight["impactVelocities"])
        sure = self.horizon
        if len(mine) < sure:
            return [f"{len(mine)} impacts of {sure}"]
        late = np.abs(mine[:sure] - times[:sure]) / np.maximum(errors.time[:sure], EPSILON * times[:sure])
        top = speeds.max(initial=0.0)
        off = np.abs(theirs[:sure] - speeds[:sure]) / np.maximum(errors.velocity[:sure], EPSILON * top)
        found = [f"{name} {worst:.3g} errors off" for name, each in (("time", late), ("velocity", off))
                 if (worst := each.max(initial=0.0)) > ROUND_OFF]  # fmt: skip
        if self.counted:
            stats, counts = self.path.stats, flight["counts"]
            pairs = {"impacts": counts["impacts"], "evaluations": counts["evaluations"]}
            found += [f"{name} {mine} for {stats[name]}" for name, mine in pairs.items() if mine != stats[name]]
        return found + (self._point_differences(flight) if self.repeating else [])

    @property
    def horizon(self) -> int:
        """Impacts before the first of which round-off is a share that may change what comes."""
        grown = self.path.errors.velocity > GROWN * self.path.impact_velocities.max(initial=0.0)
        return int(np.argmax(grown)) if grown.any() else len(grown)

    @property
    def counted(self) -> bool:
        """True where round-off nowhere grows to such a share."""
        return self.horizon == len(self.path.impact_times)

    @property
    def repeating(self) -> bool:
        """True where the steady point repeats, or has no contact: it forgets round-off."""
        return self.point.ended[0] == 0 and int(self.point.period[0]) != 0

    def _point_differences(self, flight: Mapping[str, Any]) -> list[str]:
        point = self.point
        room = 1e-12 * max(abs(point.maximum[0]), abs(point.minimum[0]))
        pairs = {"period": 0.0, "maximum": room, "minimum": room}
        return [
            f"{name} {flight[name]} for {getattr(point, name)[0]}"
            for name, off in pairs.items()
            if not abs(flight[name] - getattr(point, name)[0]) <= off
        ]


def compared(
    node: Callable[..., Any], payload: Mapping[str, Any], systems: Mapping[str, ImpactSystem],
    places: Mapping[str, list[Place]], periods: int = 30, settle: int = 40, output: str = "contact",
) -> tuple[list[str], int, int]:  # fmt: skip
    """Differences between page and Python at places of each fidelity; of how many counts and points compared."""
    asked = [(name, place) for name in places for place in places[name]]
    script = (
        ENGINE
        + """
    return given.asked.map(([fidelity, place]) => [engine.settings(fidelity, place),
      engine.fly({ fidelity, ...place, periods: given.periods, settle: given.settle })]);
    """
    )
    given = {"payload": payload, "asked": asked, "periods": periods, "settle": settle}
    found, counted, repeating = list[str](), 0, 0
    for (name, place), (settings, flight) in zip(asked, node(script, given), strict=True):
        flown = Flown.of(systems[name], settings, periods, settle, output)
        counted, repeating = counted + flown.counted, repeating + flown.repeating
        if flight["ended"] != flown.path.ended.value:
            found.append(f"{name} {place}: {flight['ended']}")
        found += [f"{name} {place}: {each}" for each in flown.differences(flight)]
    return found, counted, repeating
