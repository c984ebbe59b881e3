"""Mapping solver: stable fixed points of the impact map, as in the paper's pointwise mapping (eq. 28–37).

Fixed points follow in closed form, their stability from trace and determinant of the map's Jacobian; the map is not
iterated, for that is the work of the flight solver. So all motions with one impact every n periods are found, and none
with more impacts, chatter or chaos: such a point is NaN.

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
from math import cos, exp, sin
from typing import Literal

import numpy as np

from vibeam.solvers.impact_map import FixedPoint, Impact, ImpactMap, fixed_points, flight_solver
from vibeam.solvers.one_mode import Oscillator, StationaryMotion, StationarySolver
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arguments import count, refuse

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


HIGHEST = 16  # longest period in a response


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
