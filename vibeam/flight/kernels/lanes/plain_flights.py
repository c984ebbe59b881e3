"""Impact after impact in plain flights, the pairs never leaving their blocks: see ``lanes.flight``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import wrap
from vibeam.flight.kernels.impact import is_faint, narrowing, put_on_stop
from vibeam.flight.kernels.lanes import layout as row
from vibeam.flight.kernels.lanes.flight import Launch, flight
from vibeam.flight.kernels.lanes.landing import ALOFT, STRUCK, UNUSUAL, Forced, drive_phasor, land_on, phase_at
from vibeam.flight.kernels.lanes.mode_blocks import cell, gather, scatter
from vibeam.flight.kernels.lanes.panels import to_node, to_start
from vibeam.flight.kernels.lanes.simd import Lanes, every, load, store, total, width
from vibeam.flight.kernels.layout import Engine, Phase
from vibeam.flight.kernels.modal_flow import ROUND_OFF, begin_flight
from vibeam.flight.kernels.roots.pair import norm
from vibeam.flight.kernels.segments import Progress, Record, add, close_segment, open_segment

Array = NDArray[np.float64]

CARRIED, NOT_PLAIN, AT_STOP = 0, 1, 2


@joined
def strike(cells: Array, blocks: int, beyond: float, impulse: float, like: Lanes) -> tuple[float, float]:
    """The pairs after the impact, at the start and the node; the sums of their e and accelerations.

    η' ← η' − w (1 + R) v/S, S = w·w, hence x' ← x' + w²/S ``impulse``, ``impulse`` = (1 + R) times the velocity before;
    and the contact is put exactly on the stop in the direction of least energy, δη ∝ w/ω².
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
def note(status: Array, clock: float, phase: Phase, order: float, rise: float, speed: float) -> None:
    """Where the motion stands."""
    status[layout.CLOCK], status[layout.PHASE_COS], status[layout.PHASE_SIN] = clock, phase.cosine, phase.sine
    status[layout.ORDER], status[layout.RISE], status[layout.SPEED] = order, rise, speed


@kernel
def plain_flights_in_lanes(
    engine: Engine, pose: Array, status: Array, progress: Progress, most: int, record: Record, like: Lanes
) -> tuple[int, float, float, float]:
    """Flights and impacts, carried on from the time done toward the span: why it ends, done, lost, last flight.

    ``pose`` and ``status`` end where time, rows or impacts (``most``) are used up, at the start of a flight that is
    NOT_PLAIN, or AT_STOP, at the end of a flight whose impact may belong to a chatter and is still to be struck.
    """
    span, done, lost = progress
    trace, poses, counts = record
    modes, drive, cells = engine.modes, engine.drive, engine.cells
    value, _, size = begin_flight(engine, pose, status[layout.PHASE_COS], status[layout.PHASE_SIN])
    if not (
        np.isfinite(size)
        and (status[layout.ORDER] == 1.0 or (status[layout.ORDER] == 0.0 and value > ROUND_OFF * size))
    ):
        return NOT_PLAIN, done, lost, 0.0
    gather(engine.pairs, cells, like)
    n, rows = pose.shape[1], trace.shape[0]
    blocks = (n + width(like) - 1) // width(like)
    const, w, restitution, coarsest = (
        drive[layout.CLEARANCE],
        drive[layout.W],
        drive[layout.RESTITUTION],
        int(drive[layout.COARSEST]),
    )
    loss, gap = narrowing(1.0 - restitution), abs(drive[layout.GAP])
    order, rise, speed, clock = (
        status[layout.ORDER],
        status[layout.RISE] * status[layout.ORDER],
        status[layout.SPEED],
        status[layout.CLOCK],
    )
    phase, zr, zi = (
        Phase(status[layout.PHASE_COS], status[layout.PHASE_SIN]),
        engine.signal[layout.ZR],
        engine.signal[layout.ZI],
    )
    forced = Forced(const, zr, zi, w, norm(zr, zi))
    sum_e, second = to_start(cells, blocks, like)
    what, t, begun, first = STRUCK, 0.0, done, coarsest
    while done < span and counts[layout.IMPACTS] < most and (rows == 0 or counts[layout.SEGMENTS] < rows):
        if rows > 0:
            if done > begun:
                scatter(engine, pose, row.START_X, phase, like)
                put_on_stop(modes, drive, pose)
                note(status, clock, phase, order, rise, speed)
            open_segment(trace, poses, pose, status, done, counts[layout.SEGMENTS])
        watch = min(span - done, drive[layout.LONGEST])
        launch = Launch(clock, rise, second - w * w * forced.im, sum_e)
        landing, panels, first = flight(engine, blocks, forced, launch, watch, coarsest, max(coarsest, first - 1), like)
        what, t = landing.outcome, landing.time
        counts[layout.PANELS] += panels
        if what == UNUSUAL or (what == ALOFT and watch < span - done):
            what = UNUSUAL
            break
        clock2 = wrap(drive, clock + t)
        if what == ALOFT:
            land_on(cells, engine.pairs, blocks, t, like)
            phase = phase_at(drive, clock2)
            scatter(engine, pose, row.ROOT_X, phase, like)
            note(status, clock2, phase, 0.0, 0.0, speed)
            close_segment(trace, t, layout.SPAN_END, 0.0, counts)
            return CARRIED, span, lost, t
        zr, zi = drive_phasor(drive, landing.phase)
        before = max(-landing.slope, 0.0)
        after, top = restitution * before, max(speed, before)
        sum_e, second = strike(cells, blocks, landing.value, (1.0 + restitution) * before, like)
        toward = w * w * zi - second
        done, lost = add(done, lost, t)
        phase, clock, speed, forced = landing.phase, clock2, top, Forced(const, zr, zi, w, norm(zr, zi))
        if after <= 0.0 or is_faint(after, top, toward, loss, gap):
            scatter(engine, pose, row.ROOT_X, phase, like)
            note(status, clock, phase, 0.0, 0.0, speed)
            return AT_STOP, done, lost, t
        counts[layout.IMPACTS] += 1
        order, rise = 1.0, after
        close_segment(trace, t, layout.IMPACT, before, counts)
    if done > begun:  # or else nothing has changed, and not a digit shall
        scatter(engine, pose, row.START_X, phase, like)
        put_on_stop(modes, drive, pose)
        note(status, clock, phase, order, rise, speed)
    return NOT_PLAIN if what == UNUSUAL else CARRIED, done, lost, t
