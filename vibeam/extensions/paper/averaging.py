"""Averaging after the Zhuravlev transformation (paper eq. 16–27, re-derived) for any resonance Ω ≈ 2k.

First order in β, 1−R, σ_k, B/Q and Δ/Q: a slow flow, whose stationary solutions are the curves in closed form.

Zhuravlev's q = Δ − |z| unfolds the motion: between impacts, with s = sgn z,

    z̈ + 2βż + z = s (Δ − Ω²B sin Ωt),        and at an impact z runs on through 0 with ż⁺ = R ż⁻

instead of −R ż⁻: for R near 1 a small loss. With z = Q sin θ and ż = Q cos θ (one revolution of θ = two impacts) **Q is
the reach Δ − min q**, and also the impact velocity. The right side and the damping change Q and θ by Q̇ = f cos θ,
θ̇ = 1 − f sin θ/Q. Averaging over θ at constant ψ = Ωt − 2kθ uses

    ⟨s sin θ⟩ = 2/π,    ⟨s cos θ sin 2kθ⟩ = 4k/(π(4k²−1)),    ⟨s sin θ cos 2kθ⟩ = −2/(π(4k²−1)),

the other products averaging to 0; the damping takes βQ a unit of time, and two impacts in 2π take (1−R)Q each, in the
mean (1−R)Q/π. So, with σ_k = Ω/2k − 1, B_k = B/(4k²−1), β_k = β_eff/2k:

    Q̇ = −2k [β_k Q + (2/π) Ω²B_k cos ψ]
    ψ̇ =  2k [σ_k + (2/πQ)(Δ + Ω²B_k sin ψ)]

β_eff = β + (1−R)/π is the paper's. An impact multiplies Q by R, which over many impacts is the rate −ln(R)/π, not
(1−R)/π: β_eff = β − ln(R)/π keeps the decay exact for any R (``damping="log"``). At Δ = 0 and on resonance its error is
of second order, and for Δ ≤ 0 it is the better one. For a loose gap the error of first order in Δ/Q has the other sign:
there the two errors of the paper's form cancel in part, and it is the better one.

Stationary: both rates 0, hence

    (πσ_kQ + 2Δ)² + (πβ_kQ)² = (2Ω²B_k)²,        πβ_kQ = −2Ω²B_k cos ψ, πσ_kQ + 2Δ = −2Ω²B_k sin ψ   (eq. 23)

and the Jacobian has trace −4kβ_k and determinant 4k²(σ_k² + β_k² + 2σ_kΔ/πQ): a stationary Q is stable above
Q* = −2σ_kΔ/(π(σ_k² + β_k²)) (eq. 24; printed with π²), which is where its two roots meet, at
Δ_MAX = Ω²B_k √(1 + σ_k²/β_k²).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, copysign, hypot, inf, log, nan, pi, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vibeam.extensions.paper.one_mode import HIGHEST, OneMode, Oscillator, StationaryMotion, StationarySolver, nearest
from vibeam.solvers.integration.samples import SampledMotion
from vibeam.system.curves import MotionCurves
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import Ended
from vibeam.system.state import State
from vibeam_models.arguments import refuse, whole
from vibeam_models.arrays import Array

Damping = Literal["paper", "log"]
LAWS = ("paper", "log")


@dataclass(frozen=True)
class Stationary:
    """Stationary solution: ``reach`` Q, ``phase`` ψ (rad, of the drive against the motion), and stability."""

    reach: float
    phase: float
    stable: bool


@dataclass(frozen=True)
class SlowFlow:
    """Averaged oscillator near Ω = 2k, k = ``resonance``; ``damping``: form of β_eff. All nondimensional.

    ValueError for a resonance below 1, an unknown damping, or R = 0 with ``"log"`` (an infinite rate of decay).
    """

    oscillator: Oscillator
    resonance: int = 1
    damping: Damping = "paper"

    def __post_init__(self) -> None:
        refuse("", law_faults(self.resonance, self.damping, self.oscillator.restitution))

    @property
    def effective(self) -> float:
        """β_eff = β + (1−R)/π ("paper") or β − ln(R)/π ("log")."""
        loss = self.oscillator.restitution
        return self.oscillator.damping + ((1 - loss) if self.damping == "paper" else -log(loss)) / pi

    @property
    def decay(self) -> float:
        """β_k = β_eff/2k."""
        return self.effective / (2 * self.resonance)

    def detuning(self, omega: float) -> float:
        """σ_k = Ω/2k − 1."""
        return float(omega / (2 * self.resonance) - 1)

    def force(self, omega: float) -> float:
        """Ω²B_k, B_k = B/(4k²−1)."""
        return float(omega**2 * self.oscillator.drive / (4 * self.resonance**2 - 1))

    def jacobian(self, reach: float, omega: float) -> Array:
        """∂(Q̇, ψ̇)/∂(Q, ψ) (2, 2) at a stationary solution of reach Q."""
        sigma, pressed = self.detuning(omega), 2 * self.oscillator.gap / pi
        rows = [[-self.decay, -sigma * reach - pressed], [sigma / reach, -self.decay]]
        return 2 * self.resonance * np.array(rows)

    def stationary(self, omega: float) -> tuple[Stationary, ...]:
        """All stationary solutions at Ω, the larger reach first: the roots Q > 0, each with its ψ (eq. 23, atan2)."""
        sigma, pressed = self.detuning(omega), 2 * self.oscillator.gap / pi
        square, force = sigma**2 + self.decay**2, 2 / pi * self.force(omega)
        under = force**2 * square - (self.decay * pressed) ** 2
        if square == 0 or force == 0 or under < 0:
            return ()
        middle, half = -sigma * pressed / square, sqrt(under) / square
        return tuple(self._solution(reach, omega) for reach in (middle + half, middle - half) if reach > 0)

    def _solution(self, reach: float, omega: float) -> Stationary:
        side = copysign(1.0, self.oscillator.drive)
        across = 0.0 - (pi * self.detuning(omega) * reach + 2 * self.oscillator.gap)  # +0 instead of −0: ψ is π, not −π
        phase = atan2(side * across, -side * pi * self.decay * reach)
        stable = self.decay > 0 and float(np.linalg.det(self.jacobian(reach, omega))) > 0
        return Stationary(reach, phase, stable)

    def least_stable(self, omega: float) -> float:
        """Stability limit Q* (eq. 24 corrected): stationary solutions above it are stable, all where it is ≤ 0."""
        square = self.detuning(omega) ** 2 + self.decay**2
        return -2 * self.detuning(omega) * self.oscillator.gap / (pi * square) if square else nan

    def largest_gap(self, omega: float) -> float:
        """Largest gap with a stationary solution, on the branch's leaning side: Δ_MAX = |Ω²B_k| √(1 + σ_k²/β_k²)."""
        force, sigma = abs(self.force(omega)), self.detuning(omega)
        if self.decay == 0:
            return inf if sigma else force
        return force * hypot(1.0, sigma / self.decay)

    def gaps(self, omega: float) -> tuple[float, float]:
        """Open interval of gaps with a stationary solution at Ω: (least, greatest).

        A loose gap bends the branch to lower frequencies, so that for σ_k < 0 it reaches to Δ_MAX, past it to Ω²B_k; a
        tight one is its mirror image.
        """
        force, fold = abs(self.force(omega)), self.largest_gap(omega)
        return (-force, fold) if self.detuning(omega) < 0 else (-fold, force)


