"""The nondimensional coefficient-of-restitution model from geometry (paper eq. 43–47) and its way to and from SI.

q̈ + 2βq̇ + q = Ω²B sin Ωt for q < Δ, q̇⁺ = −R q̇⁻ at q = Δ; q is the sensor's displacement over L, time is ω_n t.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from vibeam_models.scene import Scene, SdofScene
from vibeam_models.static_shape import static_shape_of


@dataclass(frozen=True)
class SdofModel:
    """The paper's model of one scene: eq. 43–47 for a massless beam under a point mass.

    ``length`` L m; ``shape`` φ(L_m) and ``contact_shape`` φ at the stop, both 1 at the sensor; ``stiffness`` K_S N/m;
    ``mass`` M_S kg; ``damping_ratio`` β_S; ``gap`` Δ; ``restitution`` R.
    """

    length: float
    shape: float
    contact_shape: float
    stiffness: float
    mass: float
    damping_ratio: float
    gap: float
    restitution: float

    @property
    def omega(self) -> float:
        """ω_n = √(K_S/M_S) in rad/s (eq. 45)."""
        return sqrt(self.stiffness / self.mass)

    @property
    def damping_time(self) -> float:
        """D = 2β_S/ω_n in s, of C = D K (eq. 45)."""
        return 2 * self.damping_ratio / self.omega

    def gain(self, base_per_volt: float) -> float:
        """γ = γ̃/(φ(L_m) L) in 1/V (eq. 46); ``base_per_volt`` γ̃ in m/V. The same turns a base amplitude into B."""
        return base_per_volt / (self.shape * self.length)

    def base_per_volt(self, gain: float) -> float:
        """γ̃ = γ φ(L_m) L in m/V, the inverse of ``gain``. The same turns B into a base amplitude in m."""
        return gain * self.shape * self.length

    def from_si(self, displacement: float, time: float = 0.0) -> tuple[float, float]:
        """(q, nondimensional time) of a sensor ``displacement`` in m and a ``time`` in s (eq. 47, the factor is L)."""
        return displacement / self.length, time * self.omega

    def to_si(self, q: float, time: float = 0.0) -> tuple[float, float]:
        """Sensor displacement q L in m and time in s, the inverse of ``from_si``."""
        return q * self.length, time / self.omega

    def scene(self, base_amplitude: float) -> SdofScene:
        """The nondimensional scene (ω = 1) under a base motion of ``base_amplitude`` m."""
        drive = self.gain(base_amplitude)
        return SdofScene(1.0, self.damping_ratio, self.gap, self.restitution, drive)


def sdof_model(scene: Scene) -> SdofModel:
    """The paper's model of ``scene``; its effects, beam mass and further masses are what this model leaves out.

    β_S is the first given damping ratio, Δ = Δ_G/L with Δ_G the grazing amplitude at the sensor. ValueError where mass
    or sensor stand at the clamp, and for a beam without an attached mass. φ of eq. 44 is that of a uniform cantilever;
    another beam's is taken from finite elements (``static_shape_of``).
    """
    if scene.mass is None:
        raise ValueError("the single degree of freedom of eq. 43-47 is that of an attached mass: the beam is bare")
    beam, load_at, unit_at = scene.shaped_beam, scene.mass.position, scene.sensor.position
    if not (load_at > 0 and unit_at > 0):
        raise ValueError("the static shape needs mass and sensor away from the clamp")
    static = static_shape_of(beam, load_at, unit_at)
    shape, contact = static.at(load_at), static.at(scene.stop.position)
    return SdofModel(
        length=beam.length,
        shape=shape,
        contact_shape=contact,
        stiffness=static.stiffness,
        mass=scene.mass.mass * shape**2,
        damping_ratio=beam.damping.ratios[0],
        gap=scene.stop.gap / beam.length / (contact if scene.stop.gap_at == "contact" else 1.0),
        restitution=scene.stop.usual_restitution,
    )
