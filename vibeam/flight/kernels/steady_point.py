"""What is read off a steady point: extremes, energies, impacts, strobes, and after how many periods it repeats."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import into_blocks, set_rest_signal
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.drive import phase
from vibeam.flight.kernels.energy import energy_at_rest, energy_in_flight
from vibeam.flight.kernels.extremes import ACCURACY, LIGHTLY, extremes_to
from vibeam.flight.kernels.layout import (
    AMODE,
    AT_CLOCK,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    BEFORE,
    CHATTER,
    COARSEST,
    CONST,
    CONTACT_LEAST,
    COSINE,
    DRIVE,
    DURATION,
    END,
    EVERYTHING,
    GAP,
    HIGH,
    IM,
    IMPACT,
    KEPT,
    LEAST,
    OFFSET,
    OMEGA,
    RE,
    REACH_TOO,
    REST_TIME,
    RESTING,
    SINE,
    SPEED_SUM,
    STRUCK,
    STUCK,
    VELOCITY,
    WEIGHT1,
    WEIGHT2,
    WHAT,
    X0,
    Y0,
    ZI,
    ZR,
    Engine,
    W,
    Watch,
)
from vibeam.flight.kernels.modal_flow import begin_flight
from vibeam.flight.kernels.roots.signal import rest_signal_of, signal_of

Array = NDArray[np.float64]


@kernel
def begin_output(desk: Engine, row: Array, pose: Array, clock: float) -> None:
    """row·η in flight as the free signal; the attached pairs must be those of this flight (``begin_flight``)."""
    pairs, modes, signal, attached = desk.pairs, desk.modes, desk.signal, desk.attached
    cosine, sine = phase(desk.drive, clock)
    w = desk.drive[W]
    const, re, im = 0.0, 0.0, 0.0
    for k in range(pairs.shape[1]):
        const += row[k] * modes[OFFSET, k]
        re += row[k] * modes[RE, k]
        im += row[k] * modes[IM, k]
        own = modes[OFFSET, k] + modes[RE, k] * sine + modes[IM, k] * cosine
        pairs[X0, k] = row[k] * (pose[0, k] - own)
        pairs[Y0, k] = row[k] * (pose[1, k] - w * (modes[RE, k] * cosine - modes[IM, k] * sine))
    for j in range(int(signal[ATTACHED])):
        k = int(attached[AMODE, j])
        attached[AX, j], attached[AY, j], attached[AWEIGHT, j] = pose[0, k], pose[1, k], row[k]
        pairs[X0, k], pairs[Y0, k] = 0.0, 0.0
    signal[CONST], signal[DRIVE], signal[COSINE], signal[SINE] = const, w, cosine, sine
    signal[ZR], signal[ZI] = re * cosine - im * sine, re * sine + im * cosine


@kernel
def begin_output_at_rest(desk: Engine, rest_row: Array, row: Array, pose: Array, clock: float) -> None:
    """row·η at rest as the rest signal; ``rest_row`` (2, n − 1) = row · from_blocks by block."""
    into_blocks(desk, pose, clock)
    const = 0.0
    for k in range(pose.shape[1]):
        const += row[k] * desk.held[k]
    for k in range(desk.blocks.shape[1]):
        desk.blocks[WEIGHT1, k], desk.blocks[WEIGHT2, k] = rest_row[0, k], rest_row[1, k]
    set_rest_signal(desk, const, 0.0, clock)


SAME = 1e-14  # the same where a period is taken for a copy of the one before

REPEATS = 1e-5  # share of the motion's size by which states one period apart may differ


@kernel
def start_watching(room: Watch, pose: Array) -> None:
    """Nothing is seen yet."""
    room.result[:], room.energy[:] = 0.0, 0.0
    room.result[HIGH], room.result[LEAST], room.result[CONTACT_LEAST] = -np.inf, np.inf, np.inf
    note_strobe(room.strobes, 0, pose)


@kernel
def note_strobe(strobes: Array, turn: int, pose: Array) -> None:
    """Keep the state at the end of a period."""
    for i in range(2):
        for k in range(pose.shape[1]):
            strobes[turn, i, k] = pose[i, k]


@kernel
def begin_period(room: Watch) -> None:
    """Note energies and time at rest before a period, taken off."""
    n = room.energy.shape[0]
    for k in range(n):
        room.share[k] = -room.energy[k]
    room.share[n] = -room.result[REST_TIME]


@kernel
def note_period(room: Watch) -> None:
    """What the period watched since ``begin_period`` has added."""
    n = room.energy.shape[0]
    for k in range(n):
        room.share[k] += room.energy[k]
    room.share[n] += room.result[REST_TIME]


@kernel
def repeat_period(room: Watch) -> None:
    """A period like the one watched last: the same energies and time at rest, no new extremes."""
    n = room.energy.shape[0]
    for k in range(n):
        room.energy[k] += room.share[k]
    room.result[REST_TIME] += room.share[n]


@kernel
def is_same(desk: Engine, strobes: Array, turn: int) -> bool:
    """Whether a period began as the one before it to round-off, so that it will be the same."""
    if turn < 1:
        return False
    apart = distance(desk.pairs, desk.drive, strobes, turn, turn - 1)
    return bool(apart <= SAME * SAME * distance(desk.pairs, desk.drive, strobes, turn, -1))


@kernel
def watch(desk: Engine, room: Watch, count: int) -> None:
    """Read off the segments just traced."""
    trace, frame, result = room.trace, room.frame, room.result
    coarsest = int(desk.drive[COARSEST])
    share = ACCURACY if room.reading >= EVERYTHING else LIGHTLY
    for i in range(count):
        clock, duration = trace[i, AT_CLOCK], trace[i, DURATION]
        for k in range(frame.shape[1]):
            frame[0, k], frame[1, k] = room.poses[i, 0, k], room.poses[i, 1, k]
        if trace[i, WHAT] == RESTING:
            result[REST_TIME] += duration
            result[CONTACT_LEAST] = min(result[CONTACT_LEAST], desk.drive[GAP])
            begin_output_at_rest(desk, room.rest_row, room.row, frame, clock)
            result[LEAST], result[HIGH] = extremes_to(
                rest_signal_of(desk), duration, coarsest, result[LEAST], result[HIGH], share
            )
            if room.reading >= EVERYTHING:
                energy_at_rest(desk, frame, clock, duration, room.scratch, room.energy)
        elif duration > 0.0:
            watch_flight(desk, room, frame, clock, duration, coarsest, share)
        note_impact(trace, i, result)
        if is_unread(result):
            return


@kernel
def is_unread(result: Array) -> bool:
    """Whether the extremes of what was traced were not found in bounded work."""
    return bool(result[HIGH] == np.inf or result[CONTACT_LEAST] == -np.inf)


@kernel
def watch_flight(
    desk: Engine, room: Watch, pose: Array, clock: float, duration: float, coarsest: int, share: float
) -> None:
    """Extremes of the output and, as far as is asked, of the gap, and the modes' energies, over one flight."""
    result = room.result
    cosine, sine = phase(desk.drive, clock)
    begin_flight(desk, pose, cosine, sine)
    if room.reading >= EVERYTHING:
        energy_in_flight(desk, pose, clock, duration, room.energy)
    if room.reading >= REACH_TOO:
        _, widest = extremes_to(
            signal_of(desk), duration, coarsest, 0.0, desk.drive[GAP] - result[CONTACT_LEAST], share
        )
        result[CONTACT_LEAST] = desk.drive[GAP] - widest
    begin_output(desk, room.row, pose, clock)
    result[LEAST], result[HIGH] = extremes_to(signal_of(desk), duration, coarsest, result[LEAST], result[HIGH], share)


