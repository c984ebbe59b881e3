"""Free flight: from the modal state to the gap as a signal, and back to the state where the flight ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.drive import phase, wrap
from vibeam.flight.kernels.layout import Engine
from vibeam.flight.kernels.roots import taylor_pairs as att
from vibeam.flight.kernels.roots.pair import norm, propagator
from vibeam.flight.kernels.roots.signal import signal_of, value_at
from vibeam.flight.kernels.thresholds import SILENT

Array = NDArray[np.float64]

ROUND_OFF = 64.0 * 2.220446049250313e-16  # share of the parts of a sum below which it is none


@joined
def begin_flight(engine: Engine, pose: Array, cosine: float, sine: float) -> tuple[float, float, float]:
    """The gap as a signal from ``pose`` at that drive phase: value, slope, size of its parts.

    g(t) = Δ − w·η: const = Δ − Σ w_k s_k/ω_k², z = −Σ w_k H_k e^{iφ}, x_k = −w_k (η_k − Im(H_k e^{iφ}) − s_k/ω_k²).
    """
    pairs, signal, attached, modes, drive = engine.pairs, engine.signal, engine.attached, engine.modes, engine.drive
    zr = -(drive[layout.CONTACT_RE] * cosine - drive[layout.CONTACT_IM] * sine)
    zi = -(drive[layout.CONTACT_RE] * sine + drive[layout.CONTACT_IM] * cosine)
    signal[layout.CONST], signal[layout.ZR], signal[layout.ZI], signal[layout.DRIVE] = (
        drive[layout.CLEARANCE],
        zr,
        zi,
        drive[layout.W],
    )
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
        c = modes[layout.CONTACT, k]
        if abs(c) > SILENT:
            x, y = -pairs[layout.XT, k] / c, -pairs[layout.YT, k] / c
        else:
            own = (
                modes[layout.RE, k] * signal[layout.SINE]
                + modes[layout.IM, k] * signal[layout.COSINE]
                + modes[layout.OFFSET, k]
            )
            own_slope = w * (modes[layout.RE, k] * signal[layout.COSINE] - modes[layout.IM, k] * signal[layout.SINE])
            p00, p01, p10, p11 = propagator(
                pairs[layout.SIGMA, k], pairs[layout.OMEGA, k], pairs[layout.DISC, k], flight
            )
            x = p00 * (pose[0, k] - own) + p01 * (pose[1, k] - own_slope)
            y = p10 * (pose[0, k] - own) + p11 * (pose[1, k] - own_slope)
        pose[0, k] = x + modes[layout.OFFSET, k] + modes[layout.RE, k] * sine + modes[layout.IM, k] * cosine
        pose[1, k] = y + w * (modes[layout.RE, k] * cosine - modes[layout.IM, k] * sine)
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
