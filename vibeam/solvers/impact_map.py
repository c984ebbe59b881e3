"""Pointwise impact map and its fixed points in closed form (paper eq. 28, 31–34).

An impact is its time t and the velocity q̇₋ > 0 just before it. Between impacts q = Im(H e^{iΩt}) + y, where y is a free
vibration, y(s) = E(s) y(0⁺) with the 2×2 flow E; the flight itself and its first root are the flight solver's.

A motion with one impact every n drive periods T repeats y up to the jump: E(nT) y(0⁺) = y(0⁺) + (0, (1+R) q̇₋), so
y(0⁺) = (a, b) q̇₋, linear in q̇₋, and with it

    Im(H e^{iΩt}) = Δ − a q̇₋,    Ω Re(H e^{iΩt}) = −(R + b) q̇₋,    (Δ − a q̇₋)² + ((R + b) q̇₋/Ω)² = |H|²

as solved by eq. 31–34: a quadratic for q̇₋, then the phase. Roots q̇₋ > 0 push away from the stop; whether they
strike nothing in between (``admissible``) follows from a flight.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, nan, pi, sqrt

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from vibeam.flight.kernels import layout
from vibeam.flight.readout import struck
from vibeam.flight.solver import FlightSolver
from vibeam.solvers.one_mode import Oscillator
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array

HORIZON = 1000  # drive periods after which a flight counts as without impact
SAMPLES = 64  # intervals a period, of the faster of drive and oscillator, that isolate the turning points
EARLY = 1e-6  # tolerance, as a share of n periods, for the first impact to be the orbit's own


@dataclass(frozen=True)
class Impact:
    """Impact: ``time`` t and ``velocity`` q̇₋ just before it; ``flight`` τ: duration of the flight to it."""

    time: float
    velocity: float
    flight: float = nan


@dataclass(frozen=True)
class ImpactMap:
    """Impact map (t, q̇₋) → next impact, at one Ω; ``solver`` computes the flights."""

    oscillator: Oscillator
    omega: float
    solver: FlightSolver

    @property
    def period(self) -> float:
        """Drive period T = 2π/Ω."""
        return 2 * pi / self.omega

    def next(self, impact: Impact) -> Impact:
        """Next impact, its time counted from this one; NaN where none comes within 1000 drive periods."""
        start, model = impact.time % self.period, self.oscillator
        place = State(np.array([model.gap]), np.array([-model.restitution * impact.velocity]))
        drive = Drive(self.omega, model.drive)
        trace = self.solver.simulate(drive, place, start, start + HORIZON * self.period, 0)[3].trace
        hits = np.flatnonzero(struck(trace))
        if not len(hits):
            return Impact(nan, nan)
        flight = float(np.sum(trace[: hits[0] + 1, layout.DURATION]))
        return Impact(impact.time + flight, float(trace[hits[0], layout.BEFORE]), flight)


def flight_solver(model: Oscillator, slowest: float) -> FlightSolver:
    """Flight solver of an oscillator, for drives of ``slowest`` and more."""
    system = ImpactSystem.from_modes(1.0, model.damping, 1.0, 1.0, gap=model.gap, restitution=model.restitution)
    return FlightSolver(system, slowest)


def free_flow(model: Oscillator, time: ArrayLike) -> Array:
    """Flow E (…, 2, 2) of the free vibration (y, ẏ) after ``time`` of any shape."""
    t, rate, beta = np.asarray(time, dtype=float), model.damped, model.damping
    fade = np.exp(-beta * t)
    c, s = fade * np.cos(rate * t), fade * np.sin(rate * t) / rate
    return np.stack([np.stack([c + beta * s, s], axis=-1), np.stack([-s, c - beta * s], axis=-1)], axis=-2)


@dataclass(frozen=True)
class FixedPoint:
    """Periodic motion with one impact every ``periods`` drive periods: at time ``time`` with ``velocity`` q̇₋.

    ``free``: its free vibration (y, ẏ) just after the impact.
    """

    oscillator: Oscillator
    omega: float
    periods: int
    time: float
    velocity: float
    free: Array

    @property
    def duration(self) -> float:
        """Duration nT."""
        return self.periods * 2 * pi / self.omega

    @property
    def impact(self) -> Impact:
        """Impact of the orbit."""
        return Impact(self.time, self.velocity, self.duration)

    def place(self, since: ArrayLike) -> Array:
        """(q, q̇) in the last axis, at times ``since`` of any shape after its impact, 0 … nT."""
        phase = self.omega * (self.time + np.asarray(since, dtype=float))
        turned = self.oscillator.harmonic(self.omega) * np.exp(1j * phase)
        forced = np.stack([turned.imag, self.omega * turned.real], axis=-1)
        return np.asarray(forced + free_flow(self.oscillator, since) @ self.free)

    def lowest(self) -> float:
        """Least q: the lowest of its turning points, each refined to round-off."""
        grid = self._grid()
        speed = self.place(grid)[:, 1]
        turns = np.flatnonzero((speed[:-1] < 0) & (speed[1:] >= 0))
        found = [brentq(lambda t: self.place(t)[1], grid[i], grid[i + 1], xtol=1e-14) for i in turns]
        return float(min(self.place(found)[:, 0], default=self.oscillator.gap))

    def means(self) -> tuple[float, float]:
        """Time means of q and of q² + q̇² (Simpson's rule)."""
        grid = self._grid()
        places = self.place(grid)
        weights = np.where(np.arange(len(grid)) % 2, 4.0, 2.0)
        weights[[0, -1]] = 1.0
        weights /= weights.sum()
        return float(weights @ places[:, 0]), float(weights @ np.sum(places**2, axis=1))

    def admissible(self, flights: ImpactMap) -> bool:
        """Test whether the first impact after nT is the orbit's own, so that none lies between."""
        return abs(flights.next(self.impact).flight - self.duration) <= EARLY * self.duration

    def _grid(self) -> Array:
        turns = self.duration * max(1.0, self.omega) / (2 * pi)
        return np.linspace(0.0, self.duration, 2 * int(np.ceil(SAMPLES * turns / 2)) + 1)


def fixed_points(model: Oscillator, omega: float, periods: int = 1) -> tuple[FixedPoint, ...]:
    """Motions at Ω with one impact every ``periods`` = n drive periods, the hardest impact first: up to two.

    Not yet tested for admissibility or stability. None where the oscillator is undamped and nT a multiple of 2π.
    """
    duration, swing = periods * 2 * pi / omega, model.harmonic(omega)
    repeat = np.eye(2) - free_flow(model, duration)
    if np.linalg.det(repeat) == 0 or not np.isfinite(swing):
        return ()
    a, b = np.linalg.solve(repeat, [0.0, -(1 + model.restitution)])
    across, gap = (model.restitution + b) / omega, model.gap
    size = hypot(a, across) ** 2
    under = abs(swing) ** 2 * size - (gap * across) ** 2
    if under < 0 or size == 0:
        return ()
    speeds = [float(gap * a + sign * sqrt(under)) / size for sign in (1.0, -1.0)]
    return tuple(_orbit(model, omega, periods, speed, np.array([a, b])) for speed in speeds if speed > 0)


def _orbit(model: Oscillator, omega: float, periods: int, speed: float, unit: Array) -> FixedPoint:
    turned = complex(-(model.restitution + unit[1]) * speed / omega, model.gap - unit[0] * speed)
    time = float(np.angle(turned / model.harmonic(omega))) / omega
    return FixedPoint(model, omega, periods, time % (2 * pi / omega), speed, unit * speed)
