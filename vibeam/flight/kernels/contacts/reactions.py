"""Accelerations of a pose: without constraint, with contacts held, and which contacts a force holds.

Which of the contacts touched are held is Gauss' principle of least constraint: the accelerations are as near to those
of free motion, in the metric of the mass, as stops that only push allow. Where an acceleration is round-off the jerk
decides.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import (
    NOISE,
    along,
    factor,
    invert,
    is_within,
    multiplier,
    multiplier_size,
    one_sided,
    size_along,
    without_rows,
)
from vibeam.flight.kernels.contacts.course import LOADED
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load_value import load_at
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.regimes import layout as regime_row
from vibeam.flight.kernels.regimes.laws import force, force_rate
from vibeam_models.arrays import Array, Index

AT_STOP = 4.0  # round-offs within which a gap is none
ROUNDS = 4  # times the contacts touched, after which what is held is left as it is


@kernel
def is_rigid(engine: ContactEngine, j: int) -> bool:
    """True where the contact's stop does not yield."""
    return bool(engine.laws[j, regime_row.FAMILY] == regime_row.IMPULSIVE)


@kernel
def is_curved(engine: ContactEngine, j: int) -> bool:
    """True where the contact's stop yields by a law that is integrated."""
    return bool(engine.laws[j, regime_row.FAMILY] == regime_row.CURVED)


@kernel
def each(engine: ContactEngine, which: int, j: int) -> int:
    """Row of the status that holds the ``which``-th number of contact j."""
    return int(row.EACH + which * engine.rows.shape[0] + j)


@kernel
def braked(engine: ContactEngine, vector: Array, k: int) -> float:
    """Damping force on mode k."""
    if engine.numbers[row.COUPLED] == 0.0:
        return float(engine.damping[k] * vector[k])
    total = 0.0
    for j in range(vector.shape[0]):
        total += engine.damper[k, j] * vector[j]
    return total


@kernel
def braked_at_most(engine: ContactEngine, vector: Array, k: int) -> float:
    """The sizes of its parts, added up."""
    if engine.numbers[row.COUPLED] == 0.0:
        return float(engine.damping[k] * abs(vector[k]))
    total = 0.0
    for j in range(vector.shape[0]):
        total += abs(engine.damper[k, j]) * abs(vector[j])
    return total


@kernel
def depth(engine: ContactEngine, pose: Array, j: int) -> float:
    """Penetration of the contact into its stop, negative outside."""
    return float(along(engine.rows, j, pose[0]) - engine.gaps[j])


@kernel
def clearance(engine: ContactEngine, pose: Array, j: int) -> tuple[float, float]:
    """Gap of a contact, and how large it may be and still be none, by the round-off of its parts."""
    parts = abs(engine.gaps[j]) + size_along(engine.rows, j, pose[0])
    return -depth(engine, pose, j), float(AT_STOP * NOISE * parts)


@kernel
def push_of(engine: ContactEngine, pose: Array, j: int) -> float:
    """Force of a stop that yields and pushes, as its law has it; of a linear one of either sign."""
    deep, rate = depth(engine, pose, j), along(engine.rows, j, pose[1])
    if engine.laws[j, regime_row.FAMILY] == regime_row.LINEAR:
        return float(engine.laws[j, regime_row.STIFFNESS] * deep + engine.laws[j, regime_row.DAMPING] * rate)
    return float(force(engine.laws[j], deep, rate))


@kernel
def push_rate(engine: ContactEngine, pose: Array, j: int, second: float) -> float:
    """Its rate, with the contact's acceleration."""
    rate = along(engine.rows, j, pose[1])
    if engine.laws[j, regime_row.FAMILY] == regime_row.LINEAR:
        return float(engine.laws[j, regime_row.STIFFNESS] * rate + engine.laws[j, regime_row.DAMPING] * second)
    deep = depth(engine, pose, j)
    return force_rate(engine.laws[j], deep, rate, second) if deep > 0.0 else 0.0


