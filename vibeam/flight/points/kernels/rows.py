"""Rows of points in lanes, and of one point's flights in lanes: their places, one lane's share, tables of a panel."""

from __future__ import annotations

from math import sqrt

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.energy import SPLIT
from vibeam.flight.kernels.lanes import layout as cells
from vibeam.flight.kernels.lanes.simd import Lanes, eight, load, pick, store
from vibeam.flight.kernels.layout import REDUCED, Engine
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import Lane, LaneRows
from vibeam_models.arrays import Array


@joined
def modes_of(rows: LaneRows) -> int:
    """Number of modes."""
    return int(rows.modal.shape[0] // (row.MODAL_ROWS * row.WIDTH))


@joined
def place(k: int, of: int, lane: int) -> int:
    """Place of mode k's number of one lane in the row ``of``."""
    return (k * row.MODAL_ROWS + of) * row.WIDTH + lane


@joined
def get(rows: Array, which: int, like: Lanes) -> Lanes:
    """A row of ``common``."""
    return load(rows, which * row.WIDTH, like)


@joined
def put(rows: Array, which: int, value: Lanes) -> None:
    """Set a row of ``common``."""
    store(rows, which * row.WIDTH, value)


@joined
def blend(rows: Array, which: int, bits: int, value: Lanes, like: Lanes) -> None:
    """Set a row of ``common`` in some lanes."""
    at = which * row.WIDTH
    store(rows, at, pick(bits, value, load(rows, at, like)))


@joined
def mode(k: int, which: int) -> int:
    """Place at which a row of a mode begins."""
    return (k * row.MODAL_ROWS + which) * row.WIDTH


@joined
def block_width(n: int) -> int:
    """Number of modes side by side in ``cells`` and ``rungs``: see ``linear.packing``."""
    return 1 if n == 1 else 8


@joined
def take_tables(rows: LaneRows, slot: int, level: int, target: int, source: int, missed: int) -> None:
    """A lane's tables of one panel length: four rows of each mode, whether it is resolved, what the hull misses."""
    n = modes_of(rows)
    side = block_width(n)
    blocks = (n + side - 1) // side
    for k in range(n):
        at = (level * blocks + k // side) * cells.RUNG_ROWS * side + k % side
        for j in range(4):
            rows.modal[place(k, target + j, slot)] = rows.rungs[slot, at + (source + j) * side]
        rows.modal[place(k, target + 4, slot)] = rows.rungs[slot, at + cells.LOW * side]
        rows.modal[place(k, target + 5, slot)] = rows.rungs[slot, at + missed * side]


@kernel
def take_panel(rows: LaneRows, slot: int, level: int) -> None:
    """The lane walks on in panels of that level."""
    rows.common[row.LEVEL * row.WIDTH + slot] = level
    rows.common[row.STEP * row.WIDTH + slot] = rows.levels[slot, layout.STEP, level]
    for j in range(2):  # real and imaginary part of the turn
        rows.common[(row.TURN_RE + j) * row.WIDTH + slot] = rows.levels[slot, layout.TURN_RE + j, level]
    take_tables(rows, slot, level, row.P00, cells.P00, cells.MISSED)


@kernel
def take_first_panel(rows: LaneRows, slot: int, level: int) -> None:
    """The lane tries first panels of that level."""
    rows.common[row.LEVEL_1 * row.WIDTH + slot] = level
    rows.common[row.STEP_1 * row.WIDTH + slot] = rows.levels[slot, layout.STEP, level]
    for j in range(6):  # TURN_RE … FIRST_IM stand in the same order in both
        rows.common[(row.TURN_RE_1 + j) * row.WIDTH + slot] = rows.levels[slot, layout.TURN_RE + j, level]
    take_tables(rows, slot, level, row.D0, cells.D0, cells.MISSED_FIRST)


@kernel
def take_constants(lane: Lane, slot: int) -> None:
    """The lane's rows of its modes' constants, from its engine's ``cells``."""
    n, modal, source = lane.poses.shape[2], lane.modal, lane.engines.cells
    side = block_width(n)
    for k in range(n):
        at = (k // side) * cells.CELL_ROWS * side + k % side
        for j in range(12):  # RATE … K5 stand in the same order in both
            modal[place(k, row.RATE + j, slot)] = source[slot, at + (cells.RATE + j) * side]


@joined
def flight(k: int, which: int) -> int:
    """Place at which a row of mode k begins."""
    return (row.FLIGHT_COMMON + k * row.FLIGHT_ROWS + which) * row.WIDTH


@kernel
def is_readable(engine: Engine) -> bool:
    """True where flights may be read off side by side: every mode well underdamped, in a phase that can be reduced."""
    found = engine.signal[layout.ATTACHED] == 0.0
    for k in range(engine.pairs.shape[1]):
        disc, own = engine.pairs[layout.DISC, k], engine.pairs[layout.OMEGA, k]
        found = found and disc <= -SPLIT * SPLIT * own * own and disc < 0.0
        found = found and sqrt(max(-disc, 0.0)) * engine.drive[layout.PERIOD] < REDUCED
    return bool(found)


@joined
def set_flight(rows: Array, slot: int, clock: float, span: float, pose: Array) -> None:
    """A flight in its lane."""
    rows[row.FLIGHT_CLOCK * row.WIDTH + slot], rows[row.FLIGHT_SPAN * row.WIDTH + slot] = clock, span
    for k in range(pose.shape[1]):
        rows[flight(k, row.FLIGHT_U) + slot], rows[flight(k, row.FLIGHT_V) + slot] = pose[0, k], pose[1, k]


@joined
def set_no_flight(rows: Array, slot: int, n: int) -> None:
    """No flight in that lane."""
    rows[row.FLIGHT_CLOCK * row.WIDTH + slot], rows[row.FLIGHT_SPAN * row.WIDTH + slot] = 0.0, 0.0
    for k in range(n):
        rows[flight(k, row.FLIGHT_U) + slot], rows[flight(k, row.FLIGHT_V) + slot] = 0.0, 0.0


@joined
def take_steady_out(modes: Array, drive: Array, rows: Array, cosine: Lanes, sine: Lanes) -> None:
    """FLIGHT_U, FLIGHT_V, the modes' displacements and velocities so far, less the steady response."""
    like, w = eight(), drive[layout.W]
    for k in range(modes.shape[1]):
        re, im = modes[layout.RE, k], modes[layout.IM, k]
        x, y = load(rows, flight(k, row.FLIGHT_U), like), load(rows, flight(k, row.FLIGHT_V), like)
        store(rows, flight(k, row.FLIGHT_U), (x - modes[layout.OFFSET, k]) - (re * sine + im * cosine))
        store(rows, flight(k, row.FLIGHT_V), y - w * (re * cosine - im * sine))
