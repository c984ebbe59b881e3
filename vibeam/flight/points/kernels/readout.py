"""What is read off segments of one point: flights eight at a time, side by side; rests, and what is unusual, alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.extremes import ACCURACY
from vibeam.flight.kernels.lanes.elementary import sine_cosine
from vibeam.flight.kernels.lanes.simd import Lanes, eight, every, load
from vibeam.flight.kernels.layout import (
    AT_CLOCK,
    CLEARANCE,
    COARSEST,
    CONTACT,
    CONTACT_IM,
    CONTACT_LEAST,
    CONTACT_RE,
    DURATION,
    FREE,
    GAP,
    HIGH,
    IM,
    LEAST,
    OFFSET,
    OUTPUT_ALONE,
    RE,
    REACH_TOO,
    REST_TIME,
    WHAT,
    Engine,
    W,
    Watch,
)
from vibeam.flight.kernels.readout import read_flight, read_segment
from vibeam.flight.kernels.segments import copy_pose
from vibeam.flight.kernels.steady_point import note_impact
from vibeam.flight.points.kernels.energies import add_energies
from vibeam.flight.points.kernels.extremes import Found, Wave, extremes_of_flights, least_of
from vibeam.flight.points.kernels.flights import set_flight, set_no_flight, take_steady_out
from vibeam.flight.points.kernels.layout import FLIGHT_CLOCK, WIDTH

Array = NDArray[np.float64]

FEW = 1  # modes up to which extremes are found side by side: with more, lanes that need short panels hold up all others


@kernel
def read_rows(desk: Engine, room: Watch, first: int, last: int, rows: Array, readable: bool) -> None:
    """Read off the segments ``first`` to ``last`` (not itself) of the trace; ``rows``: of flights side by side."""
    trace, result, n, filled, start = room.trace, room.result, room.energy.shape[0], 0, first
    extremes_only = Watch(
        room.row, room.nothing, trace, room.poses, room.strobes, room.scratch, room.frame, result, room.energy,
        room.share, OUTPUT_ALONE if is_contact(room.row, desk.modes) else REACH_TOO,
    )  # fmt: skip
    few, coarsest = n <= FEW, int(desk.drive[COARSEST])
    for i in range(first, last):
        if trace[i, WHAT] != FREE:
            result[REST_TIME] += trace[i, DURATION]
        if trace[i, DURATION] > 0.0:
            if readable and trace[i, WHAT] == FREE:
                clock, duration = trace[i, AT_CLOCK], trace[i, DURATION]
                if not few:
                    read_flight(desk, extremes_only, room.poses[i], clock, duration, coarsest, ACCURACY)
                set_flight(rows, filled, clock, duration, room.poses[i])
                filled += 1
            else:
                copy_pose(room.poses[i], room.frame)
                read_segment(desk, room, i)
        note_impact(trace, i, result)
        if filled == WIDTH or (filled > 0 and i == last - 1):
            for slot in range(filled, WIDTH):
                set_no_flight(rows, slot, n)
            if not read_flights(desk, room, rows, (1 << filled) - 1, few):
                for j in range(start, i + 1):
                    if trace[j, WHAT] == FREE and trace[j, DURATION] > 0.0:
                        copy_pose(room.poses[j], room.frame)
                        read_segment(desk, room, j)
            filled, start = 0, i + 1
    if extremes_only.reading == OUTPUT_ALONE:
        result[CONTACT_LEAST] = min(result[CONTACT_LEAST], result[LEAST])


@joined
def is_contact(row: Array, modes: Array) -> bool:
    """Whether the output is the contact's displacement, whose extremes are those of the gap."""
    same = True
    for k in range(row.shape[0]):
        same = same and row[k] == modes[CONTACT, k]
    return same


@kernel
def read_flights(desk: Engine, room: Watch, rows: Array, used: int, extremes: bool) -> bool:
    """Energies and, where wanted, ``extremes`` of flights; False, and nothing, where that takes too much work."""
    modes, drive, like = desk.modes, desk.drive, eight()
    w = drive[W]
    sine, cosine = sine_cosine(w * load(rows, FLIGHT_CLOCK * WIDTH, like))
    take_steady_out(modes, drive, rows, cosine, sine)
    if extremes and not read_extremes(desk, room, rows, cosine, sine):
        return False
    add_energies(desk, rows, cosine, sine, used, room.energy)
    return True


@kernel
def read_extremes(desk: Engine, room: Watch, rows: Array, cosine: Lanes, sine: Lanes) -> bool:
    """Extremes of the output and the gap of the flights in ``rows``; False, and nothing, where that is not bounded."""
    modes, drive, result, like = desk.modes, desk.drive, room.result, eight()
    n, w, coarsest = modes.shape[1], drive[W], int(drive[COARSEST])
    const, re, im = 0.0, 0.0, 0.0
    for k in range(n):
        const += room.row[k] * modes[OFFSET, k]
        re += room.row[k] * modes[RE, k]
        im += room.row[k] * modes[IM, k]
    wave = Wave(const, w, re * cosine - im * sine, re * sine + im * cosine)
    known = Found(every(result[LEAST], like), every(result[HIGH], like))
    found, done = extremes_of_flights(
        desk.pairs, desk.table, desk.levels, rows, room.row, wave, coarsest, known, ACCURACY
    )
    if not done:
        return False
    if not is_contact(room.row, modes):
        wave = contact_wave(drive, cosine, sine)
        known = Found(every(result[CONTACT_LEAST], like), every(np.inf, like))
        reach, done = extremes_of_flights(
            desk.pairs, desk.table, desk.levels, rows, modes[CONTACT], wave, coarsest, known, ACCURACY
        )
        if not done:
            return False
        result[CONTACT_LEAST] = least_of(rows, reach.least)
    result[LEAST], result[HIGH] = least_of(rows, found.least), -least_of(rows, 0.0 - found.most)
    return True


@joined
def contact_wave(drive: Array, cosine: Lanes, sine: Lanes) -> Wave:
    """The contact's displacement Σ c_k η_k, its weights left out."""
    re, im = drive[CONTACT_RE], drive[CONTACT_IM]
    return Wave(drive[GAP] - drive[CLEARANCE], drive[W], re * cosine - im * sine, re * sine + im * cosine)