@joined
def drive_at(engine: ContactEngine, status: Array) -> tuple[float, float, float, float]:
    """Ω²B, sin φ, Ω cos φ and 1; under a load 1, u, u' and |u|."""
    if engine.course.numbers[LOADED] > 0.0:
        u, rate = load_at(engine.course, int(status[row.PIECE]), status[layout.CLOCK])
        return 1.0, u, rate, abs(u)
    cosine, sine = phase(engine.drive, status[layout.CLOCK])
    return engine.drive[layout.STRENGTH], sine, engine.drive[layout.W] * cosine, 1.0


@kernel
def pull(engine: ContactEngine, pose: Array, status: Array) -> None:
    """Set vectors[PULL], [PULL_SIZE], [DRIVE_RATE]: η'' = l Ω²B sin φ + s − Dη' − ω²η − Σ rowᵀ F of those pushing."""
    strength, sine, rate, size = drive_at(engine, status)
    vectors = engine.vectors
    for k in range(pose.shape[1]):
        push, spring = engine.load[k] * strength, engine.spring[k] * pose[0, k]
        parts = abs(push) * size + abs(engine.static[k]) + braked_at_most(engine, pose[1], k) + abs(spring)
        vectors[row.PULL, k] = push * sine + engine.static[k] - braked(engine, pose[1], k) - spring
        vectors[row.PULL_SIZE, k], vectors[row.DRIVE_RATE, k] = parts, push * rate
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING:
            pressed = push_of(engine, pose, j)
            for k in range(pose.shape[1]):
                vectors[row.PULL, k] -= engine.rows[j, k] * pressed
                vectors[row.PULL_SIZE, k] += abs(engine.rows[j, k] * pressed)


@kernel
def hold(engine: ContactEngine, pose: Array, status: Array, picks: Index, count: int) -> None:
    """Set vectors[ACCELERATION], [JERK] with the contacts held, [RATE] and [RATE_SIZE]; needs ``pull``, ``factor``."""
    vectors = engine.vectors
    acceleration, rate, sizes = vectors[row.ACCELERATION], vectors[row.RATE], vectors[row.RATE_SIZE]
    without_rows(engine, picks, count, vectors[row.PULL], acceleration)
    for k in range(pose.shape[1]):
        spring = engine.spring[k] * pose[1, k]
        rate[k] = vectors[row.DRIVE_RATE, k] - braked(engine, acceleration, k) - spring
        sizes[k] = abs(vectors[row.DRIVE_RATE, k]) + braked_at_most(engine, vectors[row.PULL_SIZE], k) + abs(spring)
        sizes[k] += engine.omega[k] * vectors[row.PULL_SIZE, k]
    for j in range(engine.rows.shape[0]):
        if status[each(engine, row.CONDITION, j)] == row.PUSHING:
            growth = push_rate(engine, pose, j, along(engine.rows, j, acceleration))
            for k in range(pose.shape[1]):
                rate[k] -= engine.rows[j, k] * growth
                sizes[k] += abs(engine.rows[j, k] * growth)
    without_rows(engine, picks, count, rate, vectors[row.JERK])


@kernel
def seen(value: float, size: float) -> float:
    """The value, 0 where it is the round-off of its parts."""
    return value if abs(value) > NOISE * size else 0.0


@kernel
def speed_of(engine: ContactEngine, pose: Array, j: int) -> float:
    """Velocity toward the stop; 0 where it is the round-off of its parts."""
    return seen(along(engine.rows, j, pose[1]), size_along(engine.rows, j, pose[1]))


