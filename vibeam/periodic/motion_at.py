"""The motion of a system at a drive that a start leads to, by the cheapest exact way.

A start is a state, or a periodic motion of this or of another model. Ways, cheapest first, and what shows that each has
led to the motion asked for:

| way | takes | checked |
|---|---|---|
| closed form | a plain system, a motion with one impact in the same periods | the nearer root; its flight certified |
| shot | any: from the start's state, of other modes by its contact forces | back to round-off, not sooner; contacts |
| followed | a motion of the same modes: drive and gap go on from its own in steps | each step as shot |
| simulated | a state, a motion, or none, which is static equilibrium | what is settled on, as shot |

Of contacts a shot motion has some if its start has. Over a whole grid closed forms are arrays (``orbit_map``), and
branches with what they meet are ``follow``'s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import Enum

import numpy as np

from vibeam.flight.equilibrium import Contacts, equilibrium
from vibeam.flight.kernels import layout
from vibeam.periodic.closed_orbits import closed_orbits
from vibeam.periodic.continuation import Runners
from vibeam.periodic.lift import lifted
from vibeam.periodic.modal_sums import resonant
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import NEWTON, NoOrbit, Reason, shoot
from vibeam.periodic.stroboscopic import MotionEnded, StroboscopicMap
from vibeam.system.impact_system import Drive
from vibeam.system.state import State
from vibeam_models.arrays import Array

TRIES = 11  # steps from a motion to another drive, at most
SHORTER, LONGER = 4, 2  # factors by which a step is shortened where it fails, and grows where it does not
SETTLE = 300  # drive periods flown before a motion is looked for
RETURNS, NEAREST = 200, 4  # periods in which a motion is watched for returns, and how many of them are taken
SETTLED = 1e-4  # share of the motion's size by which a settled one misses itself
MODES = ("omega", "zeta", "load", "static", "coupling")


Alike = Callable[[Orbit, Orbit], bool]  # whether a motion is of the kind of its start


class Way(Enum):
    """Ways to a motion, cheapest first."""

    CLOSED_FORM = "closed form"
    SHOT = "shot"
    FOLLOWED = "followed"
    SIMULATED = "simulated"


def akin(found: Orbit, start: Orbit) -> bool:
    """Test whether a motion has the contacts of its start, in cyclic order; of another rig or as stops yield, any."""
    own, other = found.system, start.system
    laws = Contacts.of(own).laws + Contacts.of(other).laws
    rigid = not any(law.yields for law in laws)  # as a law yields one contact may become two
    if not rigid or not start.admissible or own.size != other.size:
        return touching(found, start)
    if start.rests or found.rests:  # after impacts whose number is that of the accumulation
        return start.rests == found.rests
    turns = [np.roll(found.contacts, k).tolist() for k in range(max(len(found.contacts), 1))]
    return start.contacts.tolist() in turns


def touching(found: Orbit, start: Orbit) -> bool:
    """Test whether a motion has contacts where its start has some."""
    return bool(len(found.times)) == bool(len(start.times))


def motion_at(
    section: StroboscopicMap, start: State | Orbit | None = None, periods: int = 1, *,
    ways: Sequence[Way] = tuple(Way), alike: Alike = akin, steps: int = NEWTON, kept: bool = False,
) -> Orbit:  # fmt: skip
    """The motion of a section's system at its drive that repeats after ``periods``, by the first of ``ways`` there.

    ``start``: at the section's time, or an orbit, which the motion has to be ``alike``. ``steps``: of Newton's method,
    at most; ``kept``: see ``shoot``. NoOrbit, with the last reason, where no way leads to one.
    """
    refused = NoOrbit(Reason.DIVERGED, "no way from such a start")
    for way in ways:
        try:
            if way is Way.SIMULATED:
                return _simulated(section, start, periods, steps)
            if way is Way.SHOT and start is not None:
                return shot(section, start, periods, alike, steps, kept)
            if way is Way.CLOSED_FORM and isinstance(start, Orbit) and _plain(section, start, periods):
                return _closed(section, start)
            if way is Way.FOLLOWED and isinstance(start, Orbit) and same_modes(section, start):
                return _followed(section, start, periods, alike, steps)
        except NoOrbit as reason:
            refused = reason
    raise refused


def _plain(section: StroboscopicMap, start: Orbit, periods: int) -> bool:
    """Test whether the motion from a start may be one of the closed forms."""
    one, system = len(start.times) == 1 and not start.rests and start.periods == periods, section.system
    plain = section.several is None and not system.beyond_plain
    return one and plain and not resonant(system, section.drive.omega, periods)


def _closed(section: StroboscopicMap, start: Orbit) -> Orbit:
    """The closed form whose impact velocity is the nearest to that of the start."""
    found = closed_orbits(section.system, section.drive, start.periods)
    near = min(found, key=lambda each: abs(each.velocity - start.velocity), default=None)
    if near is None or not near.admissible:
        raise NoOrbit(Reason.LEFT if found else Reason.FOLD)
    return near


def same_modes(section: StroboscopicMap, orbit: Orbit) -> bool:
    """Test whether a section's system has the modes and contacts of an orbit's, so that states are the same."""
    one, other = section.system, orbit.system
    alike = all(np.array_equal(getattr(one, name), getattr(other, name)) for name in MODES)
    return section.several is None and alike and np.array_equal(Contacts.of(one).rows, Contacts.of(other).rows)


def shot(
    section: StroboscopicMap, start: State | Orbit, periods: int, alike: Alike = akin, steps: int = NEWTON,
    kept: bool = False,
) -> Orbit:  # fmt: skip
    """The motion that Newton's method leads to from a state at the section's time, or from an orbit."""
    if isinstance(start, Orbit):
        found = shoot(*_beside(section, start), periods, steps, kept=kept)
        if not alike(found, start):
            raise NoOrbit(Reason.LEFT, "", found.corrections)
        return found
    state = section.entered(start)
    try:
        there = (section, state) if kept else section.in_flight(state, periods)
    except MotionEnded as end:
        raise NoOrbit(Reason.ENDED, str(end)) from None
    return shoot(*there, periods, steps, kept=kept)


def _beside(section: StroboscopicMap, orbit: Orbit) -> tuple[StroboscopicMap, State]:
    """Section and state of its system beside an orbit: its own at the same phase, or under its contact forces."""
    closed = bool(len(orbit.times)) and orbit.times[0] <= orbit.time  # whose state is just after an impact
    if closed or not same_modes(section, orbit):
        return lifted_to(section, orbit)
    return section.at(orbit.time * orbit.drive.omega / section.drive.omega), orbit.state


def lifted_to(section: StroboscopicMap, orbit: Orbit) -> tuple[StroboscopicMap, State]:
    """Section in the longest flight of an orbit, and the state of its system there under the orbit's contact forces."""
    several = section.several
    time, state = lifted(orbit, section.system if several is None else several.plain)
    return section.at(time), state if several is None else several.joined(state, time)


