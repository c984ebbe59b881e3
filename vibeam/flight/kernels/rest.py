"""Rest on the stop: how it begins, the contact force as a signal, and the release where it vanishes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.modal_flow import ROUND_OFF, contact_pull
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import Record, close_segment

Array = NDArray[np.float64]

SMALLEST = 1e-300


@kernel
def begin_rest(engine: Engine, pose: Array, clock: float) -> tuple[float, float, float]:
    """The contact force (positive: it presses) as the rest signal: its value and rate now, the size of its parts."""
    to_block_coordinates(engine.rest, engine.drive, pose, clock)
    force, rate, size = set_signal(engine.rest, engine.drive, layout.FORCE_SIGNAL, 1.0, clock)
    parts = 0.0  # of the force, mode by mode, before they cancel
    for k in range(pose.shape[1]):
        own, damp = engine.pairs[layout.OMEGA, k], 2.0 * engine.pairs[layout.SIGMA, k]
        push = abs(engine.modes[layout.STATIC, k]) + abs(engine.modes[layout.LOAD, k] * engine.drive[layout.STRENGTH])
        parts += abs(engine.modes[layout.CONTACT, k]) * (own * own * abs(pose[0, k]) + damp * abs(pose[1, k]) + push)
    return force, rate, max(size, parts / engine.drive[layout.MOBILITY])


@kernel
def rest_on_stop(engine: Engine, pose: Array, status: Array, span: float, record: Record) -> tuple[int, float]:
    """One rest on the stop, until the contact force vanishes: outcome, duration."""
    rest = engine.rest
    force, rate, size = begin_rest(engine, pose, status[layout.CLOCK])
    if not np.isfinite(size):
        return layout.NOT_FINITE, 0.0
    none = max(ROUND_OFF * size, SMALLEST)  # no more of a force than round-off
    order = 0 if force > none else 1
    fastest = max(engine.drive[layout.W], engine.pairs[layout.KAPPA, pose.shape[1] - 1])
    if order == 1 and (rate <= none * fastest or force < -none):
        toward, jerk = contact_pull(engine.pairs, engine.modes, engine.drive, pose, status)
        if release(status, toward, jerk, False):
            return layout.COMPLETE, 0.0
        order = 0  # no force that can be told from none: it holds until one draws the contact away
        rest.signal[layout.CONST] += 2.0 * none
    found, duration, panels = first_root(
        signal_of(rest), Start(order, rate), span, int(engine.drive[layout.COARSEST_AT_REST]),
        InitialState(engine.modes, engine.drive, pose, layout.NO_CLOCK),
    )  # fmt: skip
    record.counts[layout.PANELS] += panels
    if duration < 0.0:
        return layout.UNRESOLVED, 0.0
    advance_blocks(rest, engine.drive, pose, status[layout.CLOCK], duration)
    if not np.isfinite(pose[0, 0]):
        return layout.UNRESOLVED, 0.0
    status[layout.CLOCK] = wrap(engine.drive, status[layout.CLOCK] + duration)
    status[layout.PHASE_COS], status[layout.PHASE_SIN] = phase(engine.drive, status[layout.CLOCK])
    close_segment(record.trace, duration, layout.RELEASE if found else layout.SPAN_END, 0.0, record.counts)
    if found:
        toward, jerk = contact_pull(engine.pairs, engine.modes, engine.drive, pose, status)
        release(status, toward, jerk, True)
    return layout.COMPLETE, duration


@joined
def opening_order(toward: float, jerk: float) -> tuple[int, float]:
    """Order and size of the derivative by which the gap opens from the stop without velocity; −1 where it closes, 0
    where neither can be told from round-off. ``toward``, ``jerk``: of the contact, toward the stop, in free motion.
    """
    if toward < 0.0:
        return 2, -toward
    if toward == 0.0 and jerk <= 0.0:
        return 3 if jerk < 0.0 else 0, -jerk
    return -1, 0.0


@joined
def lift_or_rest(status: Array, toward: float, jerk: float) -> int:
    """On the stop without velocity: pressed against it (or not drawn away) it rests, drawn away it flies."""
    order, rise = opening_order(toward, jerk)
    status[layout.KIND] = layout.FREE if order > 0 else layout.RESTING
    status[layout.ORDER], status[layout.RISE] = max(order, 0), rise
    return layout.IMPACT if order > 0 else layout.STUCK


@joined
def release(status: Array, toward: float, jerk: float, at_root: bool) -> bool:
    """Leave the stop where the motion is drawn away from it: with acceleration, or with jerk at the force's root."""
    if jerk < 0.0 and (at_root or toward >= 0.0):
        status[layout.ORDER], status[layout.RISE] = 3.0, -jerk
    elif toward < 0.0:
        status[layout.ORDER], status[layout.RISE] = 2.0, -toward
    else:
        return False
    status[layout.KIND] = layout.FREE
    return True