@kernel
def pressed_ones(engine: ContactEngine, pose: Array, status: Array, leaving: int) -> int:
    """Those of the contacts held whose force is none that round-off could have made, but for ``leaving``."""
    picks, held, count, found = engine.picks[row.LIST], int(status[row.HELD]), 0, 0
    if held == 0:
        return 0
    for j in range(engine.rows.shape[0]):
        if (held >> j) & 1 > 0:
            picks[count] = j
            count += 1
    pull(engine, pose, status)
    factor(engine.gram, picks, count, engine.lower)
    invert(engine, count)
    for i in range(count):
        value = multiplier(engine, picks, count, i, engine.vectors[row.PULL])
        size = multiplier_size(engine, picks, count, i, engine.vectors[row.PULL_SIZE])
        if picks[i] != leaving and value > NOISE * size:
            found |= 1 << picks[i]
    return found


@kernel
def decide(engine: ContactEngine, pose: Array, status: Array, touched: int, leaving: int, least: float) -> None:
    """Set what every rigid contact is in next: of those ``touched``, by Gauss' principle; the others are away.

    ``leaving``: the contact at the root of its force, or NONE; speeds up to ``least`` are none.
    """
    picks, still, count = engine.picks, engine.picks[row.STILL], 0
    for j in range(engine.rows.shape[0]):
        picks[row.IS_HELD, j], picks[row.IS_GONE, j], picks[row.IS_IMPLIED, j] = 0, int(j == leaving), 0
        engine.small[row.FOUND_ORDER, j], engine.small[row.FOUND_RISE, j] = 0.0, 0.0
        if not is_rigid(engine, j) or (touched >> j) & 1 == 0:
            continue
        speed = speed_of(engine, pose, j)
        if speed < -least:
            engine.small[row.FOUND_ORDER, j], engine.small[row.FOUND_RISE, j] = 1.0, -speed
        else:
            still[count] = j
            count += 1
    if count > 0:
        pull(engine, pose, status)
        one_sided(engine, still, count, engine.vectors[row.PULL], 1.0)
        for i in range(count):
            if engine.small[row.TRIAL, i] > 0.0 and still[i] != leaving:
                picks[row.IS_HELD, still[i]] = 1
        for _ in range(ROUNDS * count + ROUNDS):
            changed = judge(engine, pose, status, count)
            if changed == row.NONE:
                break
            held = picks[row.IS_HELD, changed]
            picks[row.IS_HELD, changed], picks[row.IS_GONE, changed] = 1 - held, held
    note(engine, status)


@kernel
def is_just_touched(engine: ContactEngine, status: Array, j: int) -> bool:
    """True for a stop that yields and is touched without being pushed or drawn away, beyond round-off."""
    touching = status[each(engine, row.ORDER, j)] == regime_row.TOUCHING
    return bool(touching and not is_rigid(engine, j) and status[each(engine, row.RISE, j)] == 0.0)


@kernel
def note(engine: ContactEngine, status: Array) -> None:
    """Put what was found into the status.

    A stop that yields and is touched without being pushed or drawn away pushes, so far with no force, while another
    one pushes: what reaches it comes through that one, by more derivatives than are looked at.
    """
    held, pushed, active = 0, 0, False
    for j in range(engine.rows.shape[0]):
        pushes = status[each(engine, row.CONDITION, j)] == row.PUSHING
        active = active or (pushes and not is_just_touched(engine, status, j))
    for j in range(engine.rows.shape[0]):
        condition = each(engine, row.CONDITION, j)
        if is_just_touched(engine, status, j):
            status[condition] = row.PUSHING if active else row.AWAY
        if is_rigid(engine, j):
            kept = engine.picks[row.IS_HELD, j] > 0
            status[condition] = row.KEPT if kept else row.IMPLIED if engine.picks[row.IS_IMPLIED, j] > 0 else row.AWAY
            order = engine.small[row.FOUND_ORDER, j]
            status[each(engine, row.ORDER, j)] = order if order != row.UNDECIDED else 0.0
            status[each(engine, row.RISE, j)] = engine.small[row.FOUND_RISE, j]
        if status[condition] == row.KEPT:
            held |= 1 << j
        if status[condition] == row.PUSHING:
            pushed |= 1 << j
    status[row.HELD], status[row.PUSHED] = held, pushed
    status[layout.KIND] = layout.RESTING if held > 0 else regime_row.CONTACT if pushed > 0 else layout.FREE


