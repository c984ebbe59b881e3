"""One lane's point: taking it on, alone with the one engine, in and out of the lanes, and what it came to."""

from __future__ import annotations

from math import hypot

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, set_drive
from vibeam.flight.kernels.events import advance
from vibeam.flight.kernels.impact import narrowing, put_on_stop
from vibeam.flight.kernels.lanes.plain_flights import note
from vibeam.flight.kernels.layout import Engine, Phase, PointSchedule, Regime, Watch
from vibeam.flight.kernels.modal_flow import ROUND_OFF, begin_flight, is_plain_start
from vibeam.flight.kernels.roots.pair import norm, propagator
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import Lane, Task
from vibeam.flight.points.kernels.rows import place, take_constants
from vibeam_models.arrays import Array

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
def engine_of(engines: Engine, slot: int) -> Engine:
    """One of several engines."""
    rest = engines.rest
    return Engine(
        engines.pairs[slot], engines.table[slot], engines.levels[slot], engines.signal[slot], engines.attached[slot],
        engines.modes[slot], engines.drive[slot],
        Regime(
            rest.pairs[slot], rest.table[slot], rest.levels[slot], rest.signal[slot], rest.attached[slot],
            rest.blocks[slot], rest.into[slot], rest.outof[slot], rest.held[slot], rest.signals[slot], rest.terms[slot],
        ),
        engines.cells[slot], engines.rungs[slot],
    )  # fmt: skip


@kernel
def set_point(task: Task, engine: Engine, point: int) -> None:
    """The engine of a packed system as that of one of its points."""
    drive, rest = engine.drive, engine.rest
    drive[layout.GAP], drive[layout.RESTITUTION] = task.drives[point, 2], task.drives[point, 3]
    fill(rest.held, task.held[point])
    for k in range(rest.blocks.shape[1]):
        rest.blocks[layout.CONSTANT1, k] = task.constants[point, 0, k]
        rest.blocks[layout.CONSTANT2, k] = task.constants[point, 1, k]
    last = rest.signals.shape[1] - 2
    rest.signals[layout.FORCE_SIGNAL, last] = task.offsets[point, 0]
    rest.signals[layout.OUTPUT_SIGNAL, last] = task.offsets[point, 1]
    set_drive(engine, task.drives[point, 0], task.drives[point, 1])


@kernel
def take_point(task: Task, lane: Lane, slot: int, point: int, schedule: PointSchedule, most_modes: int) -> None:
    """The lane takes on a point, to go alone first."""
    engine, whole = engine_of(lane.engines, slot), lane.whole[slot]
    if whole[row.PACK] != task.pack[point]:
        whole[row.PACK] = task.pack[point]
        fill_engine(engine, engine_of(task.packs, task.pack[point]))
    set_point(task, engine, point)
    copy_pose(task.poses[point], lane.poses[slot])
    status, counts = lane.status[slot], lane.counts[slot]
    for i in range(status.shape[0]):
        status[i] = 0.0
    status[layout.KIND] = task.kinds[point]
    for i in range(counts.shape[0]):
        counts[i] = 0
    whole[row.POINT], whole[row.STAY], whole[row.ENTERED], whole[row.PAUSED_ALONE] = point, SHORT, 0, 0
    whole[row.RECURS] = 0
    whole[row.ELIGIBLE] = 1 if schedule.settle > 0 and is_eligible(engine, most_modes) else 0
    whole[row.PHASE] = row.SETTLED
    if whole[row.ELIGIBLE] > 0:
        whole[row.PHASE] = row.ALONE
        take_constants(lane, slot)
        take_drive(lane, slot, engine, schedule.settle)
        join(lane, slot, engine, schedule)


@joined
def take_output(task: Task, point: int, watch: Watch) -> None:
    """Watch the output of a point, where each has its own."""
    for k in range(task.offsets.shape[1] - 2):
        watch.row[k] = task.offsets[point, 2 + k]


@kernel
def is_eligible(engine: Engine, most_modes: int) -> bool:
    """True where a point's flights may go side by side with others: few modes, underdamped, with a steady response."""
    n = engine.pairs.shape[1]
    if n > most_modes or engine.cells.shape[0] == 0 or engine.signal[layout.ATTACHED] > 0.0:
        return False
    underdamped = True
    for k in range(n):
        underdamped = underdamped and engine.pairs[layout.DISC, k] < 0.0
    return underdamped


