"""One lane's share of the rows: its point's constants, and the tables of the panel length that it takes."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.lanes import layout as cells
from vibeam.flight.points.kernels import layout as row
from vibeam.flight.points.kernels.layout import Lane, Rows


@joined
def modes_of(rows: Rows) -> int:
    """Number of modes."""
    return int(rows.modal.shape[0] // (row.MODAL_ROWS * row.WIDTH))


@joined
def place(k: int, of: int, lane: int) -> int:
    """Where the row ``of`` has mode k's number of one lane."""
    return (k * row.MODAL_ROWS + of) * row.WIDTH + lane


@joined
def block_width(n: int) -> int:
    """How many modes stand side by side in ``cells`` and ``rungs``: see ``linear.packing``."""
    return 1 if n == 1 else 8


@kernel
def take_panel(rows: Rows, slot: int, level: int) -> None:
    """The lane walks on in panels of that level."""
    common, modal, levels, rungs = rows
    n = modes_of(rows)
    side = block_width(n)
    blocks = (n + side - 1) // side
    common[row.LEVEL * row.WIDTH + slot] = level
    common[row.STEP * row.WIDTH + slot] = levels[slot, layout.STEP, level]
    common[row.TURN_RE * row.WIDTH + slot] = levels[slot, layout.TURN_RE, level]
    common[row.TURN_IM * row.WIDTH + slot] = levels[slot, layout.TURN_IM, level]
    for k in range(n):
        at = (level * blocks + k // side) * cells.RUNG_ROWS * side + k % side
        for j in range(4):
            modal[place(k, row.P00 + j, slot)] = rungs[slot, at + (cells.P00 + j) * side]
        modal[place(k, row.LOW, slot)] = rungs[slot, at + cells.LOW * side]
        modal[place(k, row.MISSED, slot)] = rungs[slot, at + cells.MISSED * side]


@kernel
def take_first_panel(rows: Rows, slot: int, level: int) -> None:
    """The lane tries first panels of that level."""
    common, modal, levels, rungs = rows
    n = modes_of(rows)
    side = block_width(n)
    blocks = (n + side - 1) // side
    common[row.LEVEL_1 * row.WIDTH + slot] = level
    common[row.STEP_1 * row.WIDTH + slot] = levels[slot, layout.STEP, level]
    common[row.TURN_RE_1 * row.WIDTH + slot] = levels[slot, layout.TURN_RE, level]
    common[row.TURN_IM_1 * row.WIDTH + slot] = levels[slot, layout.TURN_IM, level]
    common[row.SECOND_RE * row.WIDTH + slot] = levels[slot, layout.SECOND_RE, level]
    common[row.SECOND_IM * row.WIDTH + slot] = levels[slot, layout.SECOND_IM, level]
    common[row.FIRST_RE * row.WIDTH + slot] = levels[slot, layout.FIRST_RE, level]
    common[row.FIRST_IM * row.WIDTH + slot] = levels[slot, layout.FIRST_IM, level]
    for k in range(n):
        at = (level * blocks + k // side) * cells.RUNG_ROWS * side + k % side
        for j in range(4):
            modal[place(k, row.D0 + j, slot)] = rungs[slot, at + (cells.D0 + j) * side]
        modal[place(k, row.LOW_1, slot)] = rungs[slot, at + cells.LOW * side]
        modal[place(k, row.MISSED_1, slot)] = rungs[slot, at + cells.MISSED_FIRST * side]


@kernel
def take_constants(lane: Lane, slot: int) -> None:
    """The lane's rows of its modes' constants, from its engine's ``cells``."""
    n, modal, source = lane.poses.shape[2], lane.modal, lane.engines.cells
    side = block_width(n)
    for k in range(n):
        at = (k // side) * cells.CELL_ROWS * side + k % side
        for j in range(12):  # RATE … K5 stand in the same order in both
            modal[place(k, row.RATE + j, slot)] = source[slot, at + (cells.RATE + j) * side]
