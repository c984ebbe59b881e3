"""From the scene's platform, shaker and drive to one amplitude at each frequency, or to the platform that is pushed.

Every drive is b(t) = B sin Ωt with B a function of Ω: of a constant velocity V it is V/Ω, of an acceleration A/Ω², of a
force on the beam F/Ω², for F sin Ωt = −b̈.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.base import POWERS, Base, is_constant, level
from vibeam_models.scene import AnyScene, RigScene

if TYPE_CHECKING:
    from vibeam_models.effects.platform import MovingPlatform, Platform, PlatformFilter, Shaker


WITHOUT_BOUND = 1e9  # times the static motion: a resonance that only round-off bounds


def platform_filter(platform: Platform, shaker: Shaker | None) -> PlatformFilter:
    """The platform without the beam, per newton or, with a shaker, per volt."""
    from vibeam_models.effects.platform import PlatformFilter

    coil = () if shaker is None else (shaker.force_factor, shaker.resistance, shaker.inductance)
    return PlatformFilter(platform.mass, _damping(platform), platform.spring, *coil)


def moving_platform(platform: Platform, shaker: Shaker | None, carried: float) -> MovingPlatform:
    """The platform under a beam of ``carried`` kg; a coil without inductance adds (Bl)²/R to its damping.

    ValueError for a shaker with inductance: its current would be a state of its own.
    """
    from vibeam_models.effects.platform import MovingPlatform

    if shaker is not None and shaker.inductance:
        raise ValueError("shaker: with inductance the coupling can be one-way only")
    braking = 0.0 if shaker is None else shaker.force_factor**2 / shaker.resistance
    return MovingPlatform(platform.mass, _damping(platform) + braking, platform.spring, carried)


def amplitude_on_platform(
    platform: Platform, shaker: Shaker | None, base: Base, prescribed: float | Array | None, omega: Array
) -> Array:
    """Amplitude (points,) in m at ``omega`` (rad/s): of the base with one-way coupling, F/(m_pΩ²) with two-way.

    ``prescribed``: the base motion in m that holds at ``platform.calibrated_at``; None where ``base`` gives the input,
    a force or a shaker's voltage.
    """
    alone = platform_filter(platform, shaker)
    given = (
        _input(base, shaker, omega) if prescribed is None else prescribed / _gain(alone, platform.calibration or 0.0)
    )
    if platform.coupling == "one-way":
        return np.asarray(given * _gain(alone, omega))
    force = given if shaker is None else given * shaker.force_factor / shaker.resistance
    return np.asarray(force / (platform.mass * omega**2))


def _input(base: Base, shaker: Shaker | None, omega: Array) -> float | Array:
    given = level(base, "force" if shaker is None else "voltage", omega)
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


def base_amplitude(scene: AnyScene) -> float:
    """Amplitude of the base motion in m: as given, or γ V φ(L_m) L with φ of the massless beam (eq. 44, 46).

    A SdofScene's own amplitude, in its own unit. ValueError where the scene gives neither, or both, and where it
    depends on the frequency, as on a platform: ``drive_amplitude`` has it there too.
    """
    if scene.platform is not None:
        raise ValueError("base: on a platform the amplitude depends on the frequency")
    rig: Any = scene
    if not is_constant(rig.base):
        raise ValueError(
            "drive: one amplitude at all frequencies is needed here, and that of the base depends on them: "
            "write drive.amplitude"
        )
    return float(_prescribed(rig, np.array(1.0)))


def drive_amplitude(scene: AnyScene, omega: Array) -> float | Array:
    """Drive amplitude of a sweep over ``omega`` (rad/s): ``base_amplitude``, or (points,) where it depends on that.

    In m; of a force on the beam F/Ω² in N s², of a moment M/Ω², which the structure's load is made for. On a platform
    with one-way coupling that of the base, with two-way the b₀ = F/(m_pΩ²) that ``MovingPlatform`` is loaded by.
    ValueError as ``base_amplitude``, and for a frequency outside the drive's table.
    """
    rig: Any = scene
    if scene.platform is None and is_constant(rig.base):
        return base_amplitude(scene)
    rates = np.asarray(omega, dtype=float)
    if scene.platform is None:
        return np.asarray(_prescribed(rig, rates))
    held = scene.platform.calibration
    given = None if held is None else _prescribed(rig, rates, held)
    return amplitude_on_platform(scene.platform, scene.shaker, rig.base, given, rates)


def _prescribed(scene: RigScene, omega: Array, at: float | None = None) -> float | Array:
    """B at ``omega`` (rad/s), without the platform; ``at``: the frequency at which a velocity or acceleration holds."""
    base = scene.base
    said = {name: power for name, power in POWERS.items() if getattr(base, name) is not None}
    pushed = bool(said.keys() & {"force", "moment"})
    by_voltage = base.voltage is not None or base.gain is not None
    if len(said) + by_voltage != 1 or (base.voltage is None) != (base.gain is None) or pushed != (base.at is not None):
        raise ValueError(
            "base: give either an amplitude, or a voltage and a gain, or a velocity, or an acceleration, "
            "or a force or a moment at a place of the beam"
        )
    for name, power in said.items():
        value = np.asarray(level(base, name, omega))
        return value / (omega if at is None else at) ** power if power else value
    from vibeam_models.sdof import sdof_model

    beam: Any = scene
    return np.asarray(sdof_model(beam).base_per_volt(base.gain or 0.0) * np.asarray(level(base, "voltage", omega)))
