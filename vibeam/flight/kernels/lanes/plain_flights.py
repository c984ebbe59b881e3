"""Impact after impact in plain flights, the pairs never leaving their blocks: see ``lanes.flight``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.impact import is_faint, put_on_stop
from vibeam.flight.kernels.lanes import mode_blocks as row
from vibeam.flight.kernels.lanes.flight import ALOFT, STRUCK, UNUSUAL, flight
from vibeam.flight.kernels.lanes.landing import drive_phasor, land_on, phase_at
from vibeam.flight.kernels.lanes.mode_blocks import cell, gather, scatter
from vibeam.flight.kernels.lanes.panels import to_node, to_start
from vibeam.flight.kernels.lanes.simd import Lanes, every, load, store, total, width
from vibeam.flight.kernels.layout import (
    CLEARANCE,
    CLOCK,
    COARSEST,
    GAP,
    IMPACT,
    IMPACTS,
    LONGEST,
    ORDER,
    PANELS,
    PHASE_COS,
    PHASE_SIN,
    RESTITUTION,
    RISE,
    SEGMENTS,
    SPAN_END,
    SPEED,
    ZI,
    ZR,
    Engine,
    W,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF, begin_flight
from vibeam.flight.kernels.segments import add, close_segment, open_segment

Array = NDArray[np.float64]

CARRIED, NOT_PLAIN, AT_STOP = 0, 1, 2


@joined
def strike(cells: Array, blocks: int, beyond: float, impulse: float, like: Lanes) -> tuple[float, float]:
    """The pairs after the impact, at the start and the node; the sums of their E and accelerations.

    The contact is put exactly on the stop; ``impulse`` = (1 + R) times the velocity before.
    """
    step = width(like)
    whole, second = every(0.0, like), every(0.0, like)
    for b in range(blocks):
        at = cell(b, 0, like)
        x = load(cells, at + row.ROOT_X * step, like) - load(cells, at + row.PUT * step, like) * beyond
        y = load(cells, at + row.ROOT_Y * step, like) + load(cells, at + row.KICK * step, like) * impulse
        store(cells, at + row.START_X * step, x)
        store(cells, at + row.START_Y * step, y)
        e, bend = to_node(cells, at, x, y, like)
        whole += e
        second += bend
    return total(whole), total(second)


@joined
def note(status: Array, clock: float, cosine: float, sine: float, order: float, rise: float, speed: float) -> None:
    """Where the motion stands."""
    status[CLOCK], status[PHASE_COS], status[PHASE_SIN] = clock, cosine, sine
    status[ORDER], status[RISE], status[SPEED] = order, rise, speed


@kernel
def plain_flights_in_lanes(
    desk: Engine, pose: Array, status: Array, span: float, done: float, lost: float, most: int, trace: Array,
    poses: Array, counts: NDArray[np.int64], like: Lanes,
) -> tuple[int, float, float, float]:  # fmt: skip
    """Flights and impacts, carried on from time ``done`` toward ``span``: why it ends, done, lost, last flight.

    ``pose`` and ``status`` end where time, rows or impacts are used up, at the start of a flight that is NOT_PLAIN, or
    AT_STOP, at the end of a flight whose impact may belong to a chatter and is still to be struck.
    """
    modes, drive, cells = desk.modes, desk.drive, desk.cells
    value, _, size = begin_flight(
        desk.pairs, desk.signal, desk.attached, modes, drive, pose, status[PHASE_COS], status[PHASE_SIN]
    )
    if not (np.isfinite(size) and (status[ORDER] == 1.0 or (status[ORDER] == 0.0 and value > ROUND_OFF * size))):
        return NOT_PLAIN, done, lost, 0.0
    gather(desk.pairs, cells, like)
    n, rows = pose.shape[1], trace.shape[0]
    blocks = (n + width(like) - 1) // width(like)
    const, w, restitution, coarsest = drive[CLEARANCE], drive[W], drive[RESTITUTION], int(drive[COARSEST])
    loss, gap = 1.0 - restitution, abs(drive[GAP])
    order, rise, speed, clock = status[ORDER], status[RISE] * status[ORDER], status[SPEED], status[CLOCK]
    cosine, sine = status[PHASE_COS], status[PHASE_SIN]
    zr, zi = desk.signal[ZR], desk.signal[ZI]
    sum_e, second = to_start(cells, blocks, like)
    what, t, begun, first = STRUCK, 0.0, done, coarsest
    while done < span and counts[IMPACTS] < most and (rows == 0 or counts[SEGMENTS] < rows):
        if rows > 0:
            if done > begun:
                scatter(cells, like, modes, drive, pose, row.START_X, cosine, sine)
                put_on_stop(modes, drive, pose)
                note(status, clock, cosine, sine, order, rise, speed)
            open_segment(trace, poses, pose, status, done, counts[SEGMENTS])
        room = min(span - done, drive[LONGEST])
        what, panels, first, t, cosine2, sine2, value, slope = flight(
            cells, desk.rungs, desk.levels, desk.pairs, drive, blocks, const, zr, zi, w, sum_e, second - w * w * zi,
            rise, clock, room, coarsest, max(coarsest, first - 1), like,
        )  # fmt: skip
        counts[PANELS] += panels
        if what == UNUSUAL or (what == ALOFT and room < span - done):
            what = UNUSUAL
            break
        clock2 = wrap(drive, clock + t)
        if what == ALOFT:
            land_on(cells, desk.pairs, blocks, t, like)
            cosine, sine = phase_at(drive, clock2)
            scatter(cells, like, modes, drive, pose, row.ROOT_X, cosine, sine)
            note(status, clock2, cosine, sine, 0.0, 0.0, speed)
            close_segment(trace, t, SPAN_END, 0.0, counts)
            return CARRIED, span, lost, t
        zr2, zi2 = drive_phasor(drive, cosine2, sine2)
        before = max(-slope, 0.0)
        after, top = restitution * before, max(speed, before)
        sum_e, second = strike(cells, blocks, value, (1.0 + restitution) * before, like)
        toward = w * w * zi2 - second
        done, lost = add(done, lost, t)
        cosine, sine, clock, zr, zi, speed = cosine2, sine2, clock2, zr2, zi2, top
        if after <= 0.0 or is_faint(after, top, toward, loss, gap):
            scatter(cells, like, modes, drive, pose, row.ROOT_X, cosine, sine)
            note(status, clock, cosine, sine, 0.0, 0.0, speed)
            return AT_STOP, done, lost, t
        counts[IMPACTS] += 1
        order, rise = 1.0, after
        close_segment(trace, t, IMPACT, before, counts)
    if done > begun:  # or else nothing has changed, and not a digit shall
        scatter(cells, like, modes, drive, pose, row.START_X, cosine, sine)
        put_on_stop(modes, drive, pose)
        note(status, clock, cosine, sine, order, rise, speed)
    return NOT_PLAIN if what == UNUSUAL else CARRIED, done, lost, t
