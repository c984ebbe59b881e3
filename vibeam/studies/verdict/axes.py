"""Axes of the fidelity map, the drive frequency and another key of the case, and exact boundaries over its plane.

Over gap and drive they are contours of exact test functions (``maps.closed_form``); over any other key, which changes
the structure, they are located to round-off along each row and joined from row to row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from vibeam.case.grid_keys import FREQUENCY, GAP, LEVELS, RESTITUTION
from vibeam.exchange.faults import CaseError
from vibeam.maps.closed_form import boundaries_over
from vibeam.maps.points import GridPoints
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import boundaries
from vibeam.studies.stability import rows
from vibeam.studies.stability.axes import NAMES, WIDE, frequencies, second_name, swing
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem

SHORT = {"frequency": FREQUENCY, "gap": GAP, "restitution": RESTITUTION}  #: "drive" is whichever the case has
DRIVEN = (0.2, 2.0)  # default range of a drive, in its own value


@dataclass(frozen=True)
class VerdictAxis:
    """The second key: its name, values in ``unit`` (SI), and the case's own value (NaN: not in the case)."""

    key: str
    name: str
    unit: str
    values: Array
    own: float


def keys_of(case: Case, over: str) -> str:
    """The second key of ``over``, which names one beside the frequency; ValueError for anything else."""
    name = second_name(over)
    key = _drive_key(case) if name == "drive" else SHORT.get(name, name)
    if "," in key or key == FREQUENCY:
        raise ValueError(f"--over: write one key beside the frequency, gap or frequency,gap, not {over!r}")
    return key


def second_axis(
    case: Case, key: str, low: str | float | None, high: str | float | None, points: int, system: ImpactSystem
) -> VerdictAxis:
    """Values of ``key`` from ``low`` to ``high`` (with unit); None: around the case's own, for gap and drive alone."""
    unit, own = _unit(case, key), _own(case, key)
    usual = _usual(case, key, own, system)
    ends = []
    for flag, given, default in (("--from", low, usual[0]), ("--to", high, usual[1])):
        if given is None and np.isnan(default):
            raise ValueError(f"{flag}: missing, for {key} has no usual range: write {flag} with its unit")
        ends.append(default if given is None else _value(case, flag, given, key))
    if not ends[0] < ends[1]:
        raise ValueError(f"--from, --to: {key} must ascend, not go from {ends[0]:.4g} to {ends[1]:.4g}")
    return VerdictAxis(key, _name(case, key), unit, np.linspace(ends[0], ends[1], points), own)


def _drive_key(case: Case) -> str:
    order = sorted(LEVELS, key=lambda key: key == "drive.gain")  # a gain beside a voltage is no level of its own
    found = [key for key in order if case.keys.value(key) is not None]
    if not found:
        raise ValueError("--over: the case has no drive that could vary: name a key of it")
    return found[0]


def _unit(case: Case, key: str) -> str:
    try:
        return case.keys.unit(key)
    except ValueError as fault:
        raise ValueError(f"--over: {fault}") from None


def _value(case: Case, flag: str, given: str | float, key: str) -> float:
    try:
        return case.keys.number(key, given)
    except ValueError as fault:
        raise ValueError(f"{flag}: {fault}") from None


def _own(case: Case, key: str) -> float:
    own = case.keys.value(key)
    if isinstance(own, tuple) and key in LEVELS:
        told = "is a list over frequency, which has no one level to vary: write one number, or vibeam stability"
        raise CaseError([case.fault(*key.split("."), message=told)])
    return float(own) if isinstance(own, int | float) else float("nan")


def _usual(case: Case, key: str, own: float, system: ImpactSystem) -> tuple[float, float]:
    if key in LEVELS and own > 0:
        return own * DRIVEN[0], own * DRIVEN[1]
    if key != GAP:
        return float("nan"), float("nan")
    omega = frequencies(case, 101)
    free = swing(system, omega, case.amplitude_of(next(iter(case.fidelities)), omega))
    half = max(WIDE * free / _at_contact(case), 2 * abs(own))
    return -half, half


