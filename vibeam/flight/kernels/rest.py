"""Rest on the stop: how it begins, the contact force as a signal, and the release where it vanishes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.layout import (
    CLOCK,
    COARSEST_AT_REST,
    COMPLETE,
    CONST,
    CONTACT,
    FORCE_SIGNAL,
    FREE,
    IMPACT,
    KAPPA,
    KIND,
    LOAD,
    MOBILITY,
    NO_CLOCK,
    NOT_FINITE,
    OMEGA,
    ORDER,
    PANELS,
    PHASE_COS,
    PHASE_SIN,
    RELEASE,
    RESTING,
    RISE,
    SIGMA,
    SPAN_END,
    STATIC,
    STRENGTH,
    STUCK,
    UNRESOLVED,
    Engine,
    W,
)
from vibeam.flight.kernels.modal_flow import ROUND_OFF, contact_pull
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.signal import Start, signal_of
from vibeam.flight.kernels.segments import Record, close_segment

Array = NDArray[np.float64]

SMALLEST = 1e-300


@kernel
def begin_rest(desk: Engine, pose: Array, clock: float) -> tuple[float, float, float]:
    """The contact force (positive: it presses) as the rest signal: its value and rate now, the size of its parts."""
    to_block_coordinates(desk.rest, desk.drive, pose, clock)
    force, rate, size = set_signal(desk.rest, desk.drive, FORCE_SIGNAL, 1.0, clock)
    parts = 0.0  # of the force, mode by mode, before they cancel
    for k in range(pose.shape[1]):
        own, damp = desk.pairs[OMEGA, k], 2.0 * desk.pairs[SIGMA, k]
        push = abs(desk.modes[STATIC, k]) + abs(desk.modes[LOAD, k] * desk.drive[STRENGTH])
        parts += abs(desk.modes[CONTACT, k]) * (own * own * abs(pose[0, k]) + damp * abs(pose[1, k]) + push)
    return force, rate, max(size, parts / desk.drive[MOBILITY])


@kernel
def rest_on_stop(desk: Engine, pose: Array, status: Array, span: float, record: Record) -> tuple[int, float]:
    """One rest on the stop, until the contact force vanishes: outcome, duration."""
    rest = desk.rest
    force, rate, size = begin_rest(desk, pose, status[CLOCK])
    if not np.isfinite(size):
        return NOT_FINITE, 0.0
    none = max(ROUND_OFF * size, SMALLEST)  # no more of a force than round-off
    order = 0 if force > none else 1
    fastest = max(desk.drive[W], desk.pairs[KAPPA, pose.shape[1] - 1])
    if order == 1 and (rate <= none * fastest or force < -none):
        toward, jerk = contact_pull(desk.pairs, desk.modes, desk.drive, pose, status)
        if release(status, toward, jerk, False):
            return COMPLETE, 0.0
        order = 0  # no force that can be told from none: it holds until one draws the contact away
        rest.signal[CONST] += 2.0 * none
    found, duration, panels = first_root(
        signal_of(rest), Start(order, rate), span, int(desk.drive[COARSEST_AT_REST]),
        InitialState(desk.modes, desk.drive, pose, NO_CLOCK),
    )  # fmt: skip
    record.counts[PANELS] += panels
    if duration < 0.0:
        return UNRESOLVED, 0.0
    advance_blocks(rest, desk.drive, pose, status[CLOCK], duration)
    if not np.isfinite(pose[0, 0]):
        return UNRESOLVED, 0.0
    status[CLOCK] = wrap(desk.drive, status[CLOCK] + duration)
    status[PHASE_COS], status[PHASE_SIN] = phase(desk.drive, status[CLOCK])
    close_segment(record.trace, duration, RELEASE if found else SPAN_END, 0.0, record.counts)
    if found:
        toward, jerk = contact_pull(desk.pairs, desk.modes, desk.drive, pose, status)
        release(status, toward, jerk, True)
    return COMPLETE, duration


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
    status[KIND] = FREE if order > 0 else RESTING
    status[ORDER], status[RISE] = max(order, 0), rise
    return IMPACT if order > 0 else STUCK


@joined
def release(status: Array, toward: float, jerk: float, at_root: bool) -> bool:
    """Leave the stop where the motion is drawn away from it: with acceleration, or with jerk at the force's root."""
    if jerk < 0.0 and (at_root or toward >= 0.0):
        status[ORDER], status[RISE] = 3.0, -jerk
    elif toward < 0.0:
        status[ORDER], status[RISE] = 2.0, -toward
    else:
        return False
    status[KIND] = FREE
    return True
