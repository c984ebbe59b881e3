"""One lane's point: taking it on, alone with the one engine, in and out of the lanes, and what it came to."""

from __future__ import annotations

from math import hypot

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.impact import narrowing, put_on_stop
from vibeam.flight.kernels.layout import (
    ATTACHED,
    CLEARANCE,
    CLOCK,
    COARSEST,
    COMPLETE,
    CONSTANT1,
    CONSTANT2,
    CONTACT,
    CONTACT_IM,
    CONTACT_RE,
    DISC,
    EVENT_LIMIT,
    FORCE_SIGNAL,
    FREE,
    GAP,
    IM,
    IMPACTS,
    INVERSE,
    KIND,
    LONGEST,
    OFFSET,
    OMEGA,
    ORDER,
    OUTPUT_SIGNAL,
    PAUSED,
    PERIOD,
    PERIOD_REST,
    PHASE_COS,
    PHASE_SIN,
    RE,
    RESTITUTION,
    RISE,
    SIGMA,
    SPEED,
    X0,
    Y0,
    Engine,
    Regime,
    Schedule,
    W,
    Watch,
)
from vibeam.flight.kernels.layout import SETTLED as SETTLED_PERIODS
from vibeam.flight.kernels.modal_flow import ROUND_OFF, begin_flight
from vibeam.flight.kernels.roots.pair import norm, propagator
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import WIDTH, Lane, Task
from vibeam.flight.points.kernels.tables import place, take_constants

Array = NDArray[np.float64]

CHUNK = 32  # periods that a point goes alone at most before its phase is set anew

SHORT, LONG = 2, 64  # impacts that a point goes alone

BRIEF = 8  # impacts in the lanes below which the next time alone is longer


@joined
def fill(target: Array, source: Array) -> None:
    """Set one row of numbers to another."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@kernel
def fill_2(target: Array, source: Array) -> None:
    """Set one matrix to another."""
    for i in range(target.shape[0]):
        for j in range(target.shape[1]):
            target[i, j] = source[i, j]


@kernel
def fill_3(target: Array, source: Array) -> None:
    """Set an array of three axes to another."""
    for i in range(target.shape[0]):
        fill_2(target[i], source[i])


@kernel
def fill_regime(target: Regime, source: Regime) -> None:
    """Set the arrays of one regime to those of another."""
    fill_2(target.pairs, source.pairs)
    fill_3(target.table, source.table)
    fill_2(target.levels, source.levels)
    fill_2(target.blocks, source.blocks)
    fill_2(target.into, source.into)
    fill_2(target.outof, source.outof)
    fill(target.held, source.held)
    fill_2(target.signals, source.signals)


@kernel
def fill_engine(target: Engine, source: Engine) -> None:
    """Set the arrays of one engine to those of another."""
    fill_2(target.pairs, source.pairs)
    fill_3(target.table, source.table)
    fill_2(target.levels, source.levels)
    fill_2(target.modes, source.modes)
    fill(target.drive, source.drive)
    fill_regime(target.rest, source.rest)
    fill(target.cells, source.cells)
    fill(target.rungs, source.rungs)


@joined
def engine_of(desks: Engine, slot: int) -> Engine:
    """One of several engines."""
    rest = desks.rest
    return Engine(
        desks.pairs[slot], desks.table[slot], desks.levels[slot], desks.signal[slot], desks.attached[slot],
        desks.modes[slot], desks.drive[slot],
        Regime(
            rest.pairs[slot], rest.table[slot], rest.levels[slot], rest.signal[slot], rest.attached[slot],
            rest.blocks[slot], rest.into[slot], rest.outof[slot], rest.held[slot], rest.signals[slot], rest.terms[slot],
        ),
        desks.cells[slot], desks.rungs[slot],
    )  # fmt: skip


@kernel
def set_point(task: Task, desk: Engine, point: int) -> None:
    """The engine of a packed system as that of one of its points."""
    drive, rest = desk.drive, desk.rest
    drive[GAP], drive[RESTITUTION] = task.drives[point, 2], task.drives[point, 3]
    fill(rest.held, task.held[point])
    for k in range(rest.blocks.shape[1]):
        rest.blocks[CONSTANT1, k], rest.blocks[CONSTANT2, k] = task.constants[point, 0, k], task.constants[point, 1, k]
    last = rest.signals.shape[1] - 2
    rest.signals[FORCE_SIGNAL, last] = task.offsets[point, 0]
    rest.signals[OUTPUT_SIGNAL, last] = task.offsets[point, 1]
    set_drive(desk, task.drives[point, 0], task.drives[point, 1])


@kernel
def take_point(task: Task, lane: Lane, slot: int, point: int, schedule: Schedule, most_modes: int) -> None:
    """The lane takes on a point, to go alone first."""
    desk, whole = engine_of(lane.desks, slot), lane.whole[slot]
    if whole[row.PACK] != task.pack[point]:
        whole[row.PACK] = task.pack[point]
        fill_engine(desk, engine_of(task.packs, task.pack[point]))
    set_point(task, desk, point)
    copy_pose(task.poses[point], lane.poses[slot])
    status, counts = lane.status[slot], lane.counts[slot]
    for i in range(status.shape[0]):
        status[i] = 0.0
    status[KIND] = task.kinds[point]
    for i in range(counts.shape[0]):
        counts[i] = 0
    whole[row.POINT], whole[row.STAY], whole[row.ENTERED], whole[row.PAUSED_ALONE] = point, SHORT, 0, 0
    whole[row.RECURS] = 0
    whole[row.ELIGIBLE] = 1 if schedule.settle > 0 and is_eligible(desk, most_modes) else 0
    whole[row.PHASE] = row.SETTLED
    if whole[row.ELIGIBLE] > 0:
        whole[row.PHASE] = row.ALONE
        take_constants(lane, slot)
        take_drive(lane, slot, desk, schedule.settle)
        join(lane, slot, desk, schedule)


@kernel
def is_eligible(desk: Engine, most_modes: int) -> bool:
    """Whether the point's flights may go side by side with others: few modes, underdamped, with a steady response."""
    n = desk.pairs.shape[1]
    if n > most_modes or desk.cells.shape[0] == 0 or desk.signal[ATTACHED] > 0.0:
        return False
    underdamped = True
    for k in range(n):
        underdamped = underdamped and desk.pairs[DISC, k] < 0.0
    return underdamped


