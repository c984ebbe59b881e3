"""Free flight and rest of a plain system: from the modal state to the gap, or the contact force, as a signal and back.

How a rest begins, and its release where the force vanishes.
"""

from __future__ import annotations

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.block_flow import advance_blocks, set_signal, to_block_coordinates
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.layout import SILENT, Engine
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.double_gap import InitialState
from vibeam.flight.kernels.roots.first_root import first_root
from vibeam.flight.kernels.roots.pair import norm, propagator
from vibeam.flight.kernels.roots.signal import Start, signal_of, value_at
from vibeam.flight.kernels.segments import MotionRecord, close_segment
from vibeam_models.arrays import Array

ROUND_OFF = 64.0 * 2.220446049250313e-16  # share of the parts of a sum below which it is none
SMALLEST = 1e-300


@joined
def begin_flight(engine: Engine, pose: Array, cosine: float, sine: float) -> tuple[float, float, float]:
    """The gap as a signal from ``pose`` at that drive phase: value, slope, size of its parts.

    g(t) = Δ − w·η: const = Δ − Σ w_k s_k/ω_k², z = −Σ w_k H_k e^{iφ}, x_k = −w_k (η_k − Im(H_k e^{iφ}) − s_k/ω_k²).
    """
    pairs, signal, attached, modes, drive = engine.pairs, engine.signal, engine.attached, engine.modes, engine.drive
    zr = -(drive[layout.CONTACT_RE] * cosine - drive[layout.CONTACT_IM] * sine)
    zi = -(drive[layout.CONTACT_RE] * sine + drive[layout.CONTACT_IM] * cosine)
    signal[layout.CONST], signal[layout.ZR], signal[layout.ZI] = drive[layout.CLEARANCE], zr, zi
    signal[layout.DRIVE] = drive[layout.W]
    signal[layout.COSINE], signal[layout.SINE] = cosine, sine
    value, slope = drive[layout.CLEARANCE] + zi, drive[layout.W] * zr
    size = abs(drive[layout.GAP]) + abs(drive[layout.CLEARANCE]) + norm(zr, zi)
    for k in range(pairs.shape[1]):
        c = modes[layout.CONTACT, k]
        x = -c * (pose[0, k] - modes[layout.OFFSET, k] - (modes[layout.RE, k] * sine + modes[layout.IM, k] * cosine))
        y = -c * (pose[1, k] - drive[layout.W] * (modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine))
        value += x
        slope += y
        size += abs(c * pose[0, k]) + abs(x)
        pairs[layout.X0, k], pairs[layout.Y0, k] = x, y
    for j in range(int(signal[layout.ATTACHED])):
        k = int(attached[layout.AMODE, j])
        attached[layout.AX, j], attached[layout.AY, j] = pose[0, k], pose[1, k]
        attached[layout.ASIGMA, j], attached[layout.AOMEGA, j] = pairs[layout.SIGMA, k], pairs[layout.OMEGA, k]
        attached[layout.ASINE, j], attached[layout.ACOSINE, j] = modes[layout.LOAD, k] * drive[layout.STRENGTH], 0.0
        attached[layout.ASTATIC, j] = modes[layout.STATIC, k]
        attached[layout.AWEIGHT, j] = -modes[layout.CONTACT, k]
        pairs[layout.X0, k], pairs[layout.Y0, k] = 0.0, 0.0
    return value, slope, size


@joined
def is_plain_start(order: float, value: float, size: float) -> bool:
    """True where a flight just begun starts off the stop, or on it with a velocity: from there it may go in lanes."""
    return bool(np.isfinite(size) and (order == 1.0 or (order == 0.0 and value > ROUND_OFF * size)))