@kernel
def take_drive(lane: Lane, slot: int, engine: Engine, settle: int) -> None:
    """The lane's rows of the drive and the stop."""
    share, drive = lane.common[slot :: row.WIDTH], engine.drive
    re, im, period = drive[layout.CONTACT_RE], drive[layout.CONTACT_IM], drive[layout.PERIOD]
    share[row.OMEGA], share[row.CONST] = drive[layout.W], drive[layout.CLEARANCE]
    share[row.PHASOR_RE], share[row.PHASOR_IM], share[row.SIZE] = re, im, 1.0000001 * hypot(re, im)
    share[row.RESTITUTION], share[row.LOSS] = drive[layout.RESTITUTION], narrowing(1.0 - drive[layout.RESTITUTION])
    share[row.GAP] = abs(drive[layout.GAP])
    share[row.COARSEST], share[row.LONGEST] = drive[layout.COARSEST], drive[layout.LONGEST]
    high = 67108864.0 * period
    high = (period + high) - high
    share[row.PERIOD], share[row.PERIOD_REST] = period, drive[layout.PERIOD_REST]
    share[row.PERIOD_HIGH], share[row.PERIOD_LOW], share[row.INVERSE] = high, period - high, 1.0 / period
    share[row.LEFT], share[row.FIRST] = settle, drive[layout.COARSEST]
    share[row.LEVEL], share[row.LEVEL_1] = -1.0, -1.0


@kernel
def enter(lane: Lane, slot: int, engine: Engine) -> bool:
    """True where the lane's motion stands at the start of a plain flight, from where it may fly with the others."""
    share, modal, pose, status = lane.common[slot :: row.WIDTH], lane.modal, lane.poses[slot], lane.status[slot]
    if status[layout.KIND] != layout.FREE:
        return False
    cosine, sine = phase(engine.drive, status[layout.CLOCK])
    value, _, size = begin_flight(engine, pose, cosine, sine)
    if not is_plain_start(status[layout.ORDER], value, size):
        return False
    sum_e, second = 0.0, 0.0
    for k in range(pose.shape[1]):
        x, y = engine.pairs[layout.X0, k], engine.pairs[layout.Y0, k]
        modal[place(k, row.START_X, slot)], modal[place(k, row.START_Y, slot)] = x, y
        sum_e += norm(x, y * engine.pairs[layout.INVERSE, k])
        own = engine.pairs[layout.OMEGA, k]
        second -= 2.0 * engine.pairs[layout.SIGMA, k] * y + own * own * x
    reach = share[row.SIZE] + sum_e + ROUND_OFF * size
    if status[layout.ORDER] == 0.0 and engine.drive[layout.CLEARANCE] > reach:
        return settle_aloft(lane, slot, engine)
    share[row.CLOCK], share[row.COS], share[row.SIN] = status[layout.CLOCK], cosine, sine
    share[row.RISE], share[row.SPEED] = status[layout.RISE] * status[layout.ORDER], status[layout.SPEED]
    share[row.SUM_E], share[row.SECOND] = sum_e, second
    impacts = lane.counts[slot, layout.IMPACTS]
    share[row.IMPACTS], share[row.RENEWED] = impacts, impacts + 2.0
    share[row.SAME_CLOCK] = -1.0
    lane.whole[slot, row.ENTERED] = impacts
    return True


@kernel
def settle_aloft(lane: Lane, slot: int, engine: Engine) -> bool:
    """Carry a motion that never reaches the stop to the end of its settling: const > |z| + Σ e proves that it does not.

    A chunk of periods after the other, so that no phase is large.
    """
    share, pose, status = lane.common[slot :: row.WIDTH], lane.poses[slot], lane.status[slot]
    pairs, modes, drive = engine.pairs, engine.modes, engine.drive
    while share[row.LEFT] > 0.0:
        turns = min(share[row.LEFT], float(CHUNK))
        time = turns * drive[layout.PERIOD] - status[layout.CLOCK]
        for k in range(pose.shape[1]):
            p00, p01, p10, p11 = propagator(pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], time)
            x, y = pairs[layout.X0, k], pairs[layout.Y0, k]
            pairs[layout.X0, k], pairs[layout.Y0, k] = p00 * x + p01 * y, p10 * x + p11 * y
        status[layout.CLOCK] = 0.0
        share[row.LEFT] -= turns
    for k in range(pose.shape[1]):
        c = modes[layout.CONTACT, k]
        pose[0, k] = -pairs[layout.X0, k] / c + modes[layout.OFFSET, k] + modes[layout.IM, k]
        pose[1, k] = -pairs[layout.Y0, k] / c + drive[layout.W] * modes[layout.RE, k]
    return False


