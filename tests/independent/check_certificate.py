"""A checker of certificates in interval arithmetic, from the equations of motion alone.

Per segment it takes the start (doubles, to the bit), writes the motion in closed form with ball arithmetic
(``ball_motion``), and from it the signals that the kind of segment calls for: in flight every gap, on a stop its force,
in retreat from it penetration and pull. All of them must be covered from the segment's start to its end; a piece is
halved where the enclosure (``ball_signal``) does not decide, at most ``DEPTH`` times.

A segment that starts at a root of a signal has there one of order m that is exact in the model and round-off in the
doubles: the derivatives below m are taken as zero, after a look that they are round-off, and g(t)/t^m is what must be
positive.

Then the joins: every segment must start where the one before it ended, in time, in the drive's phase and in all modes,
velocities changed by the law where it ended with an impact. What follows an integrated contact is taken as given.
"""

from __future__ import annotations

import flint
import numpy as np
from ball_motion import FLIGHT, PUSH, REST, RETREAT, Equations
from ball_tail import tail_bounds
from flint import arb

DEPTH = 60
OPEN, CLOSES = 0.0, 1.0
GRANTED = 1e-12
ROUND_OFF = 2.0**-48  # share of a signal's parts to which doubles write it
MOST = 0.01  # share of a segment's length that is granted for that
JOINED = 1e-9  # share of the motion's size by which doubles may miss a join
SPAN_END, IMPACT, RELEASE, CHATTER, STUCK, PASS = range(6)
AFTER = {  # what may follow each kind and end
    (FLIGHT, IMPACT): {FLIGHT, PUSH}, (FLIGHT, CHATTER): {REST}, (FLIGHT, STUCK): {REST}, (FLIGHT, PASS): {FLIGHT},
    (REST, RELEASE): {FLIGHT}, (PUSH, RELEASE): {FLIGHT, RETREAT, PUSH}, (RETREAT, PASS): {FLIGHT, PUSH},
}  # fmt: skip


def is_open(signal, low, high, depth=DEPTH):
    """Whether g > 0 is proved on [low, high]."""
    least = signal.least(low)
    if (least is not None and least > 0) or signal.enclose(0, low, high) > 0:
        return True
    if depth == 0 or signal.derivative(0, (low + high) / 2) <= 0:
        return False
    middle = (low + high) / 2
    return is_open(signal, low, middle, depth - 1) and is_open(signal, middle, high, depth - 1)


def lifts(signal, order, high, depth=DEPTH):
    """Whether g > 0 is proved on (0, high]."""
    if signal.lifting(order, high) > 0:
        return True
    return depth > 0 and lifts(signal, order, high / 2, depth - 1) and is_open(signal, high / 2, high)


def closes(signal, low, end, slack, depth=DEPTH):
    """Whether g is proved positive on [low, end − slack] and to pass zero once within ``slack`` of ``end``."""
    after = end + slack
    if not signal.derivative(0, after) < 0 or not signal.derivative(0, max_of(end - slack, low)) > 0:
        return False
    return falls(signal, low, max_of(end - slack, low), after, depth)


def falls(signal, low, before, after, depth):
    """Whether g > 0 on [low, s] and g' < 0 on [s, after] for some s ≤ before."""
    if signal.enclose(1, low, after) < 0:
        return True
    middle = (low + before) / 2
    return (
        depth > 0 and low < before and is_open(signal, low, middle) and falls(signal, middle, before, after, depth - 1)
    )


def max_of(a, b):
    """The larger of two balls, by their middles."""
    return a if a.mid() > b.mid() else b


