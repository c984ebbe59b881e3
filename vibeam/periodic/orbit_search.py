"""Search for periodic motions at one drive: closed forms of plain systems, settled and shot motions of any system."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vibeam.flight.equilibrium import Contacts, equilibrium
from vibeam.flight.kernels import layout
from vibeam.periodic.closed_orbits import closed_orbits
from vibeam.periodic.lift import lifted, response_alone
from vibeam.periodic.modal_sums import fault, resonant
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import NoOrbit, Reason, shoot
from vibeam.periodic.stroboscopic import MotionEnded, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.several_harmonics import SeveralHarmonics
from vibeam.system.state import State
from vibeam_models.arguments import count as counted
from vibeam_models.arguments import number, refuse, require
from vibeam_models.arrays import Array
from vibeam_models.laws.mechanics import StopLaw

SETTLE = 300  # drive periods flown before a motion is looked for
RETURNS, NEAREST = 200, 4  # periods in which a motion is watched for returns, and how many of them are taken
SETTLED = 1e-4  # share of the motion's size by which a settled one misses itself
ROUNDS = 4  # in which the equivalent hard stop's R follows the orbit's speed
DISTINCT = 1e-7  # share of the motion's size by which two motions differ at the same time


def orbits(
    system: ImpactSystem | SeveralHarmonics,
    drive: Drive,
    periods: int = 1,
    *,
    start: State | Orbit | None = None,
    time: float = 0.0,
) -> tuple[Orbit, ...]:
    """Find periodic motions that repeat after ``periods`` drive periods, stable and unstable, for any law and stops.

    Without ``start``, of a plain system: all motions with one impact in ``periods``, in closed form, harder impact
    first, those that are not admissible among them. Of any other system: the motions that are settled on from static
    equilibrium, and those that shooting leads to from the orbits of the hard stop with the same R and from the motion
    without contact: none, one or more. With ``start``: the one motion near a state at ``time`` (s, the drive's phase 0
    at 0), or near an orbit, of this or of another model of the rig; NoOrbit, a ValueError with the ``reason``, where
    Newton's method leads to none. Under several harmonics states given are those of ``plain``, orbits found are those
    of their ``system`` (``SeveralHarmonics.leave``).

    ValueError of a plain system for an undamped mode at a resonance and for modes without stiffness that no static
    force brings back to the stop; for another ``drive`` than that of several harmonics.

    >>> import vibeam
    >>> system = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, restitution=0.5)
    >>> drive = vibeam.Drive(2.0, 0.1)
    >>> [orbit.stable for orbit in vibeam.orbits(system, drive)]
    [True]
    >>> from dataclasses import replace
    >>> from vibeam_models.laws.compliant import LinearStop
    >>> soft = replace(system, law=LinearStop.matched(1e4, 0.5, 1.0))
    >>> [near] = vibeam.orbits(soft, drive, start=vibeam.orbits(system, drive)[0])
    >>> bool(abs(near.velocity / vibeam.orbits(system, drive)[0].velocity - 1) < 0.1), near.admissible, near.stable
    (True, True, True)
    """
    several = system if isinstance(system, SeveralHarmonics) else None
    own: ImpactSystem = system.system if isinstance(system, SeveralHarmonics) else system
    require("system", own, ImpactSystem)
    require("drive", drive, Drive)
    if several is None and start is None and not own.beyond_plain:
        return closed_orbits(own, drive, periods)
    faults: list[str] = []
    count = counted("periods", periods, faults, least=1)
    begin = number("time", time, faults)
    if several is not None and drive != several.drive:
        faults.append("drive: must be that of the several harmonics")
    refuse("orbits", faults)
    if not drive.omega > 0:
        raise NoOrbit(Reason.NO_PERIOD)
    section = StroboscopicMap(own, drive, begin, several=several)
    if start is not None:
        return (near(section, start, count),)
    return tuple(every(section, count))


def near(section: StroboscopicMap, start: State | Orbit, periods: int) -> Orbit:
    """The motion near a state at the section's time, or near an orbit; NoOrbit without one.

    Near an orbit of the same modes and kind of stop it has the same contacts, near any other contacts if that has some.
    """
    if isinstance(start, Orbit):
        time, state = _lifted(section, start)
        found = shoot(section.at(time), state, periods)
        if not _akin(found, start):
            raise NoOrbit(Reason.LEFT, "", found.corrections)
        return found
    try:
        section, state = section.in_flight(_entered(section, start), periods)
    except MotionEnded as end:
        raise NoOrbit(Reason.ENDED, str(end)) from None
    return shoot(section, state, periods)


def _lifted(section: StroboscopicMap, orbit: Orbit) -> tuple[float, State]:
    """Time, s, and state of the section's system under the contact forces of an orbit."""
    if section.several is None:
        return lifted(orbit, section.system)
    time, state = lifted(orbit, section.several.plain)
    return time, section.several.joined(state, time)


def _entered(section: StroboscopicMap, state: State) -> State:
    """State of the section's system, of one of the modes at the section's time."""
    return state if section.several is None else section.several.enter(state, section.time)


