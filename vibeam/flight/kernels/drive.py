"""One drive: what stays the same from flight to flight, each mode's steady response and the phasor tables."""

from __future__ import annotations

from math import cos, hypot, sin

import numpy as np

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.layout import BRISK, FAR, FAR_DRIVEN, PANEL, Engine, Regime
from vibeam.flight.kernels.roots.pair import same_drive, tabulate_drive
from vibeam_models.arrays import Array

NEAR_RESONANCE = 1e-3  # |ω² − Ω² + 2iσΩ| / Ω² below which a mode is attached
NEARLY_FREE = 0.05  # rate / Ω below which a mode under a static force is attached
LOOSE = 1e-7  # share of the stiffest rate below which a held block counts as without stiffness


@kernel
def set_drive(engine: Engine, omega: float, amplitude: float) -> None:
    """Put the engine under b = amplitude · sin(omega t)."""
    drive, modes = engine.drive, engine.modes
    strength = omega * omega * amplitude
    drive[layout.W], drive[layout.STRENGTH], drive[layout.AMPLITUDE] = omega, strength, amplitude
    drive[layout.PERIOD], drive[layout.PERIOD_REST] = exact_period(omega)
    engine.signal[layout.ATTACHED], rate = 0.0, omega
    drive[layout.CONTACT_RE], drive[layout.CONTACT_IM], drive[layout.CLEARANCE] = 0.0, 0.0, drive[layout.GAP]
    for k in range(modes.shape[1]):
        modes[layout.RE, k], modes[layout.IM, k], modes[layout.OFFSET, k] = 0.0, 0.0, 0.0
        own, sigma = engine.pairs[layout.OMEGA, k], engine.pairs[layout.SIGMA, k]
        real, imaginary = (own - omega) * (own + omega), 2.0 * sigma * omega
        offset, driven = bounds_of_motion(own, sigma, omega)
        far = abs(modes[layout.STATIC, k]) > offset * own * own * drive[layout.MOTION]
        far = far or abs(modes[layout.LOAD, k] * strength) > driven * hypot(real, imaginary) * drive[layout.MOTION]
        if far or is_attached(own, sigma, modes[layout.LOAD, k] * strength, modes[layout.STATIC, k], omega):
            engine.attached[layout.AMODE, int(engine.signal[layout.ATTACHED])] = k
            engine.signal[layout.ATTACHED] += 1.0
            rate = max(rate, max(own, 2.0 * sigma))
            continue
        if strength != 0.0 and modes[layout.LOAD, k] != 0.0:
            response = modes[layout.LOAD, k] * strength / (real + 1j * imaginary)
            modes[layout.RE, k], modes[layout.IM, k] = response.real, response.imag
        modes[layout.OFFSET, k] = modes[layout.STATIC, k] / (own * own)
        drive[layout.CONTACT_RE] += modes[layout.CONTACT, k] * modes[layout.RE, k]
        drive[layout.CONTACT_IM] += modes[layout.CONTACT, k] * modes[layout.IM, k]
        drive[layout.CLEARANCE] -= modes[layout.CONTACT, k] * modes[layout.OFFSET, k]
    tabulate_drive(omega, engine.levels)
    same_drive(engine.levels, engine.rest.levels)
    steady_response(engine.rest, drive)
    drive[layout.COARSEST] = coarsest_level(engine.pairs, engine.levels, rate)
    rate = max(rate, carried_rate(engine.rest.pairs, engine.rest.blocks))
    drive[layout.COARSEST_AT_REST] = coarsest_level(engine.pairs, engine.levels, rate)


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
    """True for a mode without usable steady response: free or nearly so under a static force, undamped in resonance."""
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
            if pairs[layout.OMEGA, k] > 0.0:
                own = pairs[layout.SLOW, k] if pairs[layout.SLOW, k] > 0.0 else pairs[layout.KAPPA, k]
                rate = own if rate == 0.0 else min(rate, own)
    level = 0
    while level < layout.LEVELS - 1 and levels[layout.STEP, level] * rate > PANEL:
        level += 1
    return level