def law_faults(resonance: int, damping: str, restitution: float) -> list[str]:
    """Faults in the choice of resonance and damping; empty if valid."""
    faults = [] if (whole(resonance) or 0) >= 1 else [f"resonance: {resonance!r} is not 1, 2, 3 …"]
    faults += [] if damping in LAWS else [f"damping: {damping!r} is none of 'paper', 'log'"]
    if damping == "log" and restitution == 0:
        faults.append("damping: 'log' needs a restitution above 0, ln 0 is no rate of decay")
    return faults


def slow_flow(
    system: ImpactSystem, amplitude: float, *, resonance: int = 1, damping: Damping = "paper"
) -> tuple[SlowFlow, float]:
    """Slow flow of a system of one mode under base motion of ``amplitude`` m, and its unit of frequency, rad/s.

    ValueError for an unsuitable system.
    """
    mode = OneMode(system)
    return SlowFlow(mode.oscillator(amplitude), resonance, damping), mode.omega


def gaps_per_drive(system: ImpactSystem, omega: Array, periods: int) -> tuple[Array, float]:
    """Gaps (points, 2) a metre of drive between which a stationary motion of ``periods`` exists, and that of the mode.

    ValueError as ``slow_flow``.
    """
    flow, unit = slow_flow(system, 1.0, resonance=periods)
    return np.array([flow.gaps(float(each) / unit) for each in omega]), flow.oscillator.gap


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
            raise ValueError(Ended.NO_ORBIT.value)
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