@kernel
def judge(engine: ContactEngine, pose: Array, status: Array, count: int) -> int:
    """Starts of the contacts without velocity; the first that is to be held or let go, NONE where all is well."""
    picks, still, some, number = engine.picks, engine.picks[row.STILL], engine.picks[row.LIST], 0
    for i in range(count):
        if picks[row.IS_HELD, still[i]] > 0:
            some[number] = still[i]
            number += 1
    factor(engine.gram, some, number, engine.lower)
    hold(engine, pose, status, some, number)
    changed = row.NONE
    for i in range(count):
        j = still[i]
        picks[row.IS_IMPLIED, j] = 0
        if picks[row.IS_HELD, j] == 0 and is_within(engine, some, number, j):
            picks[row.IS_IMPLIED, j] = 1
            engine.small[row.FOUND_ORDER, j], engine.small[row.FOUND_RISE, j] = 0.0, 0.0
        elif picks[row.IS_HELD, j] == 0:
            open_up(engine, j)
            if engine.small[row.FOUND_ORDER, j] == row.UNDECIDED and changed == row.NONE:
                changed = j
    invert(engine, number)
    first = row.NONE
    for i in range(number):
        press(engine, some, number, i)
        if engine.small[row.FOUND_ORDER, some[i]] == row.UNDECIDED and first == row.NONE:
            first = some[i]
    return first if first != row.NONE else changed


@kernel
def press(engine: ContactEngine, picks: Index, count: int, place: int) -> None:
    """Start of the force of a held contact; undecided where it is to be let go."""
    vectors, small, j = engine.vectors, engine.small, picks[place]
    pressed = seen(
        multiplier(engine, picks, count, place, vectors[row.PULL]),
        multiplier_size(engine, picks, count, place, vectors[row.PULL_SIZE]),
    )
    small[row.FOUND_ORDER, j], small[row.FOUND_RISE, j] = 0.0, 0.0
    if pressed > 0.0:
        return
    growth = seen(
        multiplier(engine, picks, count, place, vectors[row.RATE]),
        multiplier_size(engine, picks, count, place, vectors[row.RATE_SIZE]),
    )
    if growth > 0.0:
        small[row.FOUND_ORDER, j], small[row.FOUND_RISE, j] = 1.0, growth
    elif growth < 0.0 or pressed < 0.0:
        small[row.FOUND_ORDER, j] = row.UNDECIDED
    else:
        small[row.FOUND_ORDER, j] = regime_row.TOUCHING


@kernel
def open_up(engine: ContactEngine, j: int) -> None:
    """Start of the gap of a contact at rest at its stop; undecided where it is to be held."""
    vectors, small = engine.vectors, engine.small
    second = seen(along(engine.rows, j, vectors[row.ACCELERATION]), size_along(engine.rows, j, vectors[row.PULL_SIZE]))
    third = seen(along(engine.rows, j, vectors[row.JERK]), size_along(engine.rows, j, vectors[row.RATE_SIZE]))
    at_root = engine.picks[row.IS_GONE, j] > 0
    small[row.FOUND_RISE, j] = 0.0
    if third < 0.0 and (at_root or second >= 0.0):
        small[row.FOUND_ORDER, j], small[row.FOUND_RISE, j] = 3.0, -third
    elif second < 0.0:
        small[row.FOUND_ORDER, j], small[row.FOUND_RISE, j] = 2.0, -second
    elif at_root and second == 0.0 and third == 0.0:
        small[row.FOUND_ORDER, j] = regime_row.TOUCHING
    else:
        small[row.FOUND_ORDER, j] = row.UNDECIDED
