"""Zhuravlev's unfolding (paper eq. 4–8): one mode, the impact turned into a passage through zero.

With u = cη the contact displacement, c the mode's contact value, let x = Δ − u ≥ 0 be the distance to the stop Δ.
From η'' + 2ζωη' + ω²η = load Ω²B sin Ωt + static follows

    x'' + 2ζω x' + ω² x = N(t),   N = ω²Δ − c (load Ω²B sin Ωt + static),     x'⁺ = −R x'⁻ at x = 0.

Put x = |z|, x' = z' sgn z. Between impacts sgn z = s is constant and, s² = 1,

    z'' + 2ζω z' + ω² z = s N(t).

At an impact z goes through 0: s⁺ = −s⁻, and s⁺z'⁺ = x'⁺ = −R x'⁻ = −R s⁻z'⁻ gives z'⁺ = R z'⁻. Without loss (R = 1)
z' is smooth; with loss it is corrected at the event. Signs are mirrored against the paper where its mass lies on the
other side of the stop.

Back: u = Δ − s z, u' = −s z' with the s *of the flight*: v⁻ = −s⁻z'⁻ before the impact and −s⁺z'⁺ = s⁻R z'⁻ = −R v⁻
after it; u' jumps there and nowhere else. Taking sgn z of the computed z instead, which at the root
is 0 or of either sign by round-off, puts a stray value of the wrong sign beside each impact: the paper's "additional
velocity jump" (Fig. 5).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import sin

import numpy as np

from vibeam.solvers.integration.coordinates import Frame, only_one_mode
from vibeam.solvers.integration.impact_events import EventSolver
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class Distance:
    """Distance of one mode from the stop: x'' + 2ζω x' + ω² x = N(t), N = constant + forced sin Ωt."""

    stiffness: float
    damping: float
    constant: float
    forced: float
    drive: float
    gap: float
    contact: float
    restitution: float

    @classmethod
    def of(cls, system: ImpactSystem, drive: Drive) -> Distance:
        """Distance equation of a system of one mode under a drive."""
        omega, contact = float(system.omega[0]), float(system.contact[0])
        constant = omega**2 * system.gap - contact * float(system.static[0])
        forced = -contact * float(system.load[0]) * drive.omega**2 * drive.amplitude
        damping = 2 * float(system.zeta[0]) * omega
        return cls(
            omega**2, damping, constant, forced, drive.omega, system.gap, contact, system.restitution
        )  # fmt: skip

    def load(self, t: float) -> float:
        """Forcing N(t)."""
        return self.constant + self.forced * sin(self.drive * t)

    def modal(self, x: Array, rate: Array) -> Array:
        """Modal η and η' (m, 2, 1) of distances and their rates (m,)."""
        return np.stack([(self.gap - x) / self.contact, -rate / self.contact], axis=1)[:, :, None]

    def distance(self, state: State) -> tuple[float, float]:
        """Distance x ≥ 0 and rate x' of a state."""
        x = self.gap - self.contact * float(state.displacement[0])
        return x, -self.contact * float(state.velocity[0])

    @property
    def scale(self) -> Array:
        """Sizes of x and x' for a contact motion of 1 m."""
        return np.array([1.0, np.sqrt(self.stiffness) if self.stiffness > 0 else 1.0])


@dataclass(frozen=True)
class Unfolded:
    """Coordinates y = (z, z') of one flight on the side s = ±1."""

    of: Distance
    side: float
    scale: Array

    def outward(self, states: Array) -> Array:
        """See ``Frame.outward``: x = s z, x' = s z'."""
        return self.of.modal(self.side * states[0], self.side * states[1])

    def rate(self, t: float, y: Array) -> tuple[float, float]:
        """See ``Frame.rate``: z'' = s N(t) − 2ζωz' − ω²z."""
        z, slope = y
        return slope, self.side * self.of.load(t) - self.of.damping * slope - self.of.stiffness * z

    def rate_at_rest(self, t: float, y: Array) -> tuple[float, float]:
        """See ``Frame.rate_at_rest``: one mode held on the stop does not move."""
        return 0.0, 0.0

    def excess(self, y: Array) -> Array:
        """See ``Frame.excess``: −s z."""
        return np.asarray(-self.side * y[0])

    def approach(self, y: Array) -> Array:
        """See ``Frame.approach``: −s z'."""
        return np.asarray(-self.side * y[1])

    def press(self, t: float, y: Array) -> float:
        """See ``Frame.press``: −x''."""
        return float(-self.side * self.rate(t, y)[1])

    def touch(self, y: Array) -> Array:
        """See ``Frame.touch``."""
        return np.array([0.0, y[1]])

    def hold(self, y: Array) -> Array:
        """See ``Frame.hold``."""
        return np.zeros(2)

    def strike(self, y: Array) -> tuple[Frame, Array]:
        """See ``Frame.strike``: to the other side, z'⁺ = R z'⁻."""
        return replace(self, side=-self.side), np.array([y[0], self.of.restitution * y[1]])


class ZhuravlevSolver(EventSolver):
    """Integration in Zhuravlev's coordinates: one mode, the velocity corrected by R at every passage of the stop.

    Options as for ``EventSolver``. ValueError for more than one mode. R = 0 is allowed: the flight then starts anew
    from rest.
    """

    def takes(self, system: ImpactSystem) -> None:
        """As ``AdaptiveStepper.takes``: one mode."""
        only_one_mode("zhuravlev", system)

    def enter(self, drive: Drive, state: State) -> tuple[Frame, Array]:
        """See ``EventSolver.enter``."""
        distance = Distance.of(self.system, drive)
        return Unfolded(distance, 1.0, distance.scale), np.array(distance.distance(state))
