"""Periodic motions in closed form along the one axis of a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.grid_keys import FREQUENCY
from vibeam.maps.points import Axis, GridPoints, grid_points
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.branch_walk import BranchEnd
from vibeam.periodic.continuation import Setting
from vibeam.periodic.follow import Branch, follow
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Model
    from vibeam.case.grid_keys import MapPlan

STRAIGHT = 1e-12  # share by which numbers of the points may be off a straight line over the axis


def setting_along(model: Model, key: str, values: Array, points: GridPoints) -> Setting | None:
    """System and drive over the ``values`` of an axis whose ``points`` are given.

    Over the frequency as the case says; over any other key by straight lines through the numbers of the points. None
    where these are not straight, where the key changes the modes, for modes without stiffness, and on an axis of one
    value.
    """
    system = points.systems[0]
    if len(points.systems) > 1 or np.any(system.omega == 0) or np.ptp(values) == 0:
        return None
    if key == FREQUENCY:
        held = points.system_at(0)
        return lambda value: (held, Drive(2 * np.pi * value, _amplitude(model, value)))
    restitution = np.full(values.shape, system.restitution) if points.restitution is None else points.restitution[0]
    rows = np.array([points.omega[0], points.amplitude[0], points.gap[0], restitution])
    if np.any(np.abs(_between(rows, values, values) - rows) > STRAIGHT * np.abs(rows).max(axis=1, keepdims=True)):
        return None

    def setting(value: float) -> tuple[ImpactSystem, Drive]:
        omega, amplitude, gap, rebound = _between(rows, values, np.array([value]))[:, 0].tolist()
        return replace(system, gap=gap, restitution=rebound), Drive(omega, amplitude)

    return setting


def _between(rows: Array, values: Array, wanted: Array) -> Array:
    """Straight lines from the first to the last value, (rows, wanted)."""
    share = (wanted - values[0]) / (values[-1] - values[0])
    return np.asarray(rows[:, :1] * (1 - share) + rows[:, -1:] * share)


def _amplitude(model: Model, frequency: float) -> float:
    return float(np.broadcast_to(model.amplitude(2 * np.pi * np.array([frequency])), 1)[0])


POINTS = 301  # along the axis
PERIODS = (1, 2)  # drive periods from impact to impact
LONGEST = 4  # drive periods of a doubled motion
STEP = 0.02  # the longest along a branch, as a share of the motion's size and of the axis
SAME = 1e-7  # share of the axis within which two doublings are one


@dataclass(frozen=True)
class ClosedForm:
    """A branch of motions with ``impacts`` in ``periods`` drive periods, in order along it: ``values`` of the axis.

    ``strobes`` (points, periods): the output at the end of each drive period, in order of size; NaN where there is no
    admissible motion.
    """

    impacts: int
    periods: int
    values: Array
    strobes: Array
    stable: NDArray[np.bool_]


def closed_form_strobes(case: Case, plan: MapPlan, fidelity: str, points: int = POINTS) -> tuple[list[ClosedForm], str]:
    """Motions with one impact at so many ``points`` along the one axis of a map, and the branches that their doublings
    begin; or why none are known."""
    (axis,), model = plan.axes, case.model(fidelity)
    values = np.linspace(axis.values[0], axis.values[-1], points)
    known = grid_points(model, (Axis(axis.key, tuple(values.tolist())),), plan.frequency, np.zeros(1, int))
    beyond = known.systems[0].beyond_plain
    derivative = known.systems[0].derivative(plan.output)
    if beyond or derivative is not None:
        why = " or ".join(beyond) if beyond else "an output that is a derivative"
        return [], f"no motions in closed form for {fidelity}: there are none with {why}"
    setting = setting_along(model, axis.key, values, known)
    found = list[ClosedForm]()
    for periods in PERIODS:
        rows = [_known(known, at, periods) for at in range(points)]
        for branch in (0, 1):
            motions = [row[branch] for row in rows]
            if any(motions):
                found.append(_branch(1, periods, values, motions, plan.output))
                found += [] if setting is None else _doubled(values, setting, motions, plan.output)
    return found, ""


def _known(points: GridPoints, at: int, periods: int) -> tuple[Orbit | None, Orbit | None]:
    """The harder and the softer motion at one point, None where it is not admissible."""
    try:
        known = orbits(points.system_at(at), points.drive_at(at), periods)
    except ValueError:  # at a resonance of an undamped mode there is none
        known = ()
    harder, softer = (*(orbit if orbit.admissible else None for orbit in known), None, None)[:2]
    return harder, softer


def _branch(
    impacts: int, periods: int, values: Array, motions: Sequence[Orbit | None], output: str
) -> ClosedForm:  # fmt: skip
    strobes = np.full((len(motions), periods), np.nan)
    for at, orbit in enumerate(motions):
        if orbit is not None:
            strobes[at] = _strobes(orbit, output)
    stable = np.array([each is not None and each.stable for each in motions])
    return ClosedForm(impacts, periods, values, strobes, stable)


def _strobes(orbit: Orbit, output: str) -> Array:
    """The output at the ends of the drive periods of a motion, in order of size."""
    period = 2 * np.pi / orbit.drive.omega
    times = period * (np.ceil(orbit.time / period) + np.arange(orbit.periods))
    path = orbit.path()
    return np.sort(path.at(np.clip(times, path.t_start, path.t_end), output))


def _doubled(
    values: Array, setting: Setting, motions: Sequence[Orbit | None], output: str
) -> Iterator[ClosedForm]:  # fmt: skip
    """Branches that begin at the doublings of motions with one impact."""
    low, high = float(values.min()), float(values.max())
    known: list[tuple[int, float]] = []
    for part in _runs(motions):
        first, value = motions[part[0]], float(values[part[0]])
        assert first is not None
        to, behind = (high, low) if value < high else (low, high)
        try:
            branch = follow(first, setting, to, value=value, behind=behind, step=STEP)
        except ValueError:  # it begins too close to grazing to be followed
            continue
        for each in _tree(branch, first.periods, SAME * (high - low), known):
            last = each.orbits[-1]
            yield _branch(len(last.times), last.periods, each.values, each.orbits, output)


def _tree(branch: Branch, periods: int, near: float, known: list[tuple[int, float]]) -> Iterator[Branch]:
    """Branches that begin at the doublings of a branch and of theirs, each once, up to ``LONGEST`` periods."""
    for met in branch.boundaries if 2 * periods <= LONGEST else ():
        if met.kind is not Kind.DOUBLING or any(n == periods and abs(v - met.value) < near for n, v in known):
            continue
        known.append((periods, met.value))
        try:
            doubled = branch.switch(met)
        except ValueError:  # it ends at a grazing too close to where it begins
            continue
        if doubled.end is BranchEnd.BIRTH:
            known.append((periods, doubled.boundaries[-1].value))
        yield doubled
        yield from _tree(doubled, 2 * periods, near, known)


def _runs(motions: Sequence[Orbit | None]) -> list[NDArray[np.int64]]:
    """Stretches of the axis with a motion."""
    there = np.flatnonzero([each is not None for each in motions])
    return np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