@kernel
def take_drive(lane: Lane, slot: int, desk: Engine, settle: int) -> None:
    """The lane's rows of the drive and the stop."""
    common, drive = lane.common, desk.drive
    common[row.OMEGA * WIDTH + slot], common[row.CONST * WIDTH + slot] = drive[W], drive[CLEARANCE]
    common[row.PHASOR_RE * WIDTH + slot], common[row.PHASOR_IM * WIDTH + slot] = drive[CONTACT_RE], drive[CONTACT_IM]
    common[row.SIZE * WIDTH + slot] = 1.0000001 * hypot(drive[CONTACT_RE], drive[CONTACT_IM])
    common[row.RESTITUTION * WIDTH + slot] = drive[RESTITUTION]
    common[row.LOSS * WIDTH + slot] = narrowing(1.0 - drive[RESTITUTION])
    common[row.GAP * WIDTH + slot] = abs(drive[GAP])
    common[row.COARSEST * WIDTH + slot], common[row.LONGEST * WIDTH + slot] = drive[COARSEST], drive[LONGEST]
    high = 67108864.0 * drive[PERIOD]
    high = (drive[PERIOD] + high) - high
    common[row.PERIOD * WIDTH + slot], common[row.PERIOD_REST * WIDTH + slot] = drive[PERIOD], drive[PERIOD_REST]
    common[row.PERIOD_HIGH * WIDTH + slot], common[row.PERIOD_LOW * WIDTH + slot] = high, drive[PERIOD] - high
    common[row.INVERSE * WIDTH + slot] = 1.0 / drive[PERIOD]
    common[row.LEFT * WIDTH + slot] = settle
    common[row.FIRST * WIDTH + slot] = drive[COARSEST]
    common[row.LEVEL * WIDTH + slot], common[row.LEVEL_1 * WIDTH + slot] = -1.0, -1.0


