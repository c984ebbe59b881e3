"""The platform under clamp and stop: a filter on the drive, or one more coordinate that impacts push back.

x stays relative to the platform, b is the platform's own displacement, m_b the mass that it carries:

    M ẍ + C ẋ + K x + M r b̈ = wᵀλ
    rᵀM ẍ + (m_p + m_b) b̈ + c ḃ + k b = F sin Ωt

The stop stands on the platform, so that the contact force λ is an inner force of the two and b is not in its row.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar, Literal

import numpy as np

from vibeam_models.arrays import Array
from vibeam_models.keys import quantity, word
from vibeam_models.scene import Effect
from vibeam_models.structure import Structure


@dataclass(frozen=True, kw_only=True)
class Platform(Effect):
    """Clamp and stop stand on a sprung platform, and the drive is a force on it; absent = the base's motion
    is prescribed.
    """

    mass: float = quantity("kg", "of the platform without the beam", "5 kg", above=0)
    frequency: float | None = quantity("Hz", "natural, of the platform without the beam", "3.25 Hz", None, above=0)
    stiffness: float | None = quantity("N/m", "of its springs, instead of its frequency", "2000 N/m", None, above=0)
    damping_ratio: float = quantity("", "of the platform without the beam", 0.05, least=0)
    coupling: Literal["one-way", "two-way"] = word(
        ("one-way", "two-way"),
        "the platform filters the drive alone, or the beam and its impacts push back too",
        "one-way",
    )
    calibrated_at: float | None = quantity(
        "Hz", "drive frequency at which the drive's amplitude, or voltage and gain, hold", "15.5 Hz", None, above=0
    )

    name: ClassVar[str] = "platform"

    @property
    def spring(self) -> float:
        """Stiffness of its springs in N/m: as given, or that of its natural frequency."""
        return self.mass * (2 * pi * (self.frequency or 0.0)) ** 2 if self.stiffness is None else self.stiffness

    @property
    def calibration(self) -> float | None:
        """``calibrated_at`` in rad/s."""
        return None if self.calibrated_at is None else 2 * pi * self.calibrated_at

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: one stiffness, said once."""
        if table.frequency is not None and table.stiffness is not None:
            yield "frequency", "platform.stiffness says it already: keep one of the two"
        elif table.frequency is None and table.stiffness is None:
            yield "frequency", 'missing (or stiffness): write frequency = "3.25 Hz"'


@dataclass(frozen=True)
class Shaker(Effect):
    """An electrodynamic exciter drives the platform by its voltage; absent = the force is prescribed."""

    resistance: float = quantity("ohm", "of the coil", "4 ohm", above=0)
    force_factor: float = quantity("N/A", "Bl, force per current", "20 N/A", above=0)
    inductance: float = quantity("H", "of the coil; one-way coupling alone knows it", "0 H", 0.0, least=0)

    name: ClassVar[str] = "shaker"

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """As ``Effect.faults``: a platform to drive, and no state of the coil's own."""
        if case.platform is None:
            yield "", "drives a platform: add [platform], or take [shaker] away"
        elif case.platform.coupling == "two-way" and table.inductance:
            message = (
                "with two-way coupling the coil's current would be a state of its own, half a mode, which no solver "
                'carries: leave inductance out, or write coupling = "one-way"'
            )
            yield "inductance", message


@dataclass(frozen=True)
class PlatformFilter:
    """One-way: m b̈ + c ḃ + k b = F moves the base and does not feel the beam; kg, N s/m, N/m.

    With a shaker, of ``force_factor`` Bl N/A, ``resistance`` ohm and ``inductance`` H, the force is that of its coil:
    L i̇ + R i + Bl ḃ = V, F = Bl i. Without one, ``force_factor`` 0, the input is the force itself.
    """

    mass: float
    damping: float
    stiffness: float
    force_factor: float = 0.0
    resistance: float = 0.0
    inductance: float = 0.0

    def base_per_input(self, omega: Array | float) -> Array:
        """Complex b/F in m/N, or b/V in m/V, at ``omega`` rad/s (any shape)."""
        turning = 1j * np.asarray(omega, dtype=float)
        mechanical = self.stiffness + turning * self.damping + turning**2 * self.mass
        if not self.force_factor:
            return np.asarray(1 / mechanical)
        coil = self.resistance + turning * self.inductance
        return np.asarray(self.force_factor / (coil * mechanical + turning * self.force_factor**2))


@dataclass(frozen=True)
class MovingPlatform:
    """Two-way: ``mass`` kg, ``damping`` N s/m, ``stiffness`` N/m, under a beam of ``carried`` kg in all."""

    mass: float
    damping: float
    stiffness: float
    carried: float

    def under(self, structure: Structure) -> Structure:
        """The platform as last coordinate b under any Structure, reduced or not; output ``"platform"`` reads it.

        The load is −m_p b̈₀ on b alone: b₀ = F/(m_pΩ²) sin Ωt is how the same force would move a free platform. Weight
        across the beam is not on b, which is counted from where the platform rests under it.
        """
        corner = -structure.load
        own = np.array([0.0])
        return structure.with_(
            M=_bordered(structure.M, corner, self.mass + self.carried),
            C=_bordered(structure.C, 0 * corner, self.damping),
            K=_bordered(structure.K, 0 * corner, self.stiffness),
            load=np.concatenate([0 * structure.load, [-self.mass]]),
            static=np.concatenate([structure.static, own]),
            contact=np.concatenate([structure.contact, own]),
            outputs={name: np.concatenate([row, own]) for name, row in structure.outputs.items()}
            | {"platform": np.concatenate([0 * structure.contact, [1.0]])},
            units={**structure.units, "platform": "m"},
            attached=tuple(np.concatenate([row, own]) for row in structure.attached),
        )


def _bordered(matrix: Array, column: Array, corner: float) -> Array:
    return np.block([[matrix, column[:, None]], [column[None, :], np.array([[corner]])]])