@kernel
def steady_response(regime: Regime, drive: Array) -> None:
    """Steady response of every block, (iΩ − A) Y = load Ω²B and −A⁻¹ constant, or CARRIED.

    Held at a stop the motion is at least as large as what the stop holds.
    """
    pairs, blocks, out = regime.pairs, regime.blocks, regime.outof
    omega, strength, motion = drive[layout.W], drive[layout.STRENGTH], drive[layout.MOTION]
    m, stiffest = blocks.shape[1], omega
    for i in range(regime.held.shape[0]):
        motion = max(motion, abs(regime.held[i]))
    for k in range(m):
        stiffest = max(stiffest, pairs[layout.OMEGA, k])
    for k in range(m):
        blocks[layout.RE1 : layout.OFFSET2 + 1, k] = 0.0
        own, sigma = pairs[layout.OMEGA, k], pairs[layout.SIGMA, k]
        force = strength * (abs(blocks[layout.LOAD1, k]) + abs(blocks[layout.LOAD2, k]))
        static = abs(blocks[layout.CONSTANT1, k]) + abs(blocks[layout.CONSTANT2, k])
        loose = own <= LOOSE * stiffest
        blocks[layout.CARRIED, k] = 1.0 if loose or is_attached(own, sigma, force, static, omega) else 0.0
        if blocks[layout.CARRIED, k] == 0.0:
            block_response(blocks, k, omega, strength)
            offset, driven = bounds_of_motion(own, sigma, omega)
            if block_is_far(blocks, out, k, offset * motion, driven * motion):
                blocks[layout.RE1 : layout.OFFSET2 + 1, k] = 0.0
                blocks[layout.CARRIED, k] = 1.0


@kernel
def carried_rate(pairs: Array, blocks: Array) -> float:
    """The fastest rate of the blocks that carry their force along."""
    rate = 0.0
    for k in range(blocks.shape[1]):
        if blocks[layout.CARRIED, k] > 0.0:
            rate = max(rate, max(pairs[layout.OMEGA, k], 2.0 * pairs[layout.SIGMA, k]))
    return rate


@kernel
def block_is_far(blocks: Array, out: Array, k: int, farthest: float, strongest: float) -> bool:
    """True where in some mode a block's static displacement or its steady response is beyond these."""
    offset, driven = 0.0, 0.0
    for i in range(out.shape[0] // 2):
        a, b = out[i, 2 * k], out[i, 2 * k + 1]
        offset = max(offset, abs(a * blocks[layout.OFFSET1, k] + b * blocks[layout.OFFSET2, k]))
        re = a * blocks[layout.RE1, k] + b * blocks[layout.RE2, k]
        im = a * blocks[layout.IM1, k] + b * blocks[layout.IM2, k]
        driven = max(driven, hypot(re, im))
    return offset > farthest or driven > strongest


@kernel
def block_response(blocks: Array, k: int, omega: float, strength: float) -> None:
    """Steady response of one block."""
    a, b, c, d = blocks[layout.A11, k], blocks[layout.A12, k], blocks[layout.A21, k], blocks[layout.A22, k]
    f0, f1 = blocks[layout.LOAD1, k] * strength, blocks[layout.LOAD2, k] * strength
    if f0 != 0.0 or f1 != 0.0:
        determinant = (1j * omega - a) * (1j * omega - d) - b * c
        y0 = ((1j * omega - d) * f0 + b * f1) / determinant
        y1 = (c * f0 + (1j * omega - a) * f1) / determinant
        blocks[layout.RE1, k], blocks[layout.IM1, k], blocks[layout.RE2, k] = y0.real, y0.imag, y1.real
        blocks[layout.IM2, k] = y1.imag
    det = a * d - b * c
    blocks[layout.OFFSET1, k] = -(d * blocks[layout.CONSTANT1, k] - b * blocks[layout.CONSTANT2, k]) / det
    blocks[layout.OFFSET2, k] = -(a * blocks[layout.CONSTANT2, k] - c * blocks[layout.CONSTANT1, k]) / det


@joined
def wrap(drive: Array, time: float) -> float:
    """A time within the drive's period: whole periods taken off exactly."""
    if drive[layout.W] == 0.0 or time < drive[layout.PERIOD]:
        return time
    if time < 2.0 * drive[layout.PERIOD]:
        return float((time - drive[layout.PERIOD]) - drive[layout.PERIOD_REST])
    return float(
        np.fmod(time, drive[layout.PERIOD]) - np.floor(time / drive[layout.PERIOD]) * drive[layout.PERIOD_REST]
    )


@joined
def phase(drive: Array, time: float) -> tuple[float, float]:
    """cos and sin of the drive's phase at a time within its period."""
    return cos(drive[layout.W] * time), sin(drive[layout.W] * time)
