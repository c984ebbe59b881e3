"""From the scene's platform, shaker and drive to the base motion, or to the platform that the beam pushes back."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from vibeam_models.effects.platform import MovingPlatform, PlatformFilter
from vibeam_models.scene import Base, Platform, Shaker

Array = NDArray[np.float64]
WITHOUT_BOUND = 1e9  # times the static motion: a resonance that only round-off bounds


def platform_filter(platform: Platform, shaker: Shaker | None) -> PlatformFilter:
    """The platform without the beam, per newton or, with a shaker, per volt."""
    mechanical = (platform.mass, _damping(platform), platform.stiffness)
    if shaker is None:
        return PlatformFilter(*mechanical)
    return PlatformFilter(*mechanical, shaker.force_factor, shaker.resistance, shaker.inductance)


def moving_platform(platform: Platform, shaker: Shaker | None, carried: float) -> MovingPlatform:
    """The platform under a beam of ``carried`` kg; a coil without inductance adds (Bl)²/R to its damping.

    ValueError for a shaker with inductance: its current would be a state of its own.
    """
    if shaker is None:
        return MovingPlatform(platform.mass, _damping(platform), platform.stiffness, carried)
    if shaker.inductance:
        raise ValueError("shaker: with inductance the coupling can be one-way only")
    braking = shaker.force_factor**2 / shaker.resistance
    return MovingPlatform(platform.mass, _damping(platform) + braking, platform.stiffness, carried)


def amplitude_on_platform(
    platform: Platform, shaker: Shaker | None, base: Base, prescribed: float | None, omega: Array
) -> Array:
    """Amplitude (points,) in m at ``omega`` (rad/s): of the base with one-way coupling, F/(m_pΩ²) with two-way.

    ``prescribed``: the base motion in m that holds at ``platform.calibrated_at``; None where ``base`` gives the input,
    a force or a shaker's voltage.
    """
    alone = platform_filter(platform, shaker)
    given = _input(base, shaker) if prescribed is None else prescribed / _gain(alone, platform.calibrated_at or 0.0)
    if platform.coupling == "one-way":
        return np.asarray(given * _gain(alone, omega))
    force = given if shaker is None else given * shaker.force_factor / shaker.resistance
    return np.asarray(force / (platform.mass * omega**2))


def _input(base: Base, shaker: Shaker | None) -> float:
    given = base.force if shaker is None else base.voltage
    if given is None:
        raise ValueError(f"base: the platform needs {'a force' if shaker is None else 'the voltage of its shaker'}")
    return given


def _gain(alone: PlatformFilter, omega: Array | float) -> Array:
    """|b| per input; ValueError at the natural frequency of a platform without damping."""
    static = (alone.force_factor / alone.resistance if alone.force_factor else 1.0) / alone.stiffness
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = np.abs(alone.base_per_input(omega))
    if not np.all(gain < WITHOUT_BOUND * static):
        raise ValueError("the platform is not damped and driven at its natural frequency: give it a damping_ratio")
    return np.asarray(gain)


def _damping(platform: Platform) -> float:
    return 2 * platform.damping_ratio * sqrt(platform.stiffness * platform.mass)
