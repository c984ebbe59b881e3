"""A motion of the flight solver beside the arbitrary-precision one from the same doubles, burst by burst.

A burst is short enough for the motion's own sensitivity, so that every impact of a long motion can be judged: the next
burst's truth starts from the solver's state after the last.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import vibeam

sys.path[:0] = [str(Path(__file__).parent.parent / place) for place in ("support", "independent")]

import events  # noqa: E402
from random_systems import Case  # noqa: E402
from sensitivity import Blur, Knot, Rest, blur, drift  # noqa: E402

SAFE = 64.0  # last digits that a correct solver may lose in one state
BAR = 1e-11  # relative error of a time that is always allowed
FAINT = 0.02  # share of v²/2|a| that the blur of the contact may be where an impact is one beyond doubt
HORIZON = 60.0  # drive periods after which a burst ends without impacts
STEPS = 2000.0  # radians of the fastest motion after which it does: a bound on the time that its truth takes
FEEBLE = 1e-4  # share of the velocities' scale below which impacts are those of an accumulation
SHORTER = 1e-6  # share by which flights of an accumulation do so at least
EXTINCT = 1e-200  # scale of velocities below which doubles say nothing more of a motion
FINER = (45, 1e-25)  # digits and ``tiny`` of a truth that is cut within an accumulation
LONGEST = 4000  # impacts of a true chatter that are followed


@dataclass
class Tally:
    """What was compared and what came of it."""

    impacts: int = 0
    missed: int = 0
    invented: int = 0
    wrong: int = 0  # times beyond 1e-11 relative and beyond their blur
    faint: int = 0  # bursts that ended at an impact weaker than round-off can tell from a miss
    chatters: int = 0
    over_bound: int = 0  # chatters whose reported remainder is less than the true one
    releases: int = 0
    late: int = 0  # releases at a wrong time
    too_long: int = 0  # chatters that the truth does not follow to their end
    undecided: int = 0  # motions given up where the state's last digits decide when, or whether, it meets the stop
    worst_relative: float = 0.0  # error of a time over the time, where its blur allows 1e-11
    worst_blur: float = 0.0  # error of a time over its blur
    faults: list[str] = field(default_factory=list)

    def add(self, other: Tally) -> None:
        for name, value in vars(other).items():
            mine = getattr(self, name)  # counts and lists add up, the worst stays
            setattr(self, name, max(mine, value) if name.startswith("worst") else mine + value)


def true_motion(case: Case, t_start: float, digits: int = 30, tiny: float = 1e-10) -> events.Motion:
    """The arbitrary-precision motion from the very doubles of a case."""
    system, drive, start = case
    rows = [getattr(system, name).tolist() for name in ("omega", "zeta", "contact", "load")]
    modes = events.Modes(*rows, gap=system.gap, restitution=system.restitution, static=system.static.tolist())
    state = events.State(start.displacement.tolist(), start.velocity.tolist(), start.resting, t_start)
    return events.Motion(modes, events.Drive(drive.omega, drive.amplitude), state, digits=digits, tiny=tiny)


def burst(case: Case, t_start: float, count: int) -> tuple[Tally, vibeam.State, float]:
    """At most ``count`` impacts of both motions compared; the solver's state and time where the burst ends."""
    readout = Tally()
    path, cut = _cut(case, t_start, count)
    part = vibeam.simulate(*case[:2], cut, case.start, t_start=t_start, max_impacts=100_000)
    if part.ended is not vibeam.Ended.COMPLETE or not _is_begin(part.impact_times, path.impact_times, cut):
        readout.faults.append(f"cut at {cut!r}: {part.ended}, impacts {len(part.impact_times)}")
    motion = _true_burst(case, t_start, cut, part)
    if float(motion.time) < cut:
        readout.too_long += 1
    else:
        _compare(case, t_start, part, motion, readout)
    return readout, part.state, cut


def _accumulates(path: vibeam.Trajectory, first: int, weak: float) -> bool:
    """Whether from an impact on all are weak and their flights grow shorter, unlike those of a mode left to itself."""
    flights = np.diff(path.impact_times[first:])
    return bool(path.impact_velocities[first:].max() < weak and flights[-1] < (1 - SHORTER) * flights[0])


