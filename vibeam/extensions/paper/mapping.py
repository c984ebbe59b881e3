"""Mapping solver: stable fixed points of the impact map, as in the paper's pointwise mapping (eq. 28–37).

Fixed points follow in closed form, their stability from trace and determinant of the map's Jacobian; the map is not
iterated, for that is the work of the flight solver. So all motions with one impact every n periods are found, and none
with more impacts, chatter or chaos: such a point is NaN.

An impact is its time t and the velocity q̇₋ > 0 just before it. Between impacts q = Im(H e^{iΩt}) + y, where y is a free
vibration, y(s) = E(s) y(0⁺) with the 2×2 flow E; the flight itself and its first root are the flight solver's.

A motion with one impact every n drive periods T repeats y up to the jump: E(nT) y(0⁺) = y(0⁺) + (0, (1+R) q̇₋), so
y(0⁺) = (a, b) q̇₋, linear in q̇₋, and with it

    Im(H e^{iΩt}) = Δ − a q̇₋,    Ω Re(H e^{iΩt}) = −(R + b) q̇₋,    (Δ − a q̇₋)² + ((R + b) q̇₋/Ω)² = |H|²

as solved by eq. 31–34: a quadratic for q̇₋, then the phase. Roots q̇₋ > 0 push away from the stop; whether they
strike nothing in between (``admissible``) follows from a flight.

A flight of duration τ from (t₀, q̇₊ = −R q̇₋⁰) to (t₁, q̇₋), with E(τ) the free flow and accelerations
q̈₊ = F(t₀) − 2βq̇₊ − Δ, q̈₋ = F(t₁) − 2βq̇₋ − Δ: a start that is late by δt₀ and faster by δq̇₊ arrives at the undisturbed
time with (δq, δq̇) = E (−q̇₊ δt₀, δq̇₊ − q̈₊ δt₀), and at the stop

    δt₁ = −δq/q̇₋,    δq̇₋ = δq̇ + q̈₋ δt₁.

Trace and determinant of (t, q̇₋) → (t, q̇₋) follow, with N = F(t₀) − βq̇₊ − Δ:

    tr J  = e^{−βτ}/(ω_D q̇₋) { [N + R(F(t₁) − βq̇₋ − Δ)] sin ω_Dτ + ω_D (q̇₊ − R q̇₋) cos ω_Dτ }     (eq. 30, corrected)
    det J = −R e^{−2βτ} q̇₊/q̇₋                                                                       (eq. 29)

and for a fixed point of n periods, τ = nT, q̇₊ = −R q̇₋, F = F(t₀) = F(t₁):

    tr J  = e^{−βnT} [(1+R)(F − Δ) sin(ω_D nT)/(ω_D q̇₋) − 2R cos ω_D nT]                              (eq. 36–37)
    det J = R² e^{−2βnT}                                                                             (eq. 35, corrected)

As printed, with q̇₋⁺ the impact velocity after the next flight and N = F(t₀) − βq̇₊ − Δ (eq. 32, 37):

    tr J  = −e^{−βτ}/(ω_D q̇₋⁺) { [N + Rβq̇₋] sin ω_Dτ + ω_D (q̇₊ − R q̇₋) cos ω_Dτ }                   (eq. 30)
    tr J  = e^{−βnT} [(N + Rβq̇₋) sin(ω_D nT)/(ω_D q̇₋) − 2R cos ω_D nT]                               (eq. 36)
    det J = R² e^{−βnT}                                                                              (eq. 35)

Both lack most of the arrival's share, R(F(t₁) − Δ). At a fixed point the traces differ by their sign alone, which no
|λ| feels; eq. 29–30 and 35–37 then differ by the determinant, of which eq. 29 is right.

The forms, by name: ``"derived"``, ``"printed 29-30"``, ``"printed 35-37"``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, exp, hypot, nan, pi, sin, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from vibeam.extensions.paper.one_mode import HIGHEST, Oscillator, StationaryMotion, StationarySolver
from vibeam.flight.kernels import layout
from vibeam.flight.readout import struck
from vibeam.flight.solver import FlightSolver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arguments import count, refuse
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


Form = Literal["derived", "printed 29-30", "printed 35-37"]
FORMS: tuple[Form, ...] = ("derived", "printed 29-30", "printed 35-37")


@dataclass(frozen=True)
class Invariants:
    """Trace and determinant of a Jacobian (2, 2)."""

    trace: float
    determinant: float

    @property
    def multipliers(self) -> tuple[complex, complex]:
        """Eigenvalues, that with the larger imaginary, then real part first."""
        half = np.sqrt(complex(self.trace**2 / 4 - self.determinant))
        return complex(self.trace / 2 + half), complex(self.trace / 2 - half)

    @property
    def stable(self) -> bool:
        """True where both multipliers lie inside the unit circle."""
        return max(abs(one) for one in self.multipliers) < 1


def flight_invariants(
    model: Oscillator, omega: float, start: Impact, end: Impact, following: Impact | None = None
) -> Invariants:
    """Invariants of the map along one flight from impact to impact (eq. 29, and eq. 30 corrected).

    With the impact ``following`` those of eq. 29–30 as printed, which take its velocity.
    """
    beta, loss, rate, tau = model.damping, model.restitution, model.damped, end.flight
    after, before = -loss * start.velocity, end.velocity
    leaving = model.force(omega, start.time) - beta * after - model.gap
    arriving = beta * before if following else model.force(omega, end.time) - beta * before - model.gap
    turning = (leaving + loss * arriving) * sin(rate * tau) + rate * (after - loss * before) * cos(rate * tau)
    trace = exp(-beta * tau) / rate * (turning / before if following is None else -turning / following.velocity)
    return Invariants(trace, -loss * exp(-2 * beta * tau) * after / before)


def orbit_invariants(orbit: FixedPoint, form: Form = "derived") -> Invariants:
    """Invariants of the map at a fixed point, in a given form; ValueError for an unknown form."""
    check_form(form)
    model, duration, fixed = orbit.oscillator, orbit.duration, orbit.impact
    if form == "printed 29-30":
        return flight_invariants(model, orbit.omega, fixed, fixed, fixed)
    loss, rate, fade = model.restitution, model.damped, exp(-model.damping * duration)
    load, printed = model.force(orbit.omega, orbit.time) - model.gap, form == "printed 35-37"
    push = load + 2 * loss * model.damping * orbit.velocity if printed else (1 + loss) * load
    trace = fade * (push * sin(rate * duration) / (rate * orbit.velocity) - 2 * loss * cos(rate * duration))
    return Invariants(trace, loss**2 * (fade if printed else fade**2))


def check_form(form: str) -> None:
    """Raise ValueError for an unknown ``form``."""
    if form not in FORMS:
        raise ValueError(f"form: {form!r} is none of {', '.join(map(repr, FORMS))}")


def admissible_orbits(flights: ImpactMap, periods: int = 1) -> list[FixedPoint]:
    """Admissible fixed points of 1 … ``periods`` drive periods at the map's Ω."""
    orbits = [o for n in range(1, periods + 1) for o in fixed_points(flights.oscillator, flights.omega, n)]
    return [orbit for orbit in orbits if orbit.admissible(flights)]