def _at_contact(case: Case) -> float:
    """The contact's gap over the case's, which may be at the sensor."""
    from vibeam.case.reduced_structure import reduced_structure

    scene: Any = case.scene
    if scene.given_mode is not None or scene.stop.gap_at == "contact":
        return 1.0
    return float(reduced_structure(scene, "static_mode", None)[1])


def _name(case: Case, key: str) -> str:
    if key == GAP:
        place = getattr(case.scene.stop, "gap_at", "contact")
        return f"gap at the {place}"
    return NAMES.get(key, key.replace(".", " ").replace("_", " "))


PLACES = 121  # looked at along a row before each change of sign is bracketed
STEP = 3.0  # columns by which a boundary may move from row to row and still be one curve


@dataclass(frozen=True)
class ExactBoundary:
    """A boundary curve of motions that keep clear of the stop between impacts: Hz and the key's SI value, (points,).

    ``branch``: 0 the harder impact, 1 the softer.
    """

    fidelity: str
    boundary: str
    branch: int
    frequency: Array
    value: Array


def exact_boundaries(
    case: Case, name: str, points: GridPoints, axis: VerdictAxis, frequency: Array
) -> Iterator[ExactBoundary]:
    """The boundaries of a model; none beyond plain systems."""
    if points.systems[0].beyond_plain or not points.amplitude.all():
        return
    if axis.key == GAP or axis.key in LEVELS:
        yield from _over_plane(case, name, points, axis)
    else:
        yield from _rows(case, name, points, axis, STEP * float(frequency[1] - frequency[0]))


def _over_plane(case: Case, name: str, points: GridPoints, axis: VerdictAxis) -> Iterator[ExactBoundary]:
    def unit(omega: Array) -> Array:
        return np.asarray(case.amplitude_of(name, omega))

    own = points.amplitude[:, 0] / np.ravel(unit(points.omega[0, :1]))[0]
    over: Literal["gap", "amplitude"] = "gap" if axis.key == GAP else "amplitude"
    up = points.gap[:, 0] if over == "gap" else own
    if not np.all(np.diff(up) > 0):
        return
    for curve in boundaries_over(points.systems[0], over, points.omega[0], up, float(points.gap[0, 0]), unit):
        values = np.interp(curve.value, up, axis.values)
        yield ExactBoundary(name, rows.NAMES[curve.kind], curve.branch, curve.frequency, values)


def _rows(case: Case, name: str, points: GridPoints, axis: VerdictAxis, width: float) -> Iterator[ExactBoundary]:
    """``width``: Hz by which a boundary may move from row to row."""
    model = case.model(name)
    known = dict[tuple[Kind, int], list[list[float]]]()
    for row in range(len(axis.values)):
        system = points.systems[int(points.which[row, 0])]
        if points.restitution is not None:
            system = replace(system, restitution=float(points.restitution[row, 0]))
        omega, gap = points.omega[row], float(points.gap[row, 0])
        own = model.at({axis.key: float(axis.values[row])})
        found = boundaries(
            system, 1.0, (float(omega.min()), float(omega.max())), 1, gap=gap, points=PLACES, kinds=tuple(rows.NAMES),
            per_level=own.amplitude,
        )  # fmt: skip
        for each in found:
            lines = known.setdefault((each.kind, each.branch), [[] for _ in axis.values])
            if each.clear:
                lines[row].append(each.omega / (2 * np.pi))
    for (kind, branch), lines in known.items():
        for curve in joined(lines, width):
            at, hertz = np.array(curve).T
            yield ExactBoundary(name, rows.NAMES[kind], branch, hertz, axis.values[at.astype(int)])


def joined(rows: Sequence[Sequence[float]], width: float) -> list[list[tuple[int, float]]]:
    """Places (row, frequency) joined to curves: each to the nearest in the next row that is within ``width``."""
    open_: list[list[tuple[int, float]]] = []
    done: list[list[tuple[int, float]]] = []
    for row, places in enumerate(rows):
        here, following = list(places), []
        for curve in open_:
            last = curve[-1][1]
            near = min(here, key=lambda each: abs(each - last), default=np.inf)
            if abs(near - last) <= width:
                here.remove(near)
                curve.append((row, near))
                following.append(curve)
            else:
                done.append(curve)
        open_ = [*following, *([(row, each)] for each in here)]
    return [*done, *open_]