def check(certificate, slack=1e-10, bits=200):
    """Faults found (a list of texts), and the number of pieces proved.

    ``slack``: how near to its written end a signal must close, relative to the segment's length; at least ``GRANTED``
    of the slowest mode's time is granted to the doubles in which starts and ends are written, and the time in which the
    signal passes ``ROUND_OFF`` of its parts (weak impacts of a chatter are not located better).
    """
    flint.ctx.prec = bits
    own, sizes = Equations(certificate.system, certificate.drive), sizes_of(certificate)
    keys = [key_of(certificate, i) for i in range(len(certificate.kinds))]
    motions, segments, joins, faults = {}, {}, {}, []
    for i, key in enumerate(keys):
        if key not in segments:
            motions[key] = motion_of(certificate, own, i)
            pieces = certificate.pieces[certificate.pieces[:, 0] == i]
            checked = motions[key] is not None and certificate.durations[i] > 0
            segments[key] = check_segment(certificate, own, motions[key], i, pieces, slack) if checked else []
        found = list(segments[key])
        if i + 1 < len(keys):
            if (key, keys[i + 1]) not in joins:
                joins[key, keys[i + 1]] = check_join(certificate, own, motions[key], i, sizes)
            found += check_time(certificate, i) + joins[key, keys[i + 1]]
        faults += [f"segment {i}: {text}" for text in found]
    ends = [motions[key] for key in keys]
    faults += [text for tail in certificate.tails for text in check_tail(certificate, own, ends, tail)]
    proved = sum(ends[int(i)] is not None for i in certificate.pieces[:, 0])
    return faults, proved


def key_of(certificate, i):
    """All that is claimed of a segment but its time: of two that are the same to the bit one proof does.

    What follows a retreat decides which of its signals closes.
    """
    names = ("kinds", "sides", "ends", "clocks", "durations", "orders", "roots")
    mine = certificate.pieces[certificate.pieces[:, 0] == i][:, 1:]
    numbers = tuple(float(getattr(certificate, name)[i]) for name in names)
    return numbers, *map(float, certificate.kinds[i + 1 : i + 2]), certificate.starts[i].tobytes(), mine.tobytes()


def motion_of(certificate, own, i):
    """The modal signals of a segment; None of contact that is integrated."""
    if integrated(certificate, i):
        return None
    return own.motion(int(certificate.kinds[i]), side_of(certificate, i), *start_of(certificate, i))


def sizes_of(certificate):
    """Largest displacement of any mode, or way within a segment, and largest velocity, over all segments."""
    places, speeds = np.abs(certificate.starts).max(axis=2).T
    moving = certificate.system.omega[certificate.system.omega > 0]
    turned = places.max() * moving.min() if len(moving) else 0.0
    return max(places.max(), (speeds * certificate.durations).max()), max(speeds.max(), turned)


def integrated(certificate, i):
    """Whether a segment is contact with a law that is not linear."""
    return certificate.kinds[i] == PUSH and hasattr(certificate.system.law, "exponent")


def side_of(certificate, i):
    """The stop of a segment."""
    return int(certificate.sides[i])


def start_of(certificate, i):
    """State and drive time at a segment's start."""
    return certificate.starts[i], certificate.clocks[i]


def signals_of(certificate, own, motion, i):
    """The signals that must stay positive over a segment, by number, and the one that must close, or None."""
    kind, side, end = int(certificate.kinds[i]), side_of(certificate, i), int(certificate.ends[i])
    clock = certificate.clocks[i]
    if kind == FLIGHT:
        found = {s: own.gap(motion, s) for s in range(len(own.stops))}
        return found, side if end in (IMPACT, CHATTER, STUCK) else None
    if kind in (REST, PUSH):
        return {2 + side: own.force(motion, side, kind, clock)}, 2 + side if end == RELEASE else None
    found = {4 + side: own.gap(motion, side), 6 + side: own.force(motion, side, kind, clock)}
    closing = 6 + side if i + 1 < len(certificate.kinds) and certificate.kinds[i + 1] == PUSH else 4 + side
    return {number: negative(signal) for number, signal in found.items()}, closing if end == PASS else None


def negative(signal):
    """−g."""
    found = type(signal)()
    found.add(-1, signal)
    return found


def check_segment(certificate, own, motion, i, pieces, slack):
    """Faults of one segment: of every signal that it calls for."""
    signals, closing = signals_of(certificate, own, motion, i)
    duration, faults = certificate.durations[i], []
    moving = certificate.system.omega[certificate.system.omega > 0]
    least = GRANTED / min(moving) if len(moving) else 0.0
    for number, signal in signals.items():
        order = int(certificate.orders[i]) if certificate.roots[i] == number else 0
        mine = pieces[pieces[:, 4] == number]
        found = check_cover(mine, duration, closing == number)
        if not found and not signal.put_on_root(order, scale(own, certificate, i, number)):
            found = ["it is said to start at a root and does not"]
        if not found:
            size = scale(own, certificate, i, number) + signal.size() + summed(own, certificate, motion, i, number)
            near = max(slack * duration, least, min(blurred(signal, duration, size), MOST * duration))
            found = [text for piece in mine for text in check_piece(signal, order, piece, near)]
        faults += [f"signal {number}: {text}" for text in found]
    return faults


