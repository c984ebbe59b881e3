"""Segments of contacts that are integrated, integrated anew: poses in them, extremes, energies."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.integration import begin, first_step, step, take
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.reactions import each
from vibeam.flight.kernels.layout import Watch
from vibeam.flight.kernels.regimes.contact_integration import BEGIN
from vibeam.flight.kernels.regimes.integrated import carrying_kernel, span_kernel
from vibeam.flight.kernels.segments import copy_pose
from vibeam_models.arrays import Array


@kernel
def enter_segment(engine: ContactEngine, pose: Array, segment: Array) -> None:
    """Set ``engine.trial`` as the status at the start of a traced segment; state[BEGIN] is its first pose."""
    status = engine.trial
    status[layout.CLOCK], status[row.HELD] = segment[layout.AT_CLOCK], segment[row.HELD_AT]
    status[row.PIECE] = segment[row.PIECE_AT]
    for j in range(engine.rows.shape[0]):
        pushed = (int(segment[row.PUSHED_AT]) >> j) & 1 > 0
        status[each(engine, row.CONDITION, j)] = row.PUSHING if pushed else row.AWAY
    begin(engine, pose, status)


@kernel
def read(engine: ContactEngine, wanted: Array, place: int, stage: int) -> tuple[float, float, float]:
    """row·η, its rate and curvature at state[place], whose rate is stages[stage]."""
    value, rate, bend = 0.0, 0.0, 0.0
    for k in range(wanted.shape[0]):
        value += wanted[k] * engine.state[place, 0, k]
        rate += wanted[k] * engine.state[place, 1, k]
        bend += wanted[k] * engine.stages[stage, 1, k]
    return value, rate, bend


@kernel
def add_energy_of_step(engine: ContactEngine, h: float, energy: Array) -> None:
    """Add ∫ ½(η'² + ω²η²) dt of every mode over the step just made, by its own quadrature of order 8."""
    for k in range(energy.shape[0]):
        total = 0.0
        for s in range(12):
            x, y = engine.state[BEGIN, 0, k], engine.stages[s, 0, k]
            for j in range(s):
                x += h * engine.nodes[s, j] * engine.stages[j, 0, k]
            total += engine.nodes[12, s] * (y * y + engine.spring[k] * x * x)
        energy[k] += 0.5 * h * total


carry_on = carrying_kernel(first_step, step, take)
read_span = span_kernel(first_step, step, take, read, add_energy_of_step)


@kernel
def integrated_at(engine: ContactEngine, pose: Array, segment: Array, duration: float) -> None:
    """Set ``pose`` to ``duration`` later in a segment."""
    enter_segment(engine, pose, segment)
    carry_on(engine, engine.trial, segment[layout.AT_CLOCK], duration)
    copy_pose(engine.state[BEGIN], pose)


@kernel
def read_integrated(engine: ContactEngine, watch: Watch, segment: Array) -> None:
    """Extremes to round-off, energies by the steps' quadrature, of a segment from its first pose in ``watch.frame``."""
    enter_segment(engine, watch.frame, segment)
    clock, duration = segment[layout.AT_CLOCK], segment[layout.DURATION]
    read_span(engine, engine.trial, watch, engine.rows[0], clock, duration)
