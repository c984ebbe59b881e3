"""Observers of a response, whatever fidelity made it: pure functions of a motion or of samples.

Functions of a motion take a ``Trajectory`` (or anything like it: ``Path``), functions of samples arrays in s, m and
m/s; both give frozen records of named arrays. Each name is loaded when first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vibeam.observe.apparent_restitution import Restitution as Restitution
    from vibeam.observe.apparent_restitution import adjacent_restitution as adjacent_restitution
    from vibeam.observe.apparent_restitution import extrapolated_restitution as extrapolated_restitution
    from vibeam.observe.apparent_restitution import extremum_restitution as extremum_restitution
    from vibeam.observe.apparent_restitution import first_mode_restitution as first_mode_restitution
    from vibeam.observe.apparent_restitution import mode_restitution as mode_restitution
    from vibeam.observe.apparent_restitution import true_restitution as true_restitution
    from vibeam.observe.collision import Collision as Collision
    from vibeam.observe.collision import collision_of as collision_of
    from vibeam.observe.harmonics import Harmonics as Harmonics
    from vibeam.observe.harmonics import harmonic_amplitudes as harmonic_amplitudes
    from vibeam.observe.harmonics import sampled_harmonics as sampled_harmonics
    from vibeam.observe.low_pass import LowPass as LowPass
    from vibeam.observe.measuring_chain import Chain as Chain
    from vibeam.observe.measuring_chain import Record as Record
    from vibeam.observe.measuring_chain import measure as measure
    from vibeam.observe.motion import Path as Path
    from vibeam.observe.participation import Participation as Participation
    from vibeam.observe.participation import modal_participation as modal_participation
    from vibeam.observe.periodicity import Rhythm as Rhythm
    from vibeam.observe.periodicity import rhythm as rhythm
    from vibeam.observe.platform_gain import Platform as Platform
    from vibeam.observe.platform_gain import base_per_volt as base_per_volt
    from vibeam.observe.platform_gain import base_velocity_jump as base_velocity_jump
    from vibeam.observe.platform_gain import gain_ratio as gain_ratio
    from vibeam.observe.poincare import ImpactSection as ImpactSection
    from vibeam.observe.poincare import Section as Section
    from vibeam.observe.poincare import impact_section as impact_section
    from vibeam.observe.poincare import sampled_section as sampled_section
    from vibeam.observe.poincare import stroboscopic_section as stroboscopic_section
    from vibeam.observe.portrait import Portrait as Portrait
    from vibeam.observe.portrait import phase_portrait as phase_portrait
    from vibeam.observe.ringing import CountedPeaks as CountedPeaks
    from vibeam.observe.ringing import Ringing as Ringing
    from vibeam.observe.ringing import count_peaks as count_peaks
    from vibeam.observe.ringing import fit_ringing as fit_ringing
    from vibeam.observe.slow_motion import SlowPart as SlowPart
    from vibeam.observe.slow_motion import further_modes as further_modes
    from vibeam.observe.slow_motion import slow_part as slow_part
    from vibeam.observe.spectrum import Spectrum as Spectrum
    from vibeam.observe.spectrum import spectrum_of as spectrum_of

_HOMES = {
    "apparent_restitution": (
        "Restitution", "adjacent_restitution", "extrapolated_restitution", "extremum_restitution",
        "first_mode_restitution", "mode_restitution", "true_restitution",
    ),
    "collision": ("Collision", "collision_of"),
    "low_pass": ("LowPass",),
    "harmonics": ("Harmonics", "harmonic_amplitudes", "sampled_harmonics"),
    "measuring_chain": ("Chain", "Record", "measure"),
    "participation": ("Participation", "modal_participation"),
    "motion": ("Path",),
    "periodicity": ("Rhythm", "rhythm"),
    "platform_gain": ("Platform", "base_per_volt", "base_velocity_jump", "gain_ratio"),
    "portrait": ("Portrait", "phase_portrait"),
    "ringing": ("CountedPeaks", "Ringing", "count_peaks", "fit_ringing"),
    "poincare": ("ImpactSection", "Section", "impact_section", "sampled_section", "stroboscopic_section"),
    "slow_motion": ("SlowPart", "further_modes", "slow_part"),
    "spectrum": ("Spectrum", "spectrum_of"),
}  # fmt: skip
_HOME = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'vibeam.observe' has no attribute {name!r}")
    value = getattr(import_module(f"vibeam.observe.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(_HOME)