@joined
def end_flight(engine: Engine, pose: Array, status: Array, flight: float, found: bool) -> None:
    """Set ``pose``, and the clock in ``status``, to the end of the flight: η_k = −x_k/w_k + Im(H_k e^{iφ}) + s_k/ω_k².

    At a root XT, YT and the trial hold the pairs already; otherwise they are evaluated here.
    """
    pairs, signal, attached, modes, drive = engine.pairs, engine.signal, engine.attached, engine.modes, engine.drive
    if not found:
        att.restart(attached, signal)
        value_at(signal_of(engine), 0.0, flight)
    status[layout.CLOCK] = wrap(drive, status[layout.CLOCK] + flight)
    cosine, sine = phase(drive, status[layout.CLOCK])
    status[layout.PHASE_COS], status[layout.PHASE_SIN] = cosine, sine
    w = drive[layout.W]
    for k in range(pairs.shape[1]):
        c, re, im, offset = modes[layout.CONTACT, k], modes[layout.RE, k], modes[layout.IM, k], modes[layout.OFFSET, k]
        if abs(c) > SILENT:
            x, y = -pairs[layout.XT, k] / c, -pairs[layout.YT, k] / c
        else:
            own = re * signal[layout.SINE] + im * signal[layout.COSINE] + offset
            own_slope = w * (re * signal[layout.COSINE] - im * signal[layout.SINE])
            p00, p01, p10, p11 = propagator(
                pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], flight
            )
            x = p00 * (pose[0, k] - own) + p01 * (pose[1, k] - own_slope)
            y = p10 * (pose[0, k] - own) + p11 * (pose[1, k] - own_slope)
        pose[0, k] = x + offset + re * sine + im * cosine
        pose[1, k] = y + w * (re * cosine - im * sine)
    for j in range(int(signal[layout.ATTACHED])):
        k = int(attached[layout.AMODE, j])
        pose[0, k], pose[1, k] = attached[layout.TRIAL_X, j], attached[layout.TRIAL_Y, j]


@joined
def contact_derivatives(pairs: Array, modes: Array, drive: Array, pose: Array, status: Array) -> tuple[float, float]:
    """w·η'' and w·η''' of the free system, positive toward the stop: η'' = l Ω²B sin φ + s − 2ση' − ω²η."""
    cosine, sine = status[layout.PHASE_COS], status[layout.PHASE_SIN]
    second, third = 0.0, 0.0
    for k in range(pairs.shape[1]):
        damp, spring = 2.0 * pairs[layout.SIGMA, k], pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
        push = modes[layout.LOAD, k] * drive[layout.STRENGTH]
        acceleration = push * sine + modes[layout.STATIC, k] - damp * pose[1, k] - spring * pose[0, k]
        second += modes[layout.CONTACT, k] * acceleration
        third += modes[layout.CONTACT, k] * (
            push * drive[layout.W] * cosine - damp * acceleration - spring * pose[1, k]
        )
    return second, third


@kernel
def contact_pull(pairs: Array, modes: Array, drive: Array, pose: Array, status: Array) -> tuple[float, float]:
    """As ``contact_derivatives``, each 0 where it is but the round-off of what it is the sum of."""
    second, third = contact_derivatives(pairs, modes, drive, pose, status)
    second_size, third_size = 0.0, 0.0
    for k in range(pairs.shape[1]):
        weight, spring = abs(modes[layout.CONTACT, k]), pairs[layout.OMEGA, k] * pairs[layout.OMEGA, k]
        damp, push = 2.0 * pairs[layout.SIGMA, k], abs(modes[layout.LOAD, k] * drive[layout.STRENGTH])
        parts = push + abs(modes[layout.STATIC, k]) + damp * abs(pose[1, k]) + spring * abs(pose[0, k])
        second_size += weight * parts
        third_size += weight * (
            push * drive[layout.W] + damp * parts + spring * abs(pose[1, k]) + pairs[layout.OMEGA, k] * parts
        )
    second = second if abs(second) > ROUND_OFF * second_size else 0.0
    third = third if abs(third) > ROUND_OFF * third_size else 0.0
    return second, third


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
def rest_on_stop(engine: Engine, pose: Array, status: Array, span: float, record: MotionRecord) -> tuple[int, float]:
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
