"""Dynamics of the platform between shaker and clamp: it filters the drive, and impacts change its velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from vibeam_models.arrays import Array, Complex

Constant = Literal["force", "velocity"]


@dataclass(frozen=True)
class PlatformDynamics:
    """Mass (kg), natural frequency (Hz) and damping ratio of a platform on springs; ValueError where out of range."""

    mass: float
    frequency: float
    damping_ratio: float = 0.0

    def __post_init__(self) -> None:
        if not (self.mass > 0 and self.frequency >= 0 and self.damping_ratio >= 0):
            raise ValueError(f"platform: {self}: mass must be > 0, frequency and damping ratio ≥ 0")

    def receptance(self, frequency: ArrayLike) -> Complex:
        """Base displacement over force at frequencies in Hz, m/N: that of a one-way platform, complex."""
        from vibeam_models.effects.platform import PlatformFilter

        own = 2 * np.pi * self.frequency
        filter_ = PlatformFilter(self.mass, 2 * self.damping_ratio * own * self.mass, self.mass * own**2)
        return np.asarray(filter_.base_per_input(2 * np.pi * np.asarray(frequency, dtype=float)))


def base_per_volt(
    platform: PlatformDynamics, frequency: ArrayLike, per_volt: float, constant: Constant = "force"
) -> Complex:
    """Complex base displacement over voltage at frequencies in Hz, m/V: its modulus is the gain, its angle the phase.

    ``constant``: the quantity that the shaker holds per volt, a force (``per_volt`` in N/V, current drive) or
    the base's velocity (m/s/V, voltage drive of a strong shaker). A real one lies between. ValueError for another.
    """
    if constant == "force":
        return per_volt * platform.receptance(frequency)
    if constant == "velocity":
        return np.asarray(per_volt / (2j * np.pi * np.asarray(frequency, dtype=float)))
    raise ValueError(f"constant: {constant!r} is none of {', '.join(get_args(Constant))}")


def gain_ratio(platform: PlatformDynamics, frequency: float, reference: float, constant: Constant = "force") -> float:
    """|base over voltage| at ``frequency`` over that at ``reference``, both Hz."""
    pair = np.abs(base_per_volt(platform, [frequency, reference], 1.0, constant))
    return float(pair[0] / pair[1])


def base_velocity_jump(velocity: ArrayLike, restitution: float, mobility: float, platform_mass: float) -> Array:
    """Velocity jump of a free platform's base at an impact, m/s; negative where it is pushed back.

    ``velocity`` m/s: of the contact relative to the stop just before, positive toward it; ``mobility`` S = Σ c_i² of
    the beam on a fixed base, 1/kg (1/S is the impacting mass); ``platform_mass`` kg: moving together with the
    clamp. The stop stands on the platform, so an impulse p = (1+R) v/(S + 1/M_p) acts on it and −p on the beam; a heavy
    platform (S M_p ≫ 1) takes m_eff Δv/M_p. Returned is p/M_p: positive toward where the beam was going.
    """
    if not (mobility > 0 and platform_mass > 0):
        raise ValueError(f"mobility {mobility} and platform_mass {platform_mass} must be positive")
    return np.asarray((1 + restitution) * np.asarray(velocity, dtype=float) / (1 + mobility * platform_mass))
