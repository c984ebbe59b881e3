"""One drive: what stays the same from flight to flight, each mode's steady response and the phasor tables."""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np
from numpy.typing import NDArray

from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.layout import (
    A11,
    A12,
    A21,
    A22,
    AMODE,
    AMPLITUDE,
    ATTACHED,
    CARRIED,
    CLEARANCE,
    COARSEST,
    COARSEST_AT_REST,
    CONSTANT1,
    CONSTANT2,
    CONTACT,
    CONTACT_IM,
    CONTACT_RE,
    GAP,
    IM,
    IM1,
    IM2,
    KAPPA,
    LEVELS,
    LOAD,
    LOAD1,
    LOAD2,
    MOTION,
    OFFSET,
    OFFSET1,
    OFFSET2,
    OMEGA,
    PERIOD,
    PERIOD_REST,
    RE,
    RE1,
    RE2,
    SIGMA,
    SLOW,
    STATIC,
    STEP,
    STRENGTH,
    Engine,
    Regime,
    W,
)
from vibeam.flight.kernels.roots.levels import same_drive, tabulate_drive
from vibeam.flight.kernels.thresholds import BRISK, FAR, FAR_DRIVEN, PANEL

Array = NDArray[np.float64]

NEAR_RESONANCE = 1e-3  # |ω² − Ω² + 2iσΩ| / Ω² below which a mode is attached

NEARLY_FREE = 0.05  # rate / Ω below which a mode under a static force is attached

LOOSE = 1e-7  # share of the stiffest rate below which a held block counts as without stiffness


@kernel
def set_drive(desk: Engine, omega: float, amplitude: float) -> None:
    """Put the desk under b = amplitude · sin(omega t)."""
    drive, modes = desk.drive, desk.modes
    strength = omega * omega * amplitude
    drive[W], drive[STRENGTH], drive[AMPLITUDE] = omega, strength, amplitude
    drive[PERIOD], drive[PERIOD_REST] = exact_period(omega)
    desk.signal[ATTACHED], rate = 0.0, omega
    drive[CONTACT_RE], drive[CONTACT_IM], drive[CLEARANCE] = 0.0, 0.0, drive[GAP]
    for k in range(modes.shape[1]):
        modes[RE, k], modes[IM, k], modes[OFFSET, k] = 0.0, 0.0, 0.0
        own, sigma = desk.pairs[OMEGA, k], desk.pairs[SIGMA, k]
        real, imaginary = (own - omega) * (own + omega), 2.0 * sigma * omega
        offset, driven = bounds_of_motion(own, sigma, omega)
        far = abs(modes[STATIC, k]) > offset * own * own * drive[MOTION]
        far = far or abs(modes[LOAD, k] * strength) > driven * hypot(real, imaginary) * drive[MOTION]
        if far or is_attached(own, sigma, modes[LOAD, k] * strength, modes[STATIC, k], omega):
            desk.attached[AMODE, int(desk.signal[ATTACHED])] = k
            desk.signal[ATTACHED] += 1.0
            rate = max(rate, max(own, 2.0 * sigma))
            continue
        if strength != 0.0 and modes[LOAD, k] != 0.0:
            response = modes[LOAD, k] * strength / (real + 1j * imaginary)
            modes[RE, k], modes[IM, k] = response.real, response.imag
        modes[OFFSET, k] = modes[STATIC, k] / (own * own)
        drive[CONTACT_RE] += modes[CONTACT, k] * modes[RE, k]
        drive[CONTACT_IM] += modes[CONTACT, k] * modes[IM, k]
        drive[CLEARANCE] -= modes[CONTACT, k] * modes[OFFSET, k]
    tabulate_drive(omega, desk.levels)
    same_drive(desk.levels, desk.rest.levels)
    steady_response(desk.rest, drive)
    drive[COARSEST] = coarsest_level(desk.pairs, desk.levels, rate)
    rate = max(rate, carried_rate(desk.rest.pairs, desk.rest.blocks))
    drive[COARSEST_AT_REST] = coarsest_level(desk.pairs, desk.levels, rate)


@joined
def bounds_of_motion(own: float, sigma: float, omega: float) -> tuple[float, float]:
    """Times the size of the motion from which on a mode's static displacement, and its steady response, are far.

    Carrying a mode along costs panels by its own rate and by 2σ. Brisk ones answer a drive within a small part of its
    period, so that the motion is soon as large as their response; where damping decides, the offset has to be farther.
    """
    offset = FAR if 2.0 * sigma <= BRISK * max(own, omega) else FAR_DRIVEN
    return offset, FAR_DRIVEN if max(own, 2.0 * sigma) <= BRISK * omega else np.inf


@kernel
def is_attached(own: float, sigma: float, force: float, static: float, omega: float) -> bool:
    """Whether a mode has no usable steady response: free, nearly free under a static force, undamped at resonance."""
    if own == 0.0:
        return True
    if static != 0.0 and omega > 0.0 and own + 2.0 * sigma < NEARLY_FREE * omega:
        return True
    distance = hypot((own - omega) * (own + omega), 2.0 * sigma * omega)
    return force != 0.0 and distance < NEAR_RESONANCE * omega * omega


