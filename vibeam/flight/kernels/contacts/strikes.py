"""The impact at several contacts at once: Newton's law, one contact at a time; endless series by their limit.

Rigid contacts that are struck in the same instant have no unique outcome: it depends on which gives way first, of which
a rigid stop says nothing. What is computed here is one choice, the limit of impacts one shortly after another:

- Contacts that approach are struck in turn, the fastest first (of equally fast ones the first declared). Each gets the
  impulse p = −(1 + R) v⁻ / (w M⁻¹ wᵀ) of its own law, which changes the velocities of all others by the mass matrix of
  the contacts, G_ij = w_i M⁻¹ w_jᵀ; a contact that then approaches anew is struck again, until none approaches.
- A contact that is held, pressed by a force, stays where an impulse elsewhere presses it (v⁻ = 0: Newton's law gives it
  v⁺ = 0) and is released where it pulls. Its reaction is the least impulse that keeps it from approaching, so that the
  mobility of the struck contact is that of the system held there.
- A sequence without end is followed until what still approaches is round-off, and that is taken out.
- A stop that yields takes no part: its force is finite.

No step adds energy. In the symmetric landing of a bar on two stops this law favours one end; Newton's law with both
impulses at once (Moreau) would not, but gives Newton's cradle wrong, which this one gives right.
"""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.algebra import NOISE, along, factor, one_sided, size_along, solve, without_rows
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import each, is_rigid, pull, speed_of
from vibeam.flight.kernels.layout import FAITHFUL, FLOOR, LATE, NEAR, NEAR_MODES
from vibeam.flight.kernels.regimes.laws import accumulation, restitution
from vibeam_models.arrays import Array, Index

ENDLESS = 100_000  # impulses in one instant
TIED = 1e-12  # share of the fastest approach by which another may be slower and still count as equally fast


@kernel
def first_of(engine: ContactEngine, pose: Array, status: Array) -> int:
    """The first contact to be struck of those touched, NONE where none approaches; notes the fastest approach."""
    touched, fastest = int(status[row.TOUCHED]), 0.0
    for j in range(engine.rows.shape[0]):
        if (touched >> j) & 1 > 0 and is_rigid(engine, j):
            fastest = max(fastest, speed_of(engine, pose, j))
    status[row.FIRST], status[row.STRIKES], status[row.HARDEST] = fastest, 0.0, 0.0
    return next_of(engine, pose, status)


@kernel
def next_of(engine: ContactEngine, pose: Array, status: Array) -> int:
    """The contact that approaches fastest; NONE where none does beyond round-off."""
    free, fastest = int(status[row.TOUCHED]) & ~int(status[row.PRESSED]), 0.0
    if status[row.STRIKES] >= ENDLESS:
        return row.NONE
    for j in range(engine.rows.shape[0]):
        if (free >> j) & 1 > 0 and is_rigid(engine, j):
            fastest = max(fastest, speed_of(engine, pose, j))
    if fastest <= NOISE * status[row.FIRST] or fastest == 0.0:
        return row.NONE
    for j in range(engine.rows.shape[0]):
        if (free >> j) & 1 > 0 and is_rigid(engine, j) and speed_of(engine, pose, j) >= (1.0 - TIED) * fastest:
            return j
    return row.NONE


@kernel
def strike(engine: ContactEngine, pose: Array, status: Array, j: int) -> float:
    """One impulse at contact j, the pressed ones answering: its velocity before."""
    before, direction = along(engine.rows, j, pose[1]), engine.vectors[row.DIRECTION]
    count = some_of(engine, int(status[row.PRESSED]), engine.picks[row.STILL])
    set_direction(engine, j, engine.picks[row.STILL], count)
    turned = 1.0 + restitution(engine.laws[j], engine.curves[j], before)
    impulse = turned * before / along(engine.rows, j, direction)
    for k in range(pose.shape[1]):
        pose[1, k] = difference(pose[1, k], impulse * direction[k])
    pressed = 0
    for i in range(count):
        at = engine.picks[row.STILL, i]
        if along(engine.rows, at, direction) <= NOISE * size_along(engine.rows, at, direction):
            pressed |= 1 << at
    status[row.PRESSED] = pressed
    stop(engine, pose, pressed)
    top = each(engine, row.TOP, j)
    status[top], status[row.HARDEST] = max(status[top], before), max(status[row.HARDEST], before)
    status[row.STRIKES] += 1.0
    return before


@kernel
def some_of(engine: ContactEngine, mask: int, picks: Index) -> int:
    """The contacts of a mask into ``picks``; their number."""
    count = 0
    for j in range(engine.rows.shape[0]):
        if (mask >> j) & 1 > 0:
            picks[count] = j
            count += 1
    return count