def _is_begin(part: np.ndarray, whole: np.ndarray, cut: float) -> bool:
    """Whether ``part`` holds the times of ``whole`` up to the cut; several may be the same double as it."""
    some = len(part)
    return np.array_equal(part, whole[:some]) and bool(np.all(part <= cut)) and bool(np.all(whole[some:] >= cut))


def _true_burst(case: Case, t_start: float, cut: float, part: vibeam.Trajectory) -> events.Motion:
    """The true motion up to ``cut``, with every impact before it where ``part`` completes no accumulation.

    Short flights end in the accumulation's limit, and the impacts up to there are not listed. Where the limit lies
    beyond ``cut``, some of them lie before it: so shorter flights are followed, with the digits that they take.
    """
    motion = true_motion(case, t_start)
    motion.run(t_end=cut, count=LONGEST)
    if len(part.chatters) == 0 and motion.events and motion.events[-1].kind == "rest" and float(motion.time) > cut:
        motion = true_motion(case, t_start, *FINER)
        motion.run(t_end=cut, count=LONGEST)
    return motion


def _cut(case: Case, t_start: float, count: int) -> tuple[vibeam.Trajectory, float]:
    """A motion and a time within it: in the longest flight after half of the impacts, or in the first rest."""
    system, drive, start = case
    fastest = max(drive.omega, (system.omega * (1 + 2 * system.zeta)).max())
    end = t_start + min(HORIZON * 2 * np.pi / max(drive.omega, 1e-3 * fastest), STEPS / fastest)
    path = vibeam.simulate(system, drive, end, start, t_start=t_start, max_impacts=count + 1)
    most = count
    while LONGEST > most < len(path.impact_times) and _accumulates(path, most // 2, FEEBLE * _speed(case)):
        most *= 4  # on to the accumulation's end, if it has one
        path = vibeam.simulate(system, drive, end, start, t_start=t_start, max_impacts=most + 1)
    later = path.rests[(path.rests[:, 0] > t_start) & (path.rests[:, 1] > path.rests[:, 0])]
    if len(later):
        return path, float(later[0].mean())
    if path.ended is vibeam.Ended.COMPLETE:
        return path, path.t_end
    k = count // 2 + int(np.argmax(np.diff(path.impact_times[count // 2 : count + 1])))
    return path, float(path.impact_times[k : k + 2].mean())


def _speed(case: Case) -> float:
    """Scale of the contact's velocities."""
    system, drive, start = case
    steady = system.load * drive.omega**2 * drive.amplitude / np.maximum(np.maximum(system.omega, drive.omega), 1e-300)
    parts = np.abs(start.velocity) + system.omega * np.abs(start.displacement) + np.abs(steady)
    return float(np.abs(system.contact) @ parts)


def _compare(case: Case, t_start: float, path: vibeam.Trajectory, motion: events.Motion, readout: Tally) -> None:
    begun, x, v = t_start, np.array(case.start.displacement), np.array(case.start.velocity)
    found = [event for event in motion.events if event.kind != "rest"]
    if case.start.resting and found and found[0].kind == "release":
        release = found.pop(0)
        begun, x, v = float(release.time), *(_doubles(row) for row in (release.displacement, release.velocity))
        _compare_release(path, begun, readout)
    rest = next((event for event in motion.events if event.kind == "rest" and float(event.time) > t_start), None)
    hits = [event for event in found if event.kind == "impact"]
    listed = hits[: len(path.impact_times)] if rest is not None else hits
    knots = [Knot(float(e.time), float(e.speed), _doubles(e.displacement), _doubles(e.velocity)) for e in listed]
    slack = _compare_impacts(case, path, begun, x, v, knots, readout)
    if rest is not None and np.isfinite(slack) and len(path.chatters):
        readout.chatters += 1
        over, bound = path.chatters[0]
        if abs(over - float(rest.time)) > bound + slack + BAR * float(rest.time):
            readout.over_bound += 1
            readout.faults.append(f"chatter over at {over!r} ± {bound:.2g}, truly at {float(rest.time)!r}")


def _compare_release(path: vibeam.Trajectory, when: float, readout: Tally) -> None:
    readout.releases += 1
    ended = path.rests[0, 1] if len(path.rests) else path.t_start
    if abs(ended - when) > 1e-7 * (path.t_end - path.t_start) + 1e-11 * when:
        readout.late += 1
        readout.faults.append(f"released at {ended!r}, truly at {when!r}")


def _compare_impacts(
    case: Case, path: vibeam.Trajectory, begun: float, x: np.ndarray, v: np.ndarray, knots: list[Knot], readout: Tally
) -> float:
    """Error that the time of the last firm impact may have; infinite after a fault. The rest goes into the tally."""
    slack = 0.0
    system, drive, start = case
    plastic = [k for k, knot in enumerate(knots) if knot.speed <= 0]
    knots = knots[: plastic[0]] if plastic else knots
    rest = Rest(path.t_start, start.displacement, start.velocity) if start.resting else None
    spread = blur(system, drive, begun, x, v, knots, rest) if knots else Blur(np.zeros(0), np.zeros(0))
    times, speeds = path.impact_times, path.impact_velocities
    for k, knot in enumerate(knots):
        pull = abs(system.contact @ drift(system, drive, knot.time, knot.displacement, knot.velocity))
        if SAFE * spread.time[k] * pull > FAINT * knot.speed:
            readout.faint += 1
            return BAR * knot.time + SAFE * spread.time[k]
        readout.impacts += 1
        if k >= len(times):
            readout.missed += 1
            readout.faults.append(f"missed {knot.time!r} at {knot.speed:.3g}")
            return np.inf
        off = abs(times[k] - knot.time)
        slack = allowed = BAR * knot.time + SAFE * spread.time[k]
        if SAFE * spread.time[k] <= BAR * knot.time:
            readout.worst_relative = max(readout.worst_relative, off / knot.time)
        readout.worst_blur = max(readout.worst_blur, off / spread.time[k])
        if off > allowed or abs(speeds[k] - knot.speed) > BAR * speeds.max() + SAFE * spread.speed[k]:
            late = times[k] > knot.time
            kind = "missed" if late and abs(times[k] - knot.time) > 1e3 * allowed else "wrong"
            kind = "invented" if not late and abs(times[k] - knot.time) > 1e3 * allowed else kind
            setattr(readout, kind, getattr(readout, kind) + 1)
            readout.faults.append(
                f"{kind}: {times[k]!r} at {speeds[k]:.6g}, truly {knot.time!r} at {knot.speed:.6g}, "
                f"blur {spread.time[k]:.2g} s, {spread.speed[k]:.2g}"
            )
            return np.inf
    extra = times[len(knots) :]
    if len(extra) and not len(path.chatters) and not plastic:
        weak = speeds[len(knots)] < 1e-6 * speeds.max()
        if weak:
            readout.faint += 1
        else:
            readout.invented += 1
            readout.faults.append(f"invented {extra[0]!r} at {speeds[len(knots)]:.3g}")
    return slack


def _on_the_brink(case: Case, t: float) -> bool:
    """Whether the start lies within last digits of the stop, so slow that they decide when it is met first."""
    system, drive, start = case
    c, displacement, velocity = system.contact, start.displacement, start.velocity
    round_off = SAFE * np.finfo(float).eps * (abs(system.gap) + float(np.abs(c * displacement).sum()))
    pull = abs(float(c @ drift(system, drive, t, displacement, velocity)))
    near = abs(system.gap - float(c @ displacement)) <= round_off
    return near and not start.resting and FAINT * float(c @ velocity) ** 2 <= 2 * pull * round_off


def _doubles(values: list) -> np.ndarray:
    return np.array([float(value) for value in values])


def follow(case: Case, impacts: int, each: int = 10, seconds: float = np.inf) -> Tally:
    """Bursts of ``each`` impacts until so many are judged, nothing more comes, or the truth has taken so long."""
    begun = time.process_time()
    total, t, start, quiet = Tally(), 0.0, case.start, 0
    while total.impacts < impacts and quiet < 8 and not total.faults and time.process_time() < begun + seconds:
        now = Case(case.system, case.drive, start)
        if _speed(now) < EXTINCT:
            break
        if _on_the_brink(now, t):
            total.undecided += 1
            break
        try:
            readout, start, t = burst(now, t, each)
        except (ArithmeticError, ValueError):  # nearer to the stop than doubles can tell: the truth cannot start
            total.undecided += 1
            break
        quiet = 0 if readout.impacts + readout.releases else quiet + 1
        total.add(readout)
    return total
