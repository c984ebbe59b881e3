"""Readout of one point's segments: flights eight at a time, side by side; rests, and what is unusual, alone."""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.lanes.elementary import sine_cosine
from vibeam.flight.kernels.lanes.simd import Lanes, eight, every, load
from vibeam.flight.kernels.layout import Engine, Watch
from vibeam.flight.kernels.readout import ACCURACY, read_flight, read_segment
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import note_impact
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.energies import add_energies
from vibeam.flight.points.kernels.extremes import LaneExtremes, Wave, extremes_of_flights, least_of
from vibeam.flight.points.kernels.rows import set_flight, set_no_flight, take_steady_out
from vibeam_models.arrays import Array

FEW = 1  # modes up to which extremes are found side by side: with more, lanes that need short panels hold up all others


@kernel
def read_rows(engine: Engine, watch: Watch, first: int, last: int, rows: Array, readable: bool) -> None:
    """Read off the segments ``first`` to ``last`` (not itself) of the trace; ``rows``: of flights side by side."""
    trace, result, n, filled, start = watch.trace, watch.result, watch.energy.shape[0], 0, first
    extremes_only = Watch(
        watch.row, watch.nothing, trace, watch.poses, watch.strobes, watch.scratch, watch.frame, result, watch.energy,
        watch.share, layout.OUTPUT_ALONE if is_contact(watch.row, engine.modes) else layout.REACH_TOO,
    )  # fmt: skip
    few, coarsest = n <= FEW, int(engine.drive[layout.COARSEST])
    for i in range(first, last):
        if trace[i, layout.WHAT] != layout.FREE:
            result[layout.REST_TIME] += trace[i, layout.DURATION]
        if trace[i, layout.DURATION] > 0.0:
            if readable and trace[i, layout.WHAT] == layout.FREE:
                clock, duration = trace[i, layout.AT_CLOCK], trace[i, layout.DURATION]
                if not few:
                    read_flight(engine, extremes_only, watch.poses[i], clock, duration, coarsest, ACCURACY)
                set_flight(rows, filled, clock, duration, watch.poses[i])
                filled += 1
            else:
                copy_pose(watch.poses[i], watch.frame)
                read_segment(engine, watch, i)
        note_impact(trace, i, result)
        if filled == row.WIDTH or (filled > 0 and i == last - 1):
            for slot in range(filled, row.WIDTH):
                set_no_flight(rows, slot, n)
            if not read_flights(engine, watch, rows, (1 << filled) - 1, few):
                for j in range(start, i + 1):
                    if trace[j, layout.WHAT] == layout.FREE and trace[j, layout.DURATION] > 0.0:
                        copy_pose(watch.poses[j], watch.frame)
                        read_segment(engine, watch, j)
            filled, start = 0, i + 1
    if extremes_only.reading == layout.OUTPUT_ALONE:
        result[layout.CONTACT_LEAST] = min(result[layout.CONTACT_LEAST], result[layout.LEAST])


@joined
def is_contact(row: Array, modes: Array) -> bool:
    """True where the output is the contact's displacement, whose extremes are those of the gap."""
    same = True
    for k in range(row.shape[0]):
        same = same and row[k] == modes[layout.CONTACT, k]
    return same


@kernel
def read_flights(engine: Engine, watch: Watch, rows: Array, used: int, extremes: bool) -> bool:
    """Energies and, where wanted, ``extremes`` of flights; False, and nothing, where that takes too much work."""
    modes, drive, like = engine.modes, engine.drive, eight()
    w = drive[layout.W]
    sine, cosine = sine_cosine(w * load(rows, row.FLIGHT_CLOCK * row.WIDTH, like))
    take_steady_out(modes, drive, rows, cosine, sine)
    if extremes and not read_extremes(engine, watch, rows, cosine, sine):
        return False
    add_energies(engine, rows, cosine, sine, used, watch.energy)
    return True


@kernel
def read_extremes(engine: Engine, watch: Watch, rows: Array, cosine: Lanes, sine: Lanes) -> bool:
    """Extremes of the output and the gap of the flights in ``rows``; False, and nothing, where that is not bounded."""
    modes, drive, result, like = engine.modes, engine.drive, watch.result, eight()
    n, w, coarsest = modes.shape[1], drive[layout.W], int(drive[layout.COARSEST])
    const, re, im = 0.0, 0.0, 0.0
    for k in range(n):
        const += watch.row[k] * modes[layout.OFFSET, k]
        re += watch.row[k] * modes[layout.RE, k]
        im += watch.row[k] * modes[layout.IM, k]
    wave = Wave(const, w, re * cosine - im * sine, re * sine + im * cosine)
    known = LaneExtremes(every(result[layout.LEAST], like), every(result[layout.HIGH], like))
    found, done = extremes_of_flights(
        engine.pairs, engine.table, engine.levels, rows, watch.row, wave, coarsest, known, ACCURACY
    )
    if not done:
        return False
    if not is_contact(watch.row, modes):
        wave = contact_wave(drive, cosine, sine)
        known = LaneExtremes(every(result[layout.CONTACT_LEAST], like), every(np.inf, like))
        reach, done = extremes_of_flights(
            engine.pairs, engine.table, engine.levels, rows, modes[layout.CONTACT], wave, coarsest, known, ACCURACY
        )
        if not done:
            return False
        result[layout.CONTACT_LEAST] = least_of(rows, reach.least)
    result[layout.LEAST], result[layout.HIGH] = least_of(rows, found.least), -least_of(rows, 0.0 - found.most)
    return True


@joined
def contact_wave(drive: Array, cosine: Lanes, sine: Lanes) -> Wave:
    """The contact's displacement Σ c_k η_k, its weights left out."""
    re, im = drive[layout.CONTACT_RE], drive[layout.CONTACT_IM]
    return Wave(
        drive[layout.GAP] - drive[layout.CLEARANCE], drive[layout.W], re * cosine - im * sine, re * sine + im * cosine
    )