@kernel
def set_direction(engine: ContactEngine, j: int, picks: Index, count: int) -> None:
    """vectors[DIRECTION]: change of the velocities by a unit impulse at contact j, less sign, ``picks`` answering."""
    direction = engine.vectors[row.DIRECTION]
    for k in range(direction.shape[0]):
        direction[k] = engine.rows[j, k]
    if count == 0:
        return
    one_sided(engine, picks, count, engine.rows[j], -1.0)
    for i in range(count):
        for k in range(direction.shape[0]):
            direction[k] += engine.small[row.TRIAL, i] * engine.rows[picks[i], k]


@kernel
def stop(engine: ContactEngine, pose: Array, mask: int) -> None:
    """Take the velocity of the contacts of a mask out by the least impulse."""
    picks, values = engine.picks[row.LIST], engine.small[row.MULTIPLIER]
    count = some_of(engine, mask, picks)
    if count == 0:
        return
    factor(engine.gram, picks, count, engine.lower)
    for i in range(count):
        values[i] = along(engine.rows, picks[i], pose[1])
    solve(engine.lower, count, values)
    for k in range(pose.shape[1]):
        total = 0.0
        for i in range(count):
            total += values[i] * engine.rows[picks[i], k]
        pose[1, k] = difference(pose[1, k], total)


@kernel
def difference(a: float, b: float) -> float:
    """a − b, and 0 where that is no more than their round-off: one mode brought to rest lies still."""
    left = a - b
    return left if abs(left) > NOISE * abs(b) else 0.0


@kernel
def put(engine: ContactEngine, pose: Array, mask: int) -> None:
    """Move the contacts of a mask exactly to their stops with the least energy."""
    picks, values = engine.picks[row.LIST], engine.small[row.MULTIPLIER]
    count = some_of(engine, mask, picks)
    if count == 0:
        return
    for i in range(count):
        values[i] = along(engine.rows, picks[i], pose[0]) - engine.gaps[picks[i]]
    if count == 1:
        values[0] /= engine.soft[picks[0], picks[0]]
    else:
        factor(engine.soft, picks, count, engine.lower)
        solve(engine.lower, count, values)
    for k in range(pose.shape[1]):
        total = 0.0
        for i in range(count):
            total += values[i] * engine.rows[picks[i], k]
        pose[0, k] -= engine.yields[k] * total


@kernel
def time_left(engine: ContactEngine, pose: Array, status: Array, j: int, after: float) -> tuple[float, float]:
    """Time T = 2v⁺ / (a (1 − R)) that the rest of an accumulation at one contact takes, and a bound of its error.

    (−1, 0) where it is too early, or where there is none. ``after``: the velocity after the last impact. Criteria as
    ``kernels.impact.time_left``: Nordmark & Piiroinen 2009, to first order.
    """
    top, law, picks = status[each(engine, row.TOP, j)], engine.laws[j], engine.picks[row.LIST]
    coefficient = restitution(law, engine.curves[j], after)
    loss, share = accumulation(law, engine.curves[j], coefficient, after)
    if loss <= 0.0 or top <= 0.0:
        return -1.0, 0.0
    pull(engine, pose, status)
    count = some_of(engine, int(status[row.HELD]), picks)
    factor(engine.gram, picks, count, engine.lower)
    without_rows(engine, picks, count, engine.vectors[row.PULL], engine.vectors[row.ACCELERATION])
    toward = along(engine.rows, j, engine.vectors[row.ACCELERATION])
    if toward <= 0.0:
        return -1.0, 0.0
    left, length = 2.0 * after / (toward * loss), top * (top / toward)
    over = after * left < FLOOR * length
    near = NEAR if pose.shape[1] == 1 else NEAR_MODES
    parts = abs(engine.gaps[j]) + size_along(engine.rows, j, pose[0])
    if not over and after * left > near * max(length, parts):
        return -1.0, 0.0
    change = jerk_bound(engine, pose, j) * left / toward
    remainder = left * change + share * left
    if over:
        return left, remainder
    slowest = max(engine.drive[layout.W], engine.numbers[row.SLOWEST])
    late = remainder > FAITHFUL * coefficient * 2.0 * (top / toward) / loss or remainder * slowest > LATE
    return (-1.0, 0.0) if late or change > 0.1 else (left, remainder)


@kernel
def jerk_bound(engine: ContactEngine, pose: Array, j: int) -> float:
    """About the most that the contact's jerk may be from here on: mode by mode, of amplitude and rate."""
    total = 0.0
    for k in range(pose.shape[1]):
        own = engine.damping[k] if engine.numbers[row.COUPLED] == 0.0 else engine.damper[k, k]
        rate = engine.omega[k] + own
        swing = rate * rate * (rate * abs(pose[0, k]) + abs(pose[1, k]))
        parts = swing + rate * engine.vectors[row.PULL_SIZE, k] + abs(engine.vectors[row.DRIVE_RATE, k])
        total += abs(engine.rows[j, k]) * parts
    return total
