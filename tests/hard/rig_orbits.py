"""Orbits of a rig: fixed points of the flight, whose disturbances decay or grow as the multipliers say."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator
from verdict import Verdict

import vibeam

if TYPE_CHECKING:
    from rig_checks import Rig

CLOSED = 1e-9  # of the orbit's size: how closely it returns, times what its multipliers make of round-off

MARGIN = 0.03  # distance of the largest multiplier from the unit circle below which its side is not looked at

AWAY = 1e-8  # of the orbit's size: a disturbance

LONGEST = 400  # spans that are waited for it to decay or to grow


def orbits_hold(rig: Rig, rng: Generator, verdict: Verdict) -> None:
    """One impact per one and per two drive periods."""
    if rig.system.beyond_plain or rig.drive.amplitude == 0:
        return
    for periods in (1, 2):
        try:
            found = vibeam.orbits(rig.system, rig.drive, periods)
        except ValueError:  # an undamped mode at resonance, a mode that nothing brings back
            verdict.count("orbits: resonance without damping")
            continue
        for orbit in found:
            verdict.count("orbits, admissible" if orbit.admissible else "orbits, not admissible")
            if orbit.admissible:
                _returns(orbit, verdict)
                _stands(orbit, rng, verdict)


def _returns(orbit: vibeam.Orbit, verdict: Verdict) -> None:
    """The flight from just after the impact comes back to it, with no impact on the way."""
    span, begin = orbit.span, orbit.time
    path = vibeam.simulate(orbit.system, orbit.drive, begin + 1.5 * span, orbit.state, t_start=begin, max_impacts=50)
    times = path.impact_times[path.impact_times > begin + 1e-9 * span]  # R = 0: it may start with one of round-off
    verdict.hold(len(times) == 1, f"orbit: {len(times)} impacts in a flight of one, {_told(orbit)}")
    if len(times) == 1:
        later = path.modes_at(begin + 1.25 * span)
        first = path.modes_at(begin + 0.25 * span)
        off = _norm(orbit, later - first) / _size(orbit)
        grown = max(1.0, abs(orbit.multipliers[0])) * max(1.0, _size(orbit) / _speed(orbit))
        verdict.measure("orbit returns, over what round-off allows", off / (CLOSED * grown), 1.0)
        late = abs(times[0] - begin - span) / span
        verdict.measure("orbit's span", late / grown, 1e-9)


def _stands(orbit: vibeam.Orbit, rng: Generator, verdict: Verdict) -> None:
    """A disturbance is gone, or has grown, after as many spans as the largest multiplier asks for."""
    largest = abs(orbit.multipliers[0])
    if abs(largest - 1) < MARGIN or largest == 0:
        return
    spans = int(np.ceil(np.log(1e3) / abs(np.log(largest)))) + 2
    if spans > LONGEST or _grazing(orbit):
        return
    away = _after(orbit, spans, rng)
    if away is None:
        return
    verdict.count("orbits disturbed, stable" if orbit.stable else "orbits disturbed, unstable")
    if orbit.stable:
        verdict.hold(away < 0.3, f"orbit: stable, {away:.2g} of a disturbance left after {spans} spans, {_told(orbit)}")
    else:
        verdict.hold(away > 3, f"orbit: unstable, {away:.2g} of a disturbance after {spans} spans, {_told(orbit)}")


def _after(orbit: vibeam.Orbit, spans: int, rng: Generator) -> float | None:
    """A disturbance's growth over so many spans from a quarter span after the impact."""
    begin = orbit.time + 0.25 * orbit.span
    path = vibeam.simulate(orbit.system, orbit.drive, begin, orbit.state, t_start=orbit.time)
    push = rng.normal(size=orbit.system.size)
    amount = AWAY * _size(orbit)
    start = replace(path.state, velocity=path.state.velocity + amount * push / np.linalg.norm(push))
    end = vibeam.simulate(orbit.system, orbit.drive, begin + spans * orbit.span, start, t_start=begin, max_impacts=5000)
    if end.ended is not vibeam.Ended.COMPLETE:
        return None
    last = np.stack([end.state.displacement, end.state.velocity])
    return _norm(orbit, last - np.stack([path.state.displacement, path.state.velocity])) / amount


def _grazing(orbit: vibeam.Orbit) -> bool:
    """Whether its impact is so weak that a disturbance is no small one."""
    return _speed(orbit) < 1e-3 * _size(orbit)


def _speed(orbit: vibeam.Orbit) -> float:
    """The impact's velocity in √energy, v/√S."""
    return orbit.velocity / float(np.linalg.norm(orbit.system.contact))


def _size(orbit: vibeam.Orbit) -> float:
    return max(_norm(orbit, np.stack([orbit.state.displacement, orbit.state.velocity])), _speed(orbit))


def _norm(orbit: vibeam.Orbit, pose: np.ndarray) -> float:
    rate = np.where(orbit.system.omega > 0, orbit.system.omega, orbit.drive.omega)
    return float(np.hypot(np.linalg.norm(rate * pose[0]), np.linalg.norm(pose[1])))


def _told(orbit: vibeam.Orbit) -> str:
    return f"{orbit.periods} periods, multiplier {abs(orbit.multipliers[0]):.4g}"
