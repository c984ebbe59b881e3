"""Averaged motion as a function of time, reconstructed from the slow flow."""

from __future__ import annotations

from math import atan2

import numpy as np

from vibeam.solvers.integration.samples import Motion as Sampled
from vibeam.solvers.one_mode.oscillator import OneMode, Oscillator
from vibeam.solvers.one_mode.stationary import Motion
from vibeam.system.impact_system import Drive
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arrays import Array

SAMPLES = 1000  # samples a drive period


def averaged_path(mode: OneMode, drive: Drive, motion: Motion, point: Array, start: float, end: float) -> Sampled:
    """Path of the stationary ``motion`` through ``point`` (q, q̇) at the drive's phase 0, from ``start`` to ``end`` s.

    With impacts q = Δ − Q|sin θ|, q̇ = −Q cos θ sgn sin θ, θ = Ωt/2k + θ₀; without, the harmonic one, or rest.
    """
    model, omega = mode.oscillator(drive.amplitude), drive.omega / mode.omega
    count = max(1, round((end - start) * drive.omega / (2 * np.pi))) * SAMPLES
    grid = np.linspace(start, end, count + 1)
    struck = np.empty(0)
    if motion.impacts_per_period:
        turn = omega * motion.impacts_per_period / 2  # Ω/2k
        angle = atan2(model.gap - point[0], -point[1])
        first, last = (turn * mode.omega * t + angle for t in (start, end))
        struck = (np.arange(np.ceil(first / np.pi), np.floor(last / np.pi) + 1) * np.pi - angle) / (turn * mode.omega)
        struck = struck[(struck > start) & (struck <= end)]
        grid = np.unique(np.concatenate([grid, np.nextafter(struck, -np.inf), struck]))
        places = _impacting(model, motion, turn * mode.omega * grid + angle, grid, struck)
    else:
        places = _smooth(model, motion, omega, mode.omega * grid)
    values = np.stack([places[:, 0] + mode.static, places[:, 1] * mode.omega], axis=1)[:, :, None] / mode.contact
    speeds = np.full(len(struck), motion.velocity * mode.omega)
    last_state = State(values[-1, 0], values[-1, 1], motion.resting)
    stats = {"impacts": len(struck), "evaluations": len(grid), "cpu_seconds": 0.0}
    rest = (end - start) if motion.resting else 0.0
    return Sampled(mode.system, drive, grid, values, struck, speeds, rest, end, last_state, Ended.COMPLETE, stats)


def _impacting(model: Oscillator, motion: Motion, angle: Array, times: Array, struck: Array) -> Array:
    """(q, q̇) at angles θ; at an impact, where sgn sin θ is round-off, the side is given explicitly."""
    reach = motion.high - motion.low
    whole = np.round(angle / np.pi)
    behind, ahead = np.isin(times, struck), np.isin(times, np.nextafter(struck, -np.inf))
    turns = np.where(behind, whole, np.where(ahead, whole - 1, np.floor(angle / np.pi)))
    side = 1 - 2 * (turns % 2)
    return np.stack([model.gap - reach * np.abs(np.sin(angle)), -reach * np.cos(angle) * side], axis=1)


def _smooth(model: Oscillator, motion: Motion, omega: float, time: Array) -> Array:
    if motion.resting:
        return np.stack([np.full_like(time, model.gap), np.zeros_like(time)], axis=1)
    turned = model.harmonic(omega) * np.exp(1j * omega * time)
    return np.stack([turned.imag, omega * turned.real], axis=1)