def blurred(signal, duration, size):
    """Time in which a signal passes the round-off of its parts at the end of a segment; 0 where it stands still."""
    rate = abs(signal.derivative(1, arb(float(duration))))
    return float((ROUND_OFF * size / rate).mid()) if rate > 0 else 0.0


def scale(own, certificate, i, number):
    """Size of the parts of a signal, mode by mode."""
    pose = certificate.starts[i]
    row, gap = own.stops[number % 2]
    parts = [abs(c) * abs(arb(float(x))) for c, x in zip(row, pose[0], strict=True)]
    size = abs(gap) + sum(parts, arb(0))
    if number % 4 < 2:
        return size
    if certificate.kinds[i] != REST:
        rates = sum((abs(c) * abs(arb(float(v))) for c, v in zip(row, pose[1], strict=True)), arb(0))
        return own.spring * size + own.damping * rates
    pushes = [abs(load) * own.strength + abs(static) for load, static in zip(own.load, own.static, strict=True)]
    springs = [omega**2 * abs(arb(float(x))) for omega, x in zip(own.omega, pose[0], strict=True)]
    pulls = [abs(c) * (push + pull) for c, push, pull in zip(row, pushes, springs, strict=True)]
    return sum(pulls, arb(0)) / own.mobility


def summed(own, certificate, motion, i, number):
    """Size of what the modes have in a gap, or in the force of a stop that yields, before it cancels in their sum."""
    row, _ = own.stops[number % 2]
    places = sum((abs(c) * x.size() for c, x in zip(row, motion, strict=True)), arb(0))
    if number % 4 < 2 or certificate.kinds[i] == REST:
        return places
    rates = sum((abs(c) * x.rate().size() for c, x in zip(row, motion, strict=True)), arb(0))
    return own.spring * places + own.damping * rates


def check_cover(pieces, duration, closing):
    """Whether the pieces reach from 0 to the end, and the last one says how it ends."""
    if not len(pieces):
        return ["no piece covers it"]
    if pieces[0, 1] != 0 or np.any(pieces[1:, 1] != pieces[:-1, 1] + pieces[:-1, 2]):
        return ["its pieces leave a hole"]
    if abs(pieces[-1, 1] + pieces[-1, 2] - duration) > 4e-16 * duration:
        return ["its pieces do not reach its end"]
    if (pieces[-1, 3] == CLOSES) != closing or np.any(pieces[:-1, 3] == CLOSES):
        return ["it closes where the segment does not end so, or does not where it does"]
    return []


def check_piece(signal, order, piece, slack):
    """Faults of one piece; a signal closes within ``slack`` s of its written end."""
    low, high, claim = arb(piece[1]), arb(piece[1]) + arb(piece[2]), piece[3]
    if claim == OPEN:
        good = lifts(signal, order, high) if order and piece[1] == 0 else is_open(signal, low, high)
        return [] if good else [f"not proved open on ({piece[1]}, {piece[1] + piece[2]}]"]
    if claim != CLOSES:
        return [f"nothing is claimed from {piece[1]} on"]
    begins = [low] if not order or piece[1] > 0 else [high * share for share in (0.5, 0.75, 2.0**-10)]
    for begin in begins:
        lifted = begin == low or lifts(signal, order, begin)
        if lifted and closes(signal, begin, high, arb(slack)):
            return []
    return [f"not proved to close at {float(high.mid())}"]


def check_time(certificate, i):
    """Faults of the time at which the next segment begins."""
    duration, times = certificate.durations[i], certificate.times
    late = times[i] + duration
    if abs(times[i + 1] - late) > JOINED * max(duration, 1e-5 * abs(late)):
        return [f"the next one starts at {times[i + 1]}, it ends at {late}"]
    return []


