"""The platform under clamp and stop: a filter on the drive, or one more coordinate that impacts push back.

x stays relative to the platform, b is the platform's own displacement, m_b the mass that it carries:

    M ẍ + C ẋ + K x + M r b̈ = wᵀλ
    rᵀM ẍ + (m_p + m_b) b̈ + c ḃ + k b = F sin Ωt

The stop stands on the platform, so that the contact force λ is an inner force of the two and b is not in its row.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.space import BeamSpace
from vibeam_models.structure import Array, Structure


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

    def apply(self, structure: Structure, space: BeamSpace) -> tuple[Structure, BeamSpace]:
        """As ``under``, with a space whose last coordinate bends nothing."""
        return self.under(structure), space.widened(1)

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
        )


def _bordered(matrix: Array, column: Array, corner: float) -> Array:
    return np.block([[matrix, column[:, None]], [column[None, :], np.array([[corner]])]])
