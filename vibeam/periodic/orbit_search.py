"""Search for periodic motions at one drive: closed forms of plain systems, settled and shot motions of any system."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vibeam.flight.equilibrium import Contacts, equilibrium
from vibeam.periodic.closed_orbits import closed_orbits
from vibeam.periodic.lift import response_alone
from vibeam.periodic.modal_sums import fault, resonant
from vibeam.periodic.motion_at import lifted_to, returns, shot
from vibeam.periodic.orbit import Orbit
from vibeam.periodic.shooting import NoOrbit, Reason, shoot
from vibeam.periodic.stroboscopic import MotionEnded, StroboscopicMap
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.several_harmonics import SeveralHarmonics
from vibeam.system.state import State
from vibeam_models.arguments import count as counted
from vibeam_models.arguments import number, refuse, require
from vibeam_models.laws.mechanics import StopLaw

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
        return (shot(section, start, count),)
    return tuple(every(section, count))


def every(section: StroboscopicMap, periods: int) -> Iterator[Orbit]:
    """Distinct motions from all starts, stable ones first, of these the harder impact first."""
    found: list[Orbit] = []
    for there, state in _starts(section, periods):
        try:
            orbit = shoot(*there.in_flight(state, periods), periods)
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


def _starts(section: StroboscopicMap, periods: int) -> Iterator[tuple[StroboscopicMap, State]]:
    """Sections and states from which motions are shot at."""
    system = section.system if section.several is None else section.several.plain
    still, alone = equilibrium(system), response_alone(system, section.drive, 0.0)
    for begin in (still, *(_thrown(section, still, sign) for sign in (1, -1))):
        for state in returns(section, section.at(0.0).entered(begin), periods):
            yield section.at(0.0), state
    if np.isfinite(alone.displacement).all():
        yield section.at(0.0), alone if section.several is None else section.several.joined(alone)
    for side in range(len(Contacts.of(system).gaps)):
        for orbit in _equivalent(system, section.drive, side, periods):
            yield lifted_to(section, orbit)


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
