"""Periodic motions in closed form along the one axis of a bifurcation diagram: stable and unstable ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.trajectory import simulate
from vibeam.maps.axes import Axis
from vibeam.maps.points import GridPoints, grid_points
from vibeam.maps.variation import narrowed
from vibeam.orbits.orbit import Orbit, orbits

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.plans import MapPlan

Array = NDArray[np.float64]

POINTS = 301  # along the axis

PERIODS = (1, 2)  # drive periods from impact to impact


@dataclass(frozen=True)
class ClosedForm:
    """The harder or the softer motions with one impact in ``periods`` drive periods, along the axis' ``values``.

    ``strobes`` (points, periods): the output at the end of each drive period, in order of size; NaN where there is no
    admissible motion.
    """

    periods: int
    values: Array
    strobes: Array
    stable: NDArray[np.bool_]


def closed_form_strobes(case: Case, plan: MapPlan, fidelity: str, points: int = POINTS) -> tuple[list[ClosedForm], str]:
    """All such motions at so many ``points`` along the one axis of a map; or why none are known."""
    (axis,) = plan.axes
    values = np.linspace(axis.values[0], axis.values[-1], points)
    line = (Axis(axis.key, tuple(values.tolist())),)
    known = grid_points(narrowed(case, fidelity), str(case.path), fidelity, line, plan.frequency, np.zeros(1, int))
    beyond = known.systems[0].beyond_plain
    derivative = known.systems[0].derivative(plan.output)
    if beyond or derivative is not None:
        why = " or ".join(beyond) if beyond else "an output that is a derivative"
        return [], f"no motions in closed form for {fidelity}: there are none with {why}"
    found = []
    for periods in PERIODS:
        rows = [_known(known, at, periods, plan.output) for at in range(points)]
        for branch in (0, 1):
            strobes = np.array([row[branch][0] for row in rows])
            if np.isfinite(strobes).any():
                found.append(ClosedForm(periods, values, strobes, np.array([row[branch][1] for row in rows])))
    return found, ""


def _known(points: GridPoints, at: int, periods: int, output: str) -> list[tuple[Array, bool]]:
    """Strobes and stability of both motions at one point."""
    system, drive = points.system_at(at), points.drive_at(at)
    blank = np.full(periods, np.nan)
    found: list[tuple[Array, bool]] = [(blank, False), (blank, False)]
    try:
        known = orbits(system, drive, periods)
    except ValueError:  # at a resonance of an undamped mode there is none
        return found
    for branch, orbit in enumerate(known):
        if orbit.admissible:
            found[branch] = np.sort(list(_strobes(orbit, output))), orbit.stable
    return found


def _strobes(orbit: Orbit, output: str) -> Iterator[float]:
    """The output at the ends of the drive periods that follow the impact: the flight from there has no other."""
    period = 2 * np.pi / orbit.drive.omega
    row = orbit.system.output(output)
    for count in range(1, orbit.periods + 1):
        flown = simulate(orbit.system, orbit.drive, count * period, orbit.state, t_start=orbit.time)
        yield float(row @ flown.state.displacement)
