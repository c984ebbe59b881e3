"""Averaging after the Zhuravlev transformation (paper eq. 16–27): frequency-response curves in closed form.

First order in β, 1−R, σ_k, B/Q and Δ/Q. The slow flow and its derivation are in ``slow_flow``.
"""

from __future__ import annotations

from math import atan2

import numpy as np
from numpy.typing import ArrayLike

from vibeam.solvers.integration.samples import SampledMotion
from vibeam.solvers.one_mode import NOTHING_FOUND, OneMode, Oscillator, StationaryMotion, StationarySolver, nearest
from vibeam.solvers.slow_flow import Damping, SlowFlow, Stationary, law_faults
from vibeam.system.curves import MotionCurves
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arguments import refuse
from vibeam_models.arrays import Array

SAMPLES = 1000  # samples a drive period


def averaged_path(
    mode: OneMode, drive: Drive, motion: StationaryMotion, point: Array, start: float, end: float
) -> SampledMotion:
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
    return SampledMotion(mode.system, drive, grid, values, struck, speeds, rest, end, last_state, Ended.COMPLETE, stats)


def _impacting(model: Oscillator, motion: StationaryMotion, angle: Array, times: Array, struck: Array) -> Array:
    """(q, q̇) at angles θ; at an impact, where sgn sin θ is round-off, the side is given explicitly."""
    reach = motion.high - motion.low
    whole = np.round(angle / np.pi)
    behind, ahead = np.isin(times, struck), np.isin(times, np.nextafter(struck, -np.inf))
    turns = np.where(behind, whole, np.where(ahead, whole - 1, np.floor(angle / np.pi)))
    side = 1 - 2 * (turns % 2)
    return np.stack([model.gap - reach * np.abs(np.sin(angle)), -reach * np.cos(angle) * side], axis=1)


def _smooth(model: Oscillator, motion: StationaryMotion, omega: float, time: Array) -> Array:
    if motion.resting:
        return np.stack([np.full_like(time, model.gap), np.zeros_like(time)], axis=1)
    turned = model.harmonic(omega) * np.exp(1j * omega * time)
    return np.stack([turned.imag, omega * turned.real], axis=1)


HIGHEST = 16  # longest period in a response


def slow_flow(
    system: ImpactSystem, amplitude: float, *, resonance: int = 1, damping: Damping = "paper"
) -> tuple[SlowFlow, float]:
    """Slow flow of a system of one mode under base motion of ``amplitude`` m, and its unit of frequency, rad/s.

    ValueError for an unsuitable system.
    """
    mode = OneMode(system)
    return SlowFlow(mode.oscillator(amplitude), resonance, damping), mode.omega


class AveragingSolver(StationarySolver):
    """Averaged motion of one mode near the resonance Ω = 2k: one impact every k drive periods.

    At each frequency the stable solution, or the motion without impacts, whichever is nearer to the carried state. The
    motion is q = Δ − Q |sin((Ωt − ψ)/2k)|, its impact velocity Q, its amplitude Q/2.
    """

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float = 0.0,
        span: float = 0.0,
        *,
        resonance: int = 1,
        damping: Damping = "paper",
        strikes_only: bool = False,
    ) -> None:
        """``resonance``: k, 1 … 16; ``damping``: β_eff = β + (1−R)/π ("paper") or β − ln(R)/π ("log").

        ``slowest`` and ``span`` are ignored. ValueError for more than one mode, no stiffness, a mode
        that is not underdamped, R = 0 with "log".
        """
        super().__init__(system, strikes_only)
        faults = law_faults(resonance, damping, system.restitution)
        faults += [f"resonance: {resonance} is beyond {HIGHEST}"] if resonance > HIGHEST else []
        refuse("", faults)
        self.resonance, self.damping = resonance, damping

    def curves(self, omegas: ArrayLike, amplitude: ArrayLike, output: str) -> MotionCurves:
        """Both stationary solutions at ``omegas``, rad/s; q ≤ Δ always, so all are admissible."""
        grid, mode = np.atleast_1d(np.asarray(omegas, dtype=float)), self.mode
        share = abs(float(self.system.output(output)[0]) / mode.contact)
        base = np.broadcast_to(np.asarray(amplitude, dtype=float), grid.shape)
        found = MotionCurves.empty(grid / (2 * np.pi), self.resonance)
        for index, omega in enumerate(grid):
            flow = SlowFlow(mode.oscillator(float(base[index])), self.resonance, self.damping)
            for branch, one in enumerate(flow.stationary(float(omega) / mode.omega)):
                at = index, branch
                found.amplitude[at], found.reach[at] = share * one.reach / 2, one.reach
                found.velocity[at] = one.reach * mode.omega
                found.stable[at], found.admissible[at] = one.stable, True
        return found

    def striking(self, model: Oscillator, omega: float) -> list[StationaryMotion]:
        """Motion of the stable stationary solution, if there is one."""
        flow = SlowFlow(model, self.resonance, self.damping)
        return [averaged_motion(flow, found) for found in flow.stationary(omega) if found.stable]

    def motion(self, drive: Drive, state: State | None, t_start: float, t_end: float) -> SampledMotion:
        """Stationary motion nearest to ``state``, ``t_start`` to ``t_end`` in s; ValueError where there is none."""
        found = nearest(
            self.motions(self.mode.oscillator(drive.amplitude), drive.omega / self.mode.omega), self.mode.inward(state)
        )
        if found is None:
            raise ValueError(NOTHING_FOUND.value)
        return averaged_path(self.mode, drive, *found, t_start, t_end)


def averaged_motion(flow: SlowFlow, found: Stationary) -> StationaryMotion:
    """Motion q = Δ − Q |sin θ|, q̇ = −Q cos θ sgn sin θ, θ = (Ωt − ψ)/2k, of a stationary solution."""
    k, gap, reach = flow.resonance, flow.oscillator.gap, found.reach
    angle = (-found.phase / 2 + np.pi * np.arange(k)) / k
    side = np.where(np.sin(angle) < 0, -1.0, 1.0)
    places = np.stack([gap - reach * np.abs(np.sin(angle)), -reach * np.cos(angle) * side], axis=1)
    mean = gap - 2 * reach / np.pi
    square = gap**2 - 4 * gap * reach / np.pi + reach**2
    return StationaryMotion(gap, gap - reach, places, mean, square, k, 1 / k, reach)
