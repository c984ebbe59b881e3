"""The nondimensional coefficient-of-restitution model from geometry (paper eq. 43–47) and its way to and from SI.

q̈ + 2βq̇ + q = Ω²B sin Ωt for q < Δ, q̇⁺ = −R q̇⁻ at q = Δ; q is the sensor's displacement over L, time is ω_n t.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from vibeam_models.scene import Beam, Scene, SdofScene


def static_shape(x: float, load_at: float, unit_at: float) -> float:
    """φ(x): static deflection of a cantilever loaded at ``load_at``, 1 at ``unit_at`` (m); eq. 44 for x = L_m."""
    return _deflection(x, load_at) / _deflection(unit_at, load_at)


def static_slope(x: float, load_at: float, unit_at: float) -> float:
    """φ'(x) of ``static_shape`` in 1/m."""
    reached = min(x, load_at)
    return 3 * reached * (2 * load_at - reached) / _deflection(unit_at, load_at)


def static_stiffness(beam: Beam, load_at: float, unit_at: float) -> float:
    """K_S = 3EI φ(L_m)²/L_m³ in N/m (eq. 45), lengths in m."""
    return 3 * beam.bending_stiffness * static_shape(load_at, load_at, unit_at) ** 2 / load_at**3


def beam_mass(beam: Beam, load_at: float, unit_at: float) -> float:
    """∫ρAφ² dx in kg: what the beam's own mass adds to M_S when it moves by the static shape."""
    a, rest = load_at, beam.length - load_at
    bent = 33 * a**7 / 35
    straight = a**4 * (4 * a**2 * rest + 6 * a * rest**2 + 3 * rest**3)
    return beam.mass_per_length * (bent + straight) / _deflection(unit_at, load_at) ** 2


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
    or sensor stand at the clamp, and for a beam without an attached mass.
    """
    if scene.mass is None:
        raise ValueError("the single degree of freedom of eq. 43-47 is that of an attached mass: the beam is bare")
    beam, load_at, unit_at = scene.beam, scene.mass.position, scene.sensor.position
    if not (load_at > 0 and unit_at > 0):
        raise ValueError("the static shape needs mass and sensor away from the clamp")
    shape = static_shape(load_at, load_at, unit_at)
    contact = static_shape(scene.stop.position, load_at, unit_at)
    return SdofModel(
        length=beam.length,
        shape=shape,
        contact_shape=contact,
        stiffness=static_stiffness(beam, load_at, unit_at),
        mass=scene.mass.mass * shape**2,
        damping_ratio=beam.damping.ratios[0],
        gap=scene.stop.gap / beam.length / (contact if scene.stop.gap_at == "contact" else 1.0),
        restitution=scene.stop.usual_restitution,
    )


def _deflection(x: float, load_at: float) -> float:
    """6EI/P times the deflection at x: x²(3a − x) up to the load at a, a²(3x − a) beyond."""
    return x**2 * (3 * load_at - x) if x <= load_at else load_at**2 * (3 * x - load_at)