@kernel
def note_impacts(room: Watch, count: int) -> None:
    """Count the impacts of the segments just traced, and nothing else."""
    for i in range(count):
        note_impact(room.trace, i, room.result)


@kernel
def note_impact(trace: Array, i: int, result: Array) -> None:
    """Count the impact that ends a segment and keep its velocity in a ring."""
    if trace[i, END] == IMPACT or trace[i, END] == CHATTER or trace[i, END] == STUCK:
        result[VELOCITY + int(result[STRUCK]) % KEPT] = trace[i, BEFORE]
        result[STRUCK] += 1.0
        result[SPEED_SUM] += trace[i, BEFORE]


@kernel
def repetition(pairs: Array, drive: Array, strobes: Array, hold: int, longest: int) -> int:
    """The least k ≤ longest such that each of the last k strobes repeats the one k periods before, else 0."""
    size = 0.0
    for turn in range(hold + 1):
        size = max(size, distance(pairs, drive, strobes, turn, -1))
    for k in range(1, min(longest, hold // 2) + 1):
        worst = 0.0
        for turn in range(hold - k + 1, hold + 1):
            worst = max(worst, distance(pairs, drive, strobes, turn, turn - k))
        if worst <= REPEATS * REPEATS * size:
            return k
    return 0


@kernel
def distance(pairs: Array, drive: Array, strobes: Array, first: int, second: int) -> float:
    """Squared distance of two strobes in velocity units; from the origin where the second is negative."""
    total = 0.0
    for k in range(pairs.shape[1]):
        x, y = strobes[first, 0, k], strobes[first, 1, k]
        if second >= 0:
            x -= strobes[second, 0, k]
            y -= strobes[second, 1, k]
        total += y * y + (pairs[OMEGA, k] * pairs[OMEGA, k] + drive[W] * drive[W]) * x * x
    return total