def check_join(certificate, own, motion, i, sizes):
    """Faults of the step from segment i to the next, its time apart."""
    kind, end, after = int(certificate.kinds[i]), int(certificate.ends[i]), int(certificate.kinds[i + 1])
    batch = integrated(certificate, i) and end == SPAN_END and after == PUSH
    if not batch and after not in AFTER.get((kind, end), set()):
        return [f"one of kind {kind} that ends with {end} cannot be followed by one of kind {after}"]
    duration, w = certificate.durations[i], certificate.drive.omega
    turns = (certificate.clocks[i] + duration - certificate.clocks[i + 1]) * w / (2 * np.pi)
    faults = []
    if w > 0 and certificate.drive.amplitude != 0 and abs(turns - round(turns)) > JOINED:
        faults.append("the next one starts at another phase of the drive")
    if motion is None:
        return faults
    reached, velocities = state_after(certificate, own, motion, i)
    # in a motion that always starts from rest at 0 only the ends of its segments have a size
    fastest = max(float(abs(x.derivative(1, arb(float(duration)))).mid()) for x in motion)
    given, scales = certificate.starts[i + 1], (max(sizes[0], fastest * duration), max(sizes[1], fastest))
    for name, found, start, size in zip(("places", "velocities"), (reached, velocities), given, scales, strict=True):
        off = max(float(abs(a - arb(float(b))).mid()) for a, b in zip(found, start, strict=True))
        if not off <= JOINED * size:
            faults.append(f"{name} at the start of the next one are off by {off:.2g}")
    return faults


def state_after(certificate, own, motion, i):
    """Displacements and velocities (balls) at the end of segment i, the impact included."""
    end, side, t = int(certificate.ends[i]), side_of(certificate, i), arb(float(certificate.durations[i]))
    reached = [x.derivative(0, t) for x in motion]
    velocities = [x.derivative(1, t) for x in motion]
    hard = not hasattr(certificate.system.law, "stiffness")
    if hard and end in (IMPACT, CHATTER, STUCK):
        row = own.stops[side][0]
        before = sum((c * v for c, v in zip(row, velocities, strict=True)), arb(0))
        after = coefficient(certificate.system, before) * before if end == IMPACT else arb(0)
        impulse = -(before + after) / own.mobility
        velocities = [v + c * impulse for v, c in zip(velocities, row, strict=True)]
    return reached, velocities


def coefficient(system, speed):
    """R at an impact velocity (a ball, whose middle is taken for a law of the velocity)."""
    return arb(system.restitution) if system.law is None else arb(float(system.law.at(float(speed.mid()))))


def check_tail(certificate, own, ends, tail):
    """Faults of what is claimed of an accumulation that was completed."""
    i, side = int(tail[0]), side_of(certificate, int(tail[0]))
    reached, velocities = state_after_bounce(certificate, own, ends[i], i)
    pose = np.array([[float(x.mid()) for x in reached], [float(v.mid()) for v in velocities]])
    gap = own.gap(own.motion(FLIGHT, 0, pose, certificate.clocks[i] + certificate.durations[i]), side)
    speed = gap.derivative(1, arb(0))
    system = certificate.system
    found = tail_bounds(own, system.law, system.restitution, gap, side, speed)
    if found is None:
        return [f"segment {i}: no bound of what the accumulation still takes"]
    if not (arb(tail[1]) <= found[0] and found[1] <= arb(tail[2])):
        return [f"segment {i}: the accumulation takes {found[0]} to {found[1]}, not {tail[1]} to {tail[2]}"]
    return []


def state_after_bounce(certificate, own, motion, i):
    """The state just after the impact with which a completed accumulation begins to be completed."""
    side, t = side_of(certificate, i), arb(float(certificate.durations[i]))
    velocities, row = [x.derivative(1, t) for x in motion], own.stops[side][0]
    before = sum((c * v for c, v in zip(row, velocities, strict=True)), arb(0))
    impulse = -(1 + coefficient(certificate.system, before)) * before / own.mobility
    return [x.derivative(0, t) for x in motion], [v + c * impulse for v, c in zip(velocities, row, strict=True)]
