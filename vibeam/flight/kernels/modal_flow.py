"""Free flight: from the modal state to the gap as a signal, and back to the state where the flight ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.layout import (
    ACOSINE,
    AMODE,
    AOMEGA,
    ASIGMA,
    ASINE,
    ASTATIC,
    ATTACHED,
    AWEIGHT,
    AX,
    AY,
    CLEARANCE,
    CLOCK,
    CONST,
    CONTACT,
    CONTACT_IM,
    CONTACT_RE,
    COSINE,
    DISC,
    DRIVE,
    GAP,
    IM,
    LOAD,
    OFFSET,
    OMEGA,
    PHASE_COS,
    PHASE_SIN,
    RE,
    SIGMA,
    SINE,
    STATIC,
    STRENGTH,
    TRIAL_X,
    TRIAL_Y,
    X0,
    XT,
    Y0,
    YT,
    ZI,
    ZR,
    Engine,
    W,
)
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.pair import norm, propagator
from vibeam.flight.kernels.roots.signal import signal_of, value_at
from vibeam.flight.kernels.thresholds import SILENT

Array = NDArray[np.float64]

ROUND_OFF = 64.0 * 2.220446049250313e-16  # share of the parts of a sum below which it is none


@joined
def begin_flight(desk: Engine, pose: Array, cosine: float, sine: float) -> tuple[float, float, float]:
    """The gap as a signal from ``pose`` at that drive phase: value, slope, size of its parts.

    g(t) = Δ − w·η: const = Δ − Σ w_k s_k/ω_k², z = −Σ w_k H_k e^{iφ}, x_k = −w_k (η_k − Im(H_k e^{iφ}) − s_k/ω_k²).
    """
    pairs, signal, attached, modes, drive = desk.pairs, desk.signal, desk.attached, desk.modes, desk.drive
    zr = -(drive[CONTACT_RE] * cosine - drive[CONTACT_IM] * sine)
    zi = -(drive[CONTACT_RE] * sine + drive[CONTACT_IM] * cosine)
    signal[CONST], signal[ZR], signal[ZI], signal[DRIVE] = drive[CLEARANCE], zr, zi, drive[W]
    signal[COSINE], signal[SINE] = cosine, sine
    value, slope = drive[CLEARANCE] + zi, drive[W] * zr
    size = abs(drive[GAP]) + abs(drive[CLEARANCE]) + norm(zr, zi)
    for k in range(pairs.shape[1]):
        c = modes[CONTACT, k]
        x = -c * (pose[0, k] - modes[OFFSET, k] - (modes[RE, k] * sine + modes[IM, k] * cosine))
        y = -c * (pose[1, k] - drive[W] * (modes[RE, k] * cosine - modes[IM, k] * sine))
        value += x
        slope += y
        size += abs(c * pose[0, k]) + abs(x)
        pairs[X0, k], pairs[Y0, k] = x, y
    for j in range(int(signal[ATTACHED])):
        k = int(attached[AMODE, j])
        attached[AX, j], attached[AY, j] = pose[0, k], pose[1, k]
        attached[ASIGMA, j], attached[AOMEGA, j] = pairs[SIGMA, k], pairs[OMEGA, k]
        attached[ASINE, j], attached[ACOSINE, j] = modes[LOAD, k] * drive[STRENGTH], 0.0
        attached[ASTATIC, j] = modes[STATIC, k]
        attached[AWEIGHT, j] = -modes[CONTACT, k]
        pairs[X0, k], pairs[Y0, k] = 0.0, 0.0
    return value, slope, size


@joined
def end_flight(desk: Engine, pose: Array, status: Array, flight: float, found: bool) -> None:
    """Set ``pose``, and the clock in ``status``, to the end of the flight: η_k = −x_k/w_k + Im(H_k e^{iφ}) + s_k/ω_k².

    At a root XT, YT and the trial hold the pairs already; otherwise they are evaluated here.
    """
    pairs, signal, attached, modes, drive = desk.pairs, desk.signal, desk.attached, desk.modes, desk.drive
    if not found:
        att.restart(attached, signal)
        value_at(signal_of(desk), 0.0, flight)
    status[CLOCK] = wrap(drive, status[CLOCK] + flight)
    cosine, sine = phase(drive, status[CLOCK])
    status[PHASE_COS], status[PHASE_SIN] = cosine, sine
    w = drive[W]
    for k in range(pairs.shape[1]):
        c = modes[CONTACT, k]
        if abs(c) > SILENT:
            x, y = -pairs[XT, k] / c, -pairs[YT, k] / c
        else:
            own = modes[RE, k] * signal[SINE] + modes[IM, k] * signal[COSINE] + modes[OFFSET, k]
            own_slope = w * (modes[RE, k] * signal[COSINE] - modes[IM, k] * signal[SINE])
            p00, p01, p10, p11 = propagator(pairs[SIGMA, k], pairs[OMEGA, k], pairs[DISC, k], flight)
            x = p00 * (pose[0, k] - own) + p01 * (pose[1, k] - own_slope)
            y = p10 * (pose[0, k] - own) + p11 * (pose[1, k] - own_slope)
        pose[0, k] = x + modes[OFFSET, k] + modes[RE, k] * sine + modes[IM, k] * cosine
        pose[1, k] = y + w * (modes[RE, k] * cosine - modes[IM, k] * sine)
    for j in range(int(signal[ATTACHED])):
        k = int(attached[AMODE, j])
        pose[0, k], pose[1, k] = attached[TRIAL_X, j], attached[TRIAL_Y, j]


@joined
def contact_derivatives(pairs: Array, modes: Array, drive: Array, pose: Array, status: Array) -> tuple[float, float]:
    """w·η'' and w·η''' of the free system, positive toward the stop: η'' = l Ω²B sin φ + s − 2ση' − ω²η."""
    cosine, sine = status[PHASE_COS], status[PHASE_SIN]
    second, third = 0.0, 0.0
    for k in range(pairs.shape[1]):
        damp, spring = 2.0 * pairs[SIGMA, k], pairs[OMEGA, k] * pairs[OMEGA, k]
        push = modes[LOAD, k] * drive[STRENGTH]
        acceleration = push * sine + modes[STATIC, k] - damp * pose[1, k] - spring * pose[0, k]
        second += modes[CONTACT, k] * acceleration
        third += modes[CONTACT, k] * (push * drive[W] * cosine - damp * acceleration - spring * pose[1, k])
    return second, third


@kernel
def contact_pull(pairs: Array, modes: Array, drive: Array, pose: Array, status: Array) -> tuple[float, float]:
    """As ``contact_derivatives``, each 0 where it is but the round-off of what it is the sum of."""
    second, third = contact_derivatives(pairs, modes, drive, pose, status)
    second_size, third_size = 0.0, 0.0
    for k in range(pairs.shape[1]):
        weight, spring = abs(modes[CONTACT, k]), pairs[OMEGA, k] * pairs[OMEGA, k]
        damp, push = 2.0 * pairs[SIGMA, k], abs(modes[LOAD, k] * drive[STRENGTH])
        parts = push + abs(modes[STATIC, k]) + damp * abs(pose[1, k]) + spring * abs(pose[0, k])
        second_size += weight * parts
        third_size += weight * (push * drive[W] + damp * parts + spring * abs(pose[1, k]) + pairs[OMEGA, k] * parts)
    second = second if abs(second) > ROUND_OFF * second_size else 0.0
    third = third if abs(third) > ROUND_OFF * third_size else 0.0
    return second, third
