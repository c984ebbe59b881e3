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
ENGINE = "const { open } = await load('extensions/explore/engine/engine.js'); const engine = await open(given.payload);"
GROWN = 1e-6  # predicted error of an impact velocity, as a share of the largest, up to which it is first order
ROUND_OFF = 50.0  # times the predicted error by which two computations of one motion may differ
DIGITS = 2.0**-50
MANY = 24  # modes beyond which rests are sums of so many that Python's own are off by 3e-12 (64 modes, a static load)
EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Flown:
    """A motion from equilibrium over drive periods, and the steady point after settling, as Python finds them.

    ``beside``: that point under drives larger by some last digits, which say how well it is determined.
    """

    path: Trajectory
    point: FrequencyResponse
    beside: list[FrequencyResponse]

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
        drives = [amplitude * (1 + k * DIGITS) for k in (0, 1, -1, 2, -2)]
        solver = FlightSolver(here, omega)
        points = [solver.steady([omega], each, None, settle, periods, output)[0] for each in drives]
        return cls(path, points[0], points[1:])

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
        """True where the steady point repeats, or has no contact, and some last digits change nothing of that."""
        periods = {int(each.period[0]) if each.ended[0] == 0 else 0 for each in (self.point, *self.beside)}
        return len(periods) == 1 and 0 not in periods

    def _point_differences(self, flight: Mapping[str, Any]) -> list[str]:
        point = self.point
        off = 1e-12 if self.path.system.size <= MANY else 1e-11
        size = max(abs(point.maximum[0]), abs(point.minimum[0]))
        found = [] if flight["period"] == point.period[0] else [f"period {flight['period']} for {point.period[0]}"]
        for name in ("maximum", "minimum"):
            mine, theirs = flight[name], getattr(point, name)[0]
            known = max(abs(getattr(each, name)[0] - theirs) for each in self.beside)
            if not abs(mine - theirs) <= off * size + ROUND_OFF * known:
                found.append(f"{name} {mine} for {theirs}")
        return found


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