@kernel
def leave(lane: Lane, slot: int, engine: Engine) -> None:
    """Set the point's pose and status to the start of the flight at which it leaves the lanes."""
    share, modal, pose, status = lane.common[slot :: row.WIDTH], lane.modal, lane.poses[slot], lane.status[slot]
    impacts = int(share[row.IMPACTS])
    flown = impacts - lane.whole[slot, row.ENTERED]
    stay = lane.whole[slot, row.STAY]
    lane.whole[slot, row.STAY] = SHORT if flown >= BRIEF else min(2 * stay, LONG)
    lane.whole[slot, row.PHASE] = row.ALONE
    if flown == 0:
        return
    cosine, sine = share[row.COS], share[row.SIN]
    modes, w = engine.modes, engine.drive[layout.W]
    for k in range(pose.shape[1]):
        c = modes[layout.CONTACT, k]
        x, y = modal[place(k, row.START_X, slot)], modal[place(k, row.START_Y, slot)]
        pose[0, k] = -x / c + modes[layout.OFFSET, k] + modes[layout.RE, k] * sine + modes[layout.IM, k] * cosine
        pose[1, k] = -y / c + w * (modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine)
    put_on_stop(modes, engine.drive, pose)
    note(status, share[row.CLOCK], Phase(cosine, sine), 1.0, share[row.RISE], share[row.SPEED])
    lane.counts[slot, layout.IMPACTS] = impacts


@kernel
def go_alone(lane: Lane, slot: int, engine: Engine, schedule: PointSchedule, watch: Watch) -> int:
    """A few impacts, or a chunk of periods, by the one engine: COMPLETE, PAUSED, or the outcome that ends the point."""
    share, counts = lane.common[slot :: row.WIDTH], lane.counts[slot]
    pose, status = lane.poses[slot], lane.status[slot]
    whole, alone, period = lane.whole[slot], lane.alone[slot], engine.drive[layout.PERIOD]
    if whole[row.PAUSED_ALONE] == 0:
        turns = min(share[row.LEFT], float(CHUNK))
        alone[row.TURNS], alone[row.BEGAN] = turns, status[layout.CLOCK]
        alone[row.SPAN] = turns * period - status[layout.CLOCK]
        alone[row.UPTO] = counts[layout.IMPACTS] + whole[row.STAY]
    upto = int(alone[row.UPTO])
    outcome, done = advance(engine, pose, status, alone[row.SPAN], upto, watch.nothing, watch.poses, counts)
    whole[row.PAUSED_ALONE] = 1 if outcome == layout.PAUSED else 0
    if outcome == layout.COMPLETE:
        status[layout.CLOCK] = 0.0
        share[row.LEFT] -= alone[row.TURNS]
    elif outcome == layout.EVENT_LIMIT:
        passed = np.floor((alone[row.BEGAN] + done - status[layout.CLOCK]) / period + 0.5)
        share[row.LEFT] -= passed
        gone = schedule.settle - share[row.LEFT]
        if counts[layout.IMPACTS] >= upto and counts[layout.IMPACTS] <= schedule.limit * (gone + CHUNK):
            return layout.COMPLETE
    return int(outcome)


@kernel
def keep(task: Task, lane: Lane, slot: int, watch: Watch, outcome: int, period: float) -> None:
    """Keep what the lane's point came to."""
    point, status = lane.whole[slot, row.POINT], lane.status[slot]
    task.ended[point, 0], task.ended[point, 1] = outcome, int(period)
    fill(task.results[point], watch.result)
    fill(task.energy[point], watch.energy)
    fill(task.counts[point], lane.counts[slot])
    copy_pose(lane.poses[slot], task.poses[point])
    task.kinds[point] = status[layout.KIND]
    last, wanted = watch.strobes.shape[0], task.strobes.shape[1]
    for j in range(wanted):
        value = 0.0
        for k in range(watch.row.shape[0]):
            value += watch.row[k] * watch.strobes[last - wanted + j, 0, k]
        task.strobes[point, j] = value


@kernel
def join(lane: Lane, slot: int, engine: Engine, schedule: PointSchedule) -> None:
    """The lane's point, alone until now, flies with the others, goes on alone, or has settled and is to be watched."""
    share = lane.common[slot :: row.WIDTH]
    if share[row.LEFT] > 0.0 and enter(lane, slot, engine):
        lane.whole[slot, row.PHASE] = row.FLYING
    elif share[row.LEFT] <= 0.0:
        lane.whole[slot, row.PHASE] = row.SETTLED
        lane.counts[slot, layout.SETTLED] = schedule.settle
