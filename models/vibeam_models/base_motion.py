"""From the scene's platform, shaker and drive to the base motion, or to the platform that the beam pushes back."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam_models.scene import Base, Scene, SdofScene

if TYPE_CHECKING:
    from vibeam_models.effects.platform import MovingPlatform, Platform, PlatformFilter, Shaker

Array = NDArray[np.float64]

WITHOUT_BOUND = 1e9  # times the static motion: a resonance that only round-off bounds


def platform_filter(platform: Platform, shaker: Shaker | None) -> PlatformFilter:
    """The platform without the beam, per newton or, with a shaker, per volt."""
    from vibeam_models.effects.platform import PlatformFilter

    mechanical = (platform.mass, _damping(platform), platform.spring)
    if shaker is None:
        return PlatformFilter(*mechanical)
    return PlatformFilter(*mechanical, shaker.force_factor, shaker.resistance, shaker.inductance)


def moving_platform(platform: Platform, shaker: Shaker | None, carried: float) -> MovingPlatform:
    """The platform under a beam of ``carried`` kg; a coil without inductance adds (Bl)²/R to its damping.

    ValueError for a shaker with inductance: its current would be a state of its own.
    """
    from vibeam_models.effects.platform import MovingPlatform

    if shaker is None:
        return MovingPlatform(platform.mass, _damping(platform), platform.spring, carried)
    if shaker.inductance:
        raise ValueError("shaker: with inductance the coupling can be one-way only")
    braking = shaker.force_factor**2 / shaker.resistance
    return MovingPlatform(platform.mass, _damping(platform) + braking, platform.spring, carried)


def amplitude_on_platform(
    platform: Platform, shaker: Shaker | None, base: Base, prescribed: float | None, omega: Array
) -> Array:
    """Amplitude (points,) in m at ``omega`` (rad/s): of the base with one-way coupling, F/(m_pΩ²) with two-way.

    ``prescribed``: the base motion in m that holds at ``platform.calibrated_at``; None where ``base`` gives the input,
    a force or a shaker's voltage.
    """
    alone = platform_filter(platform, shaker)
    given = _input(base, shaker) if prescribed is None else prescribed / _gain(alone, platform.calibration or 0.0)
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
    return 2 * platform.damping_ratio * sqrt(platform.spring * platform.mass)


def base_amplitude(scene: Scene | SdofScene) -> float:
    """Amplitude of the base motion in m: as given, or γ V φ(L_m) L with φ of the massless beam (eq. 44, 46).

    A SdofScene's own amplitude, in its own unit. ValueError where the scene gives neither, or both, and on a platform,
    where it depends on the frequency: ``drive_amplitude`` has it there too.
    """
    if isinstance(scene, SdofScene):
        return scene.amplitude
    if scene.platform is not None:
        raise ValueError("base: on a platform the amplitude depends on the frequency")
    return _prescribed(scene)


def drive_amplitude(scene: Scene | SdofScene, omega: Array) -> float | Array:
    """Drive amplitude of a sweep over ``omega`` (rad/s): ``base_amplitude``, or on a platform one each, (points,).

    With one-way coupling that of the base, with two-way the b₀ = F/(m_pΩ²) that ``MovingPlatform`` is loaded by.
    ValueError as ``base_amplitude``.
    """
    if isinstance(scene, SdofScene) or scene.platform is None:
        return base_amplitude(scene)

    given = None if scene.platform.calibrated_at is None else _prescribed(scene)
    return amplitude_on_platform(scene.platform, scene.shaker, scene.base, given, np.asarray(omega, dtype=float))


def _prescribed(scene: Scene) -> float:
    amplitude, voltage, gain = scene.base.amplitude, scene.base.voltage, scene.base.gain
    if amplitude is not None and voltage is None and gain is None:
        return amplitude
    if amplitude is not None or voltage is None or gain is None:
        raise ValueError("base: give either an amplitude, or a voltage and a gain")
    from vibeam_models.sdof import sdof_model

    return sdof_model(scene).base_per_volt(gain) * voltage