@kernel
def enter(lane: Lane, slot: int, desk: Engine) -> bool:
    """Whether the lane's motion stands at the start of a plain flight, from where it may fly with the others."""
    common, modal, pose, status = lane.common, lane.modal, lane.poses[slot], lane.status[slot]
    if status[KIND] != FREE:
        return False
    cosine, sine = phase(desk.drive, status[CLOCK])
    value, _, size = begin_flight(desk, pose, cosine, sine)
    if not (np.isfinite(size) and (status[ORDER] == 1.0 or (status[ORDER] == 0.0 and value > ROUND_OFF * size))):
        return False
    sum_e, second = 0.0, 0.0
    for k in range(pose.shape[1]):
        x, y = desk.pairs[X0, k], desk.pairs[Y0, k]
        modal[place(k, row.START_X, slot)], modal[place(k, row.START_Y, slot)] = x, y
        sum_e += norm(x, y * desk.pairs[INVERSE, k])
        second -= 2.0 * desk.pairs[SIGMA, k] * y + desk.pairs[OMEGA, k] * desk.pairs[OMEGA, k] * x
    if status[ORDER] == 0.0 and desk.drive[CLEARANCE] > common[row.SIZE * WIDTH + slot] + sum_e + ROUND_OFF * size:
        return settle_aloft(lane, slot, desk)
    common[row.CLOCK * WIDTH + slot], common[row.COS * WIDTH + slot], common[row.SIN * WIDTH + slot] = (
        status[CLOCK], cosine, sine,
    )  # fmt: skip
    common[row.RISE * WIDTH + slot], common[row.SPEED * WIDTH + slot] = status[RISE] * status[ORDER], status[SPEED]
    common[row.SUM_E * WIDTH + slot], common[row.SECOND * WIDTH + slot] = sum_e, second
    impacts = lane.counts[slot, IMPACTS]
    common[row.IMPACTS * WIDTH + slot], common[row.RENEWED * WIDTH + slot] = impacts, impacts + 2.0
    common[row.SAME_CLOCK * WIDTH + slot] = -1.0
    lane.whole[slot, row.ENTERED] = impacts
    return True


@kernel
def settle_aloft(lane: Lane, slot: int, desk: Engine) -> bool:
    """Carry a motion that never reaches the stop to the end of its settling: const > |z| + Σ e proves that it does not.

    A chunk of periods after the other, so that no phase is large.
    """
    common, pose, status = lane.common, lane.poses[slot], lane.status[slot]
    pairs, modes, drive = desk.pairs, desk.modes, desk.drive
    while common[row.LEFT * WIDTH + slot] > 0.0:
        turns = min(common[row.LEFT * WIDTH + slot], float(CHUNK))
        time = turns * drive[PERIOD] - status[CLOCK]
        for k in range(pose.shape[1]):
            p00, p01, p10, p11 = propagator(pairs[SIGMA, k], pairs[OMEGA, k], pairs[DISC, k], time)
            x, y = pairs[X0, k], pairs[Y0, k]
            pairs[X0, k], pairs[Y0, k] = p00 * x + p01 * y, p10 * x + p11 * y
        status[CLOCK] = 0.0
        common[row.LEFT * WIDTH + slot] -= turns
    for k in range(pose.shape[1]):
        c = modes[CONTACT, k]
        pose[0, k] = -pairs[X0, k] / c + modes[OFFSET, k] + modes[IM, k]
        pose[1, k] = -pairs[Y0, k] / c + drive[W] * modes[RE, k]
    return False


