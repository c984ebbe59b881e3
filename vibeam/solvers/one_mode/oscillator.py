"""Nondimensional oscillator of the analytical methods, q̈ + 2βq̇ + q = Ω²B sin Ωt under a stop at Δ; conversion to SI.

One mode η'' + 2ζω η' + ω² η = load Ω̃²b sin Ω̃t̃ + static with the stop at cη = gap becomes, for the contact's distance
q = cη − u_s from its static place u_s = c·static/ω² and the time t = ωt̃,

    q̈ + 2βq̇ + q = Ω²B sin Ωt for q < Δ, q̇⁺ = −R q̇⁻ at q = Δ      (paper §2)

with β = ζ, Ω = Ω̃/ω, B = c·load·b, Δ = gap − u_s. The equation is homogeneous in q, B and Δ, so its unit of length is
free: it stays the metre, and only times and velocities are scaled. Nothing is approximated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.flight.equilibrium import equilibrium
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.state import State
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class Oscillator:
    """β ``damping``, B ``drive``, Δ ``gap``, R ``restitution`` (paper §2); B and Δ in any one unit of length.

    ValueError names every number that is out of range: β in [0, 1), R in [0, 1], all finite.
    """

    damping: float
    drive: float
    gap: float = 0.0
    restitution: float = 1.0

    def __post_init__(self) -> None:
        faults = [] if 0 <= self.damping < 1 else [f"damping {self.damping} is outside [0, 1): it must be underdamped"]
        faults += [] if np.isfinite(self.drive) else [f"drive {self.drive} is not finite"]
        faults += [] if np.isfinite(self.gap) else [f"gap {self.gap} is not finite"]
        faults += [] if 0 <= self.restitution <= 1 else [f"restitution {self.restitution} is outside [0, 1]"]
        if faults:
            raise ValueError("; ".join(faults))

    @property
    def damped(self) -> float:
        """ω_D = √(1 − β²)."""
        return float(np.sqrt(1 - self.damping**2))

    def force(self, omega: float, time: float) -> float:
        """Forcing F(t) = Ω²B sin Ωt."""
        return float(omega**2 * self.drive * np.sin(omega * time))

    def harmonic(self, omega: float) -> complex:
        """Phasor H of the motion Im(H e^{iΩt}) without the stop; infinite at an undamped resonance."""
        below = complex(1 - omega**2, 2 * self.damping * omega)
        return omega**2 * self.drive / below if below else complex(np.inf)


@dataclass(frozen=True)
class OneMode:
    """System of one underdamped mode and its conversion to the analytical methods' variables."""

    system: ImpactSystem

    def __post_init__(self) -> None:
        faults = one_mode_faults(self.system)
        if faults:
            raise ValueError("; ".join(faults))

    @property
    def omega(self) -> float:
        """Frequency ω, rad/s: the unit of frequency."""
        return float(self.system.omega[0])

    @property
    def contact(self) -> float:
        """Contact value c of the mode."""
        return float(self.system.contact[0])

    @property
    def static(self) -> float:
        """Static contact displacement u_s without the stop, m."""
        return self.contact * float(self.system.static[0]) / self.omega**2

    def oscillator(self, amplitude: float) -> Oscillator:
        """Oscillator under base motion of ``amplitude`` m."""
        own = self.system
        drive = self.contact * float(own.load[0]) * amplitude
        return Oscillator(float(own.zeta[0]), drive, own.gap - self.static, own.restitution)

    def inward(self, state: State | None) -> Array:
        """(q, q̇) of a state; None: equilibrium. ValueError where it is not one finite number each."""
        start = equilibrium(self.system) if state is None else state
        both = np.array([start.displacement, start.velocity], dtype=float)
        if both.shape != (2, 1) or not np.all(np.isfinite(both)):
            raise ValueError("state: displacement and velocity must be 1 finite number each")
        place, speed = self.contact * both[:, 0]
        return np.array([place - self.static, speed / self.omega])

    def outward(self, place: Array, resting: bool = False) -> State:
        """State of (q, q̇)."""
        q, speed = float(place[0]), float(place[1])
        return State(
            np.array([(q + self.static) / self.contact]), np.array([speed * self.omega / self.contact]), resting
        )


def one_mode_faults(system: ImpactSystem) -> list[str]:
    """Reasons why the analytical methods cannot take ``system``; empty where they can."""
    if system.size != 1:
        return [f"the analytical methods take one mode, this system has {system.size}: reduce it, or fly it"]
    omega, zeta = float(system.omega[0]), float(system.zeta[0])
    faults = [] if omega > 0 else ["the mode has no stiffness (omega = 0): there is nothing to scale time by"]
    return faults if zeta < 1 else [*faults, f"the mode is not underdamped (zeta = {zeta})"]


def oscillator(system: ImpactSystem, amplitude: float) -> Oscillator:
    """Oscillator of a system of one mode under base motion of ``amplitude`` m; ValueError where it is not one."""
    return OneMode(system).oscillator(amplitude)
