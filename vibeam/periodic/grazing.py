"""Grazing of periodic motions: a motion that touches a stop with no velocity, and the parameter at which it does.

A touch that is about to begin, or an impact whose velocity is about to vanish, makes the map P singular: its slope
grows like 1/v. The motion that grazes is regular all the same: at the touch it goes on as if the stop were not there.
So its flight is computed through a window around the touch in which all stops are away, by the exact flight elsewhere,
and found together with the parameter μ by Newton's method on the 2n + 1 equations

    P(y; μ) − y = 0,      gap(t_m) = 0,  t_m where the contact's velocity is zero

which converges quadratically from either side, for every law. Where several touches come at once (two stops, symmetry)
each has its window.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels import layout
from vibeam.flight.readout import sides
from vibeam.periodic.continuation import NEWTON, SMALL, STALLED, STEP, BranchPoint, BranchSection, Runners
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

AWAY = 1e3  # gap of a stop that is away, in sizes of the motion
SAMPLES = 33  # instants of a window among which the touch is bracketed
PER_RADIAN = 6.0  # instants of a flight for each radian of the fastest mode, among which touches are looked for
INSTANTS = (40, 2000)  # of a flight, least and most
NEAR = 0.15  # share of the motion's size by which a touch or an impact must be about to vanish
TOGETHER = 1.2  # touches that come within so many times the nearest gap come with it
CUT = 0.05  # share of the distance of two touches that is kept between their windows
BEYOND = 1e-9  # share of the motion's size by which the contact may be beyond the stop in a window


class Window(NamedTuple):
    """Phases of the drive from which and to which all stops are away; the contact that touches, and about when."""

    begin: float
    end: float
    contact: int
    touch: float


class Approach(NamedTuple):
    """Touch that may begin, or an impact that may vanish: how far from that, as a share of the motion's size.

    ``struck``: whether it is an impact.
    """

    distance: float
    window: Window
    struck: bool


def approaches(point: BranchPoint) -> list[Approach]:
    """Touches that may begin on a motion, nearest first: the maxima of the contacts in its free flights."""
    system, drive, trace = point.flown.system, point.flown.drive, point.flown.segments.trace
    contacts, found, runner = Contacts.of(system), list[Approach](), point.chart.runner
    for begin, end in _flights(trace):
        count = PER_RADIAN * (end - begin) * max(float(system.omega.max()), drive.omega)
        times = np.linspace(begin, end, int(np.clip(count, *INSTANTS)))
        poses = runner.poses_at(drive, point.flown.segments, times)
        heights = poses[:, 0] @ contacts.rows.T - contacts.gaps
        size = np.abs(contacts.gaps) + np.ptp(poses[:, 0] @ contacts.rows.T, axis=0)
        whole = end - begin >= float(trace[-1, layout.START] + trace[-1, layout.DURATION] - trace[0, layout.START])
        for k in range(len(contacts.gaps)):
            h = heights[:, k]
            tops = np.flatnonzero((h[1:-1] > h[:-2]) & (h[1:-1] >= h[2:])) + 1
            for at in tops.tolist() + ([0] if whole and h[0] >= max(h[1], h[-2]) else []):
                room = ((times[at] - begin) / 2, (end - times[at]) / 2) if at else ((end - begin) / 8,) * 2
                touch = drive.omega * float(times[at])
                window = Window(touch - drive.omega * room[0], touch + drive.omega * room[1], k, touch)
                found.append(Approach(-float(h[at]) / float(size[k]), window, False))
    return sorted(found, key=lambda each: each.distance)


def weakest_impacts(point: BranchPoint) -> list[Approach]:
    """Impacts on a motion that may vanish, weakest first; only those between two free flights."""
    trace, drive, found = point.flown.segments.trace, point.flown.drive, list[Approach]()
    struck = np.flatnonzero((trace[:, layout.END] == layout.IMPACT) & (trace[:, layout.BEFORE] > 0))
    fastest = point.section.size * float(np.linalg.norm(point.flown.system.contact))
    side = sides(trace)
    for i in struck.tolist():
        j = i + 1
        if j >= len(trace) or trace[i, layout.WHAT] != layout.FREE or trace[j, layout.WHAT] != layout.FREE:
            continue
        at = float(trace[j, layout.START])
        room = float(trace[i, layout.DURATION]) / 2, float(trace[j, layout.DURATION]) / 2
        window = Window(drive.omega * (at - room[0]), drive.omega * (at + room[1]), int(side[i]), drive.omega * at)
        found.append(Approach(float(trace[i, layout.BEFORE]) / fastest, window, True))
    return sorted(found, key=lambda each: each.distance)


def _flights(trace: Array) -> Iterator[tuple[float, float]]:
    """Begin and end, s, of the free flights."""
    for row in trace[trace[:, layout.WHAT] == layout.FREE]:
        if row[layout.DURATION] > 0:
            yield float(row[layout.START]), float(row[layout.START] + row[layout.DURATION])


def together(found: list[Approach]) -> Iterator[list[Approach]]:
    """Sets of touches that may come at once: all that are near, then each of the nearest with those like it."""
    near = [each for each in found if each.distance < NEAR]
    if len(near) > 1:
        yield near
    for struck in (False, True):
        alike = [each for each in near if each.struck == struck]
        if alike:
            yield [each for each in alike if each.distance <= TOGETHER * max(alike[0].distance, SMALL)]


def apart(windows: list[Window]) -> list[Window]:
    """The windows in order, cut half way between touches where they overlap."""
    ordered = sorted(windows, key=lambda each: each.touch)
    for k in range(len(ordered) - 1):
        one, other = ordered[k : k + 2]
        if one.end > other.begin:
            middle = (one.touch + other.touch) / 2
            width = CUT * (other.touch - one.touch)
            ordered[k], ordered[k + 1] = one._replace(end=middle - width), other._replace(begin=middle + width)
    return ordered


class Grazed(NamedTuple):
    """Motion that grazes: the place on its branch, the phase of the drive at the touch, the contact."""

    z: Array
    touch: float
    contact: int


@dataclass(frozen=True)
class _Passage:
    """One pass through all windows: where it ends, M, the gap at the touch and its derivatives by y."""

    end: Array
    matrix: Array
    gap: float
    gap_by_state: Array
    touch: float


class GrazingMotion:
    """Equations of the motion that grazes in the first of some windows, in order, in (y, μ): y the state there."""

    def __init__(self, section: BranchSection, windows: list[Window]) -> None:
        self.windows, self.away = windows, Runners()
        self.section = section.moved(windows[0].begin)

    def turn_from(self, phase: float) -> float:
        """Angle by which the drive turns from a phase to where the first window begins."""
        return (self.windows[0].begin - phase) % (2 * np.pi * self.section.periods)

    def solved(self, start: Array) -> Grazed | None:
        """The motion that grazes near ``start`` (2n + 1,), y and the scaled parameter; None where Newton finds none."""
        z, last = start.copy(), np.inf
        try:
            for _ in range(NEWTON + 6):
                here = self._passed(z)
                values = np.append(here.end - z[:-1], here.gap)
                rows = np.zeros((len(z), len(z)))
                rows[:-1, :-1], rows[-1, :-1] = here.matrix - np.eye(len(z) - 1), here.gap_by_state
                rows[:, -1] = self._slope(z)
                step = np.linalg.solve(rows, values)
                length = float(np.linalg.norm(step))
                if length <= SMALL * (1 + float(np.linalg.norm(z))) or (length < STALLED[0] and length >= last / 2):
                    return Grazed(z, here.touch, self.windows[0].contact)
                if not length <= 1.0:
                    return None
                z, last = z - step, length
        except (ArithmeticError, ValueError):
            return None
        return None

    def clear(self, found: Grazed) -> bool:
        """Test whether the motion that grazes keeps clear of the stops in its other windows."""
        near, away = self._charts(found.z)
        contacts, state = Contacts.of(near.system), self.section.state(found.z)
        size = self.section.size / self.section.units[: near.system.size]
        for is_open, begin, end in self._legs():
            chart = (away if is_open else near).at(begin / near.drive.omega)
            flown = chart.flown(state, (end - begin) / (2 * np.pi))
            times = flown.segments.trace[0, layout.START] + np.linspace(0, (end - begin) / near.drive.omega, SAMPLES)
            poses = chart.runner.poses_at(near.drive, flown.segments, times[:-1]) if is_open else np.zeros((0, 2, 1))
            for row, gap in zip(contacts.rows, contacts.gaps, strict=True) if is_open else ():
                if np.max(poses[:, 0] @ row) - gap > BEYOND * float(np.abs(row) @ size):
                    return False
            state = flown.state
        return True

    def _slope(self, z: Array) -> Array:
        """Derivatives (2n + 1,) of the equations by the scaled parameter."""
        ahead = np.zeros_like(z)
        ahead[-1] = STEP
        low, high = self._passed(z - ahead, False), self._passed(z + ahead, False)
        return np.append(high.end - low.end, high.gap - low.gap) / (2 * STEP)

    def _passed(self, z: Array, tangents: bool = True) -> _Passage:
        section, state = self.section, self.section.state(z)
        near, away = self._charts(z)
        touch, gap, row = self._touch(away, near.system, state)
        rows, matrix = np.zeros(2 * near.system.size), np.eye(2 * near.system.size)
        if tangents:
            rows = -np.append(row, 0 * row) @ _between(away, state, self.windows[0].begin, touch)[1]
        for is_open, begin, end in self._legs():
            state, part = _between(away if is_open else near, state, begin, end, tangents)
            matrix = part @ matrix
        scaled, size = matrix * (section.units[:, None] / section.units), section.size / section.units
        shift = float(np.abs(row) @ size[: len(row)])
        return _Passage(section.place(state, 0.0)[:-1], scaled, gap / shift, rows * size / shift, touch)

    def _charts(self, z: Array) -> tuple[StroboscopicMap, StroboscopicMap]:
        """The map of the system, and of the one with its stops away."""
        system, drive = self.section.setting(self.section.value(z))
        size = float(np.linalg.norm(self.section.size / self.section.units))
        away = AWAY * size + abs(system.gap)
        opened = replace(system, gap=away, second_gap=None, law=None, further=None, restitution=1.0)
        runners = self.section.runners.of(system, drive), self.away.of(opened, drive)
        return StroboscopicMap(system, drive, runner=runners[0]), StroboscopicMap(opened, drive, runner=runners[1])

    def _legs(self) -> Iterator[tuple[bool, float, float]]:
        """Parts of a span: with all stops away or not, from phase to phase."""
        begins = [*(each.begin for each in self.windows[1:]), self.windows[0].begin + 2 * np.pi * self.section.periods]
        for window, following in zip(self.windows, begins, strict=True):
            yield True, window.begin, window.end
            yield False, window.end, following

    def _touch(self, away: StroboscopicMap, system: ImpactSystem, state: State) -> tuple[float, float, Array]:
        """Phase at which the contact's velocity is zero, the gap there, the contact's row."""
        window, contacts = self.windows[0], Contacts.of(system)
        row, omega = contacts.rows[window.contact], away.drive.omega
        length = (window.end - window.begin) / omega
        flown = away.flown(state, length / away.period, window.begin / omega)
        begin = float(flown.segments.trace[0, layout.START])  # within a drive period

        def poses(times: Array) -> Array:
            return away.runner.poses_at(away.drive, flown.segments, np.atleast_1d(times))

        times = np.linspace(begin, begin + length, SAMPLES)
        heights = poses(times)[:, 0] @ row
        at = int(np.clip(np.argmax(heights), 1, SAMPLES - 2))

        def speed(t: float) -> float:
            return float(poses(np.array([t]))[0, 1] @ row)

        ends = speed(times[at - 1]), speed(times[at + 1])
        if not ends[0] > 0 > ends[1]:
            raise ArithmeticError
        time = float(brentq(speed, times[at - 1], times[at + 1], xtol=1e-300, rtol=1e-15, disp=False))
        gap = float(contacts.gaps[window.contact] - poses(np.array([time]))[0, 0] @ row)
        return window.begin + (time - begin) * omega, gap, row

    def at_phase(self, found: Grazed, phase: float) -> Array:
        """The z of the motion that grazes, at another phase of the drive."""
        section, state, first = self.section, self.section.state(found.z), self.windows[0].begin
        near, away = self._charts(found.z)
        goal = first + (phase - first) % (2 * np.pi * section.periods)
        for is_open, begin, end in self._legs():
            state = _between(away if is_open else near, state, begin, min(end, goal), False)[0]
            if goal <= end:
                break
        return section.place(state, section.value(found.z))


def _between(
    chart: StroboscopicMap, state: State, begin: float, end: float, tangents: bool = True
) -> tuple[State, Array]:
    """State at phase ``end`` of a motion from ``begin``, and the tangent map (2n, 2n) there."""
    there, share = chart.at(begin / chart.drive.omega), (end - begin) / (2 * np.pi)
    flown = there.flown(state, share)
    if not tangents:
        return flown.state, np.eye(2 * chart.system.size)
    return flown.state, there.jacobian(state, share, flown) / (chart.units[:, None] / chart.units)