@kernel
def leave(lane: Lane, slot: int, desk: Engine) -> None:
    """Set the point's pose and status to the start of the flight at which it leaves the lanes."""
    common, modal, pose, status = lane.common, lane.modal, lane.poses[slot], lane.status[slot]
    impacts = int(common[row.IMPACTS * WIDTH + slot])
    flown = impacts - lane.whole[slot, row.ENTERED]
    stay = lane.whole[slot, row.STAY]
    lane.whole[slot, row.STAY] = SHORT if flown >= BRIEF else min(2 * stay, LONG)
    lane.whole[slot, row.PHASE] = row.ALONE
    if flown == 0:
        return
    cosine, sine = common[row.COS * WIDTH + slot], common[row.SIN * WIDTH + slot]
    modes, w = desk.modes, desk.drive[W]
    for k in range(pose.shape[1]):
        c = modes[CONTACT, k]
        x, y = modal[place(k, row.START_X, slot)], modal[place(k, row.START_Y, slot)]
        pose[0, k] = -x / c + modes[OFFSET, k] + modes[RE, k] * sine + modes[IM, k] * cosine
        pose[1, k] = -y / c + w * (modes[RE, k] * cosine - modes[IM, k] * sine)
    put_on_stop(modes, desk.drive, pose)
    status[CLOCK], status[PHASE_COS], status[PHASE_SIN] = common[row.CLOCK * WIDTH + slot], cosine, sine
    status[ORDER], status[RISE], status[SPEED] = 1.0, common[row.RISE * WIDTH + slot], common[row.SPEED * WIDTH + slot]
    lane.counts[slot, IMPACTS] = impacts


@kernel
def go_alone(lane: Lane, slot: int, desk: Engine, schedule: Schedule, room: Watch) -> int:
    """A few impacts, or a chunk of periods, by the one engine: COMPLETE, PAUSED, or the outcome that ends the point."""
    common, pose, status, counts = lane.common, lane.poses[slot], lane.status[slot], lane.counts[slot]
    whole, alone, period = lane.whole[slot], lane.alone[slot], desk.drive[PERIOD]
    if whole[row.PAUSED_ALONE] == 0:
        turns = min(common[row.LEFT * WIDTH + slot], float(CHUNK))
        alone[row.TURNS], alone[row.BEGAN] = turns, status[CLOCK]
        alone[row.SPAN] = turns * period - status[CLOCK]
        alone[row.UPTO] = counts[IMPACTS] + whole[row.STAY]
    upto = int(alone[row.UPTO])
    outcome, done = advance(desk, pose, status, alone[row.SPAN], upto, room.nothing, room.poses, counts)
    whole[row.PAUSED_ALONE] = 1 if outcome == PAUSED else 0
    if outcome == COMPLETE:
        status[CLOCK] = 0.0
        common[row.LEFT * WIDTH + slot] -= alone[row.TURNS]
    elif outcome == EVENT_LIMIT:
        passed = np.floor((alone[row.BEGAN] + done - status[CLOCK]) / period + 0.5)
        common[row.LEFT * WIDTH + slot] -= passed
        gone = schedule.settle - common[row.LEFT * WIDTH + slot]
        if counts[IMPACTS] >= upto and counts[IMPACTS] <= schedule.limit * (gone + CHUNK):
            return COMPLETE
    return int(outcome)


@kernel
def keep(task: Task, lane: Lane, slot: int, room: Watch, outcome: int, period: float) -> None:
    """Keep what the lane's point came to."""
    point, status = lane.whole[slot, row.POINT], lane.status[slot]
    task.ended[point, 0], task.ended[point, 1] = outcome, int(period)
    fill(task.results[point], room.result)
    fill(task.energy[point], room.energy)
    fill(task.counts[point], lane.counts[slot])
    copy_pose(lane.poses[slot], task.poses[point])
    task.kinds[point] = status[KIND]
    last, wanted = room.strobes.shape[0], task.strobes.shape[1]
    for j in range(wanted):
        value = 0.0
        for k in range(room.row.shape[0]):
            value += room.row[k] * room.strobes[last - wanted + j, 0, k]
        task.strobes[point, j] = value


@kernel
def join(lane: Lane, slot: int, desk: Engine, schedule: Schedule) -> None:
    """The lane's point, alone until now, flies with the others, goes on alone, or has settled and is to be watched."""
    if lane.common[row.LEFT * WIDTH + slot] > 0.0 and enter(lane, slot, desk):
        lane.whole[slot, row.PHASE] = row.FLYING
    elif lane.common[row.LEFT * WIDTH + slot] <= 0.0:
        lane.whole[slot, row.PHASE] = row.SETTLED
        lane.counts[slot, SETTLED_PERIODS] = schedule.settle