def _akin(found: Orbit, start: Orbit) -> bool:
    """Test whether a motion has the contacts of its start, in cyclic order."""
    own, other = found.system, start.system
    laws = Contacts.of(own).laws + Contacts.of(other).laws
    rigid = not any(law.yields for law in laws)  # as a law yields one contact may become two
    if not rigid or not start.admissible or own.size != other.size:
        return bool(len(found.times)) == bool(len(start.times))
    if start.rests or found.rests:  # after impacts whose number is that of the accumulation
        return start.rests == found.rests
    turns = [np.roll(found.contacts, k).tolist() for k in range(max(len(found.contacts), 1))]
    return start.contacts.tolist() in turns


def every(section: StroboscopicMap, periods: int) -> Iterator[Orbit]:
    """Distinct motions from all starts, stable ones first, of these the harder impact first."""
    found: list[Orbit] = []
    for begin, state in _starts(section, periods):
        try:
            moved, there = section.at(begin).in_flight(state, periods)
            orbit = shoot(moved, there, periods)
        except (NoOrbit, MotionEnded):
            continue
        if not any(_same(section, orbit, other) for other in found):
            found.append(orbit)
    speeds = [-np.nan_to_num(orbit.velocity) for orbit in found]
    yield from (found[k] for k in sorted(range(len(found)), key=lambda k: (not found[k].stable, speeds[k])))


def _same(section: StroboscopicMap, orbit: Orbit, other: Orbit) -> bool:
    """Test whether two motions are one, in some drive period."""
    if len(orbit.times) != len(other.times):
        return False
    ahead = (other.time - orbit.time) / section.period % 1.0
    state, there = section.flown(orbit.state, ahead, orbit.time).state, section.at(other.time)
    centre = there.vector(other.state)
    for _ in range(orbit.periods):
        if np.linalg.norm(there.vector(state) - centre) <= DISTINCT * np.linalg.norm(centre):
            return True
        state = there.flown(state, 1.0).state
    return False


def _starts(section: StroboscopicMap, periods: int) -> Iterator[tuple[float, State]]:
    """Times, s, and states from which motions are shot at."""
    system = section.system if section.several is None else section.several.plain
    still, alone = equilibrium(system), response_alone(system, section.drive, 0.0)
    for begin in (still, *(_thrown(section, still, sign) for sign in (1, -1))):
        for state in _returns(section.at(0.0), begin, periods):
            yield 0.0, state
    if np.isfinite(alone.displacement).all():
        yield 0.0, alone if section.several is None else section.several.joined(alone)
    for side in range(len(Contacts.of(system).gaps)):
        for orbit in _equivalent(system, section.drive, side, periods):
            yield _lifted(section, orbit)


def _returns(section: StroboscopicMap, begin: State, periods: int) -> list[State]:
    """States of the motion settled on from ``begin`` that come nearest to themselves after ``periods``.

    One of a motion that repeats, the nearest few of another: unstable motions lie beside them.
    """
    strobes: list[Array] = []
    drive, start, hold = section.drive, _entered(section, begin), RETURNS + periods
    section.runner.steady(
        [drive.omega], drive.amplitude, start, SETTLE, hold, "contact", layout.OUTPUT_ALONE, None, strobes
    )
    rows = (strobes[0].reshape(len(strobes[0]), -1) * section.units)[:, section.unknowns]
    if len(rows) <= hold:  # the motion ended on the way
        return []
    size = max(float(np.linalg.norm(rows, axis=1).max()), np.finfo(float).tiny)
    apart = np.linalg.norm(rows[periods:] - rows[:-periods], axis=1) / size
    nearest = np.argsort(apart, kind="stable")[: 1 if apart[-1] < SETTLED else NEAREST]
    return [State(*strobes[0][k]) for k in nearest]


def _thrown(section: StroboscopicMap, still: State, sign: int) -> State:
    """Equilibrium with the contact moving away from the first stop, or toward it, as fast as the base moves."""
    system = section.system if section.several is None else section.several.plain
    speed = sign * section.drive.omega * abs(section.drive.amplitude)
    return State(still.displacement, still.velocity - speed * system.contact / system.mobility)


def _equivalent(system: ImpactSystem, drive: Drive, side: int, periods: int) -> Iterator[Orbit]:
    """Orbits of the plain system with one contact and the law's R at the orbit's speed; none where it has none."""
    contacts = Contacts.of(system)
    constant = contacts.laws[side].constant
    plain = replace(
        system, contact=contacts.rows[side], gap=float(contacts.gaps[side]), law=None, coupling=None, second_gap=None,
        further=None, restitution=system.restitution if constant is None else constant,
    )  # fmt: skip
    if fault(plain) or resonant(plain, drive.omega, periods):
        return
    for root in (0, 1):
        found: Orbit | None = None
        for _ in range(ROUNDS if system.law is not None else 1):
            if system.law is not None:
                speed = drive.omega * abs(drive.amplitude) if found is None else found.velocity
                plain = replace(plain, restitution=_restitution(system.law, plain.mobility, speed))
            every = closed_orbits(plain, drive, periods)
            found = every[min(root, len(every) - 1)] if every else None
            if found is None:
                break
        if found is not None:
            yield found


def _restitution(law: StopLaw, mobility: float, speed: float) -> float:
    """R of a law at an impact ``speed``, m/s; of one that yields, of a free mass of that mobility."""
    if law.yields:
        return law.free_impact(1 / mobility, speed).restitution
    return float(law.rebound(np.array([speed]))[0] / speed)