@kernel
def exact_period(omega: float) -> tuple[float, float]:
    """2π/Ω as an unevaluated sum of two doubles (Dekker's product): phases stay exact over very many periods."""
    if omega == 0.0:
        return np.inf, 0.0
    high, low = 6.283185307179586, 2.4492935982947064e-16
    period = high / omega
    a, b = 134217729.0 * period, 134217729.0 * omega
    a1, b1 = a - (a - period), b - (b - omega)
    a2, b2 = period - a1, omega - b1
    product = period * omega
    error = ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2
    return period, ((high - product) - error + low) / omega


@kernel
def coarsest_level(pairs: Array, levels: Array, rate: float) -> int:
    """The level of the longest panel worth trying: about a sixth of a turn at ``rate``, the drive's or that of what is
    carried by Taylor series, or of the slowest mode's.
    """
    if rate == 0.0:
        for k in range(pairs.shape[1] - 1, -1, -1):
            if pairs[OMEGA, k] > 0.0:
                own = pairs[SLOW, k] if pairs[SLOW, k] > 0.0 else pairs[KAPPA, k]
                rate = own if rate == 0.0 else min(rate, own)
    level = 0
    while level < LEVELS - 1 and levels[STEP, level] * rate > PANEL:
        level += 1
    return level


@kernel
def steady_response(regime: Regime, drive: Array) -> None:
    """Steady response of every block, (iΩ − A) Y = load Ω²B and −A⁻¹ constant, or CARRIED.

    Held at a stop the motion is at least as large as what the stop holds.
    """
    pairs, blocks, out = regime.pairs, regime.blocks, regime.outof
    omega, strength, motion = drive[W], drive[STRENGTH], drive[MOTION]
    m, stiffest = blocks.shape[1], omega
    for i in range(regime.held.shape[0]):
        motion = max(motion, abs(regime.held[i]))
    for k in range(m):
        stiffest = max(stiffest, pairs[OMEGA, k])
    for k in range(m):
        blocks[RE1 : OFFSET2 + 1, k] = 0.0
        own, sigma = pairs[OMEGA, k], pairs[SIGMA, k]
        force = strength * (abs(blocks[LOAD1, k]) + abs(blocks[LOAD2, k]))
        static = abs(blocks[CONSTANT1, k]) + abs(blocks[CONSTANT2, k])
        loose = own <= LOOSE * stiffest
        blocks[CARRIED, k] = 1.0 if loose or is_attached(own, sigma, force, static, omega) else 0.0
        if blocks[CARRIED, k] == 0.0:
            block_response(blocks, k, omega, strength)
            offset, driven = bounds_of_motion(own, sigma, omega)
            if block_is_far(blocks, out, k, offset * motion, driven * motion):
                blocks[RE1 : OFFSET2 + 1, k] = 0.0
                blocks[CARRIED, k] = 1.0


@kernel
def carried_rate(pairs: Array, blocks: Array) -> float:
    """The fastest rate of the blocks that carry their force along."""
    rate = 0.0
    for k in range(blocks.shape[1]):
        if blocks[CARRIED, k] > 0.0:
            rate = max(rate, max(pairs[OMEGA, k], 2.0 * pairs[SIGMA, k]))
    return rate


@kernel
def block_is_far(blocks: Array, out: Array, k: int, farthest: float, strongest: float) -> bool:
    """Whether in some mode a block's static displacement or its steady response is beyond these."""
    offset, driven = 0.0, 0.0
    for i in range(out.shape[0] // 2):
        a, b = out[i, 2 * k], out[i, 2 * k + 1]
        offset = max(offset, abs(a * blocks[OFFSET1, k] + b * blocks[OFFSET2, k]))
        driven = max(driven, hypot(a * blocks[RE1, k] + b * blocks[RE2, k], a * blocks[IM1, k] + b * blocks[IM2, k]))
    return offset > farthest or driven > strongest


@kernel
def block_response(blocks: Array, k: int, omega: float, strength: float) -> None:
    """Steady response of one block."""
    a, b, c, d = blocks[A11, k], blocks[A12, k], blocks[A21, k], blocks[A22, k]
    f0, f1 = blocks[LOAD1, k] * strength, blocks[LOAD2, k] * strength
    if f0 != 0.0 or f1 != 0.0:
        determinant = (1j * omega - a) * (1j * omega - d) - b * c
        y0 = ((1j * omega - d) * f0 + b * f1) / determinant
        y1 = (c * f0 + (1j * omega - a) * f1) / determinant
        blocks[RE1, k], blocks[IM1, k], blocks[RE2, k], blocks[IM2, k] = y0.real, y0.imag, y1.real, y1.imag
    det = a * d - b * c
    blocks[OFFSET1, k] = -(d * blocks[CONSTANT1, k] - b * blocks[CONSTANT2, k]) / det
    blocks[OFFSET2, k] = -(a * blocks[CONSTANT2, k] - c * blocks[CONSTANT1, k]) / det


@joined
def wrap(drive: Array, time: float) -> float:
    """A time within the drive's period: whole periods taken off exactly."""
    if drive[W] == 0.0 or time < drive[PERIOD]:
        return time
    if time < 2.0 * drive[PERIOD]:
        return float((time - drive[PERIOD]) - drive[PERIOD_REST])
    return float(np.fmod(time, drive[PERIOD]) - np.floor(time / drive[PERIOD]) * drive[PERIOD_REST])


@joined
def phase(drive: Array, time: float) -> tuple[float, float]:
    """cos and sin of the drive's phase at a time within its period."""
    return cos(drive[W] * time), sin(drive[W] * time)