class MappingSolver(StationarySolver):
    """Stable motions of one mode with one impact every n = 1 … ``periods`` drive periods, exact.

    At each frequency the nearest to the carried state, motions without impacts included. ``form``: of the trace and
    determinant that decide stability, so that the printed formulas' mistakes can be swept beside the corrected ones.
    """

    def __init__(
        self,
        system: ImpactSystem,
        slowest: float = 0.0,
        span: float = 0.0,
        *,
        periods: int = 1,
        form: Form = "derived",
        strikes_only: bool = False,
    ) -> None:
        """``periods``: 1 … 16; ``slowest``: the lowest drive frequency, rad/s (0: the mode's own frequency).

        ValueError for more than one mode, no stiffness, a mode that is not underdamped, an unknown form.
        """
        super().__init__(system, strikes_only)
        check_form(form)
        faults: list[str] = []
        periods = count("periods", periods, faults, least=1, most=HIGHEST)
        refuse("", faults)
        self.periods, self.form, self.slowest = periods, form, slowest / self.mode.omega or 1.0
        self._flights = flight_solver(self.mode.oscillator(0.0), self.slowest)

    def striking(self, model: Oscillator, omega: float) -> list[StationaryMotion]:
        """Motions of the admissible orbits that are stable by this solver's form."""
        orbits = admissible_orbits(ImpactMap(model, omega, self._flights), self.periods)
        return [orbit_motion(orbit) for orbit in orbits if orbit_invariants(orbit, self.form).stable]


def orbit_motion(orbit: FixedPoint) -> StationaryMotion:
    """Stationary motion of an orbit."""
    n, period = orbit.periods, 2 * np.pi / orbit.omega
    since = (np.arange(n) + 1) * period - orbit.time
    mean, square = orbit.means()
    return StationaryMotion(
        orbit.oscillator.gap, orbit.lowest(), orbit.place(since), mean, square, n, 1 / n, orbit.velocity
    )