def _followed(section: StroboscopicMap, start: Orbit, periods: int, alike: Alike, steps: int) -> Orbit:
    """The motion that an orbit leads to as frequency, drive and gap go on together from its own."""
    system, drive, runners = section.system, section.drive, Runners()
    first, last = (np.array([a.omega, a.amplitude, b.gap]) for a, b in ((start.drive, start.system), (drive, system)))
    orbit, done, step, refused = start, 0.0, 1.0 / SHORTER, NoOrbit(Reason.DIVERGED)
    for _ in range(TRIES):
        share, there = min(done + step, 1.0), section
        if share < 1.0:
            omega, amplitude, gap = (first + share * (last - first)).tolist()
            moved, driven = replace(system, gap=gap) if first[2] != last[2] else system, Drive(omega, amplitude)
            there = StroboscopicMap(moved, driven, runner=runners.of(moved, driven))
        try:
            orbit = shot(there, orbit, periods, alike, steps)
        except NoOrbit as reason:
            step, refused = step / SHORTER, reason
            continue
        if share == 1.0:
            return orbit
        done, step = share, LONGER * step
    raise refused


def _simulated(section: StroboscopicMap, start: State | Orbit | None, periods: int, steps: int) -> Orbit:
    """The motion that a flight from the start settles on, or passes nearest to."""
    if isinstance(start, Orbit):
        section, begin = _beside(section, start)
    else:
        begin = section.entered(equilibrium(section.system) if start is None else start)
    refused = NoOrbit(Reason.DRIFTS)
    try:
        for state in returns(section, section.flown(begin, -section.time / section.period % 1.0).state, periods):
            try:
                return shoot(*section.at(0.0).in_flight(state, periods), periods, steps)
            except NoOrbit as reason:
                refused = reason
    except MotionEnded as end:
        raise NoOrbit(Reason.ENDED, str(end)) from None
    raise refused


def returns(section: StroboscopicMap, begin: State, periods: int) -> list[State]:
    """States at the drive's phase 0 that come nearest to themselves after ``periods``, of the motion from ``begin``.

    One of a motion that repeats, the nearest few of another: unstable motions lie beside them.
    """
    strobes: list[Array] = []
    drive, hold = section.drive, RETURNS + periods
    section.runner.steady(
        [drive.omega], drive.amplitude, begin, SETTLE, hold, "contact", layout.OUTPUT_ALONE, None, strobes
    )
    rows = (strobes[0].reshape(len(strobes[0]), -1) * section.units)[:, section.unknowns]
    if len(rows) <= hold:  # the motion ended on the way
        return []
    size = max(float(np.linalg.norm(rows, axis=1).max()), np.finfo(float).tiny)
    apart = np.linalg.norm(rows[periods:] - rows[:-periods], axis=1) / size
    nearest = np.argsort(apart, kind="stable")[: 1 if apart[-1] < SETTLED else NEAREST]
    return [State(*strobes[0][k]) for k in nearest]
