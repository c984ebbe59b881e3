"""The nondimensional coefficient-of-restitution model from geometry (paper eq. 43–46).

q̈ + 2βq̇ + q = Ω²B sin Ωt for q < Δ, q̇⁺ = −R q̇⁻ at q = Δ; q is the sensor's displacement over L, time is ω_n t.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from vibeam_models.base import Base
from vibeam_models.beam import structure_of
from vibeam_models.scene import AnyScene, Scene
from vibeam_models.static_shape import static_shape_of
from vibeam_models.stop import Stop
from vibeam_models.structure import Structure


@dataclass(frozen=True)
class SdofScene(AnyScene):
    """The single-degree-of-freedom model given directly (the paper's §2): q̈ + 2ζω q̇ + ω² q = Ω² B sin Ωt, q ≤ gap.

    ``natural_frequency`` in rad/s (1: the nondimensional model), ``gap`` and ``amplitude`` in the unit of q: B, or a
    ``Base`` where that depends on Ω.
    ``restitution`` is 1 where the stop's law says the loss otherwise. ``stop``: what the stop does beyond one
    coefficient of restitution, in these units and per unit of mass (its position means nothing); None: nothing.
    """

    natural_frequency: float
    damping_ratio: float
    gap: float
    restitution: float
    amplitude: float | Base
    stop: Stop | None = None

    @property
    def base(self) -> Base:
        """The drive as that of every scene."""
        return self.amplitude if isinstance(self.amplitude, Base) else Base(amplitude=self.amplitude)

    @property
    def held(self) -> tuple[str, float]:
        """As ``AnyScene.held``."""
        return "", self.restitution

    @property
    def natural_unit(self) -> float:
        """As ``AnyScene.natural_unit``."""
        return self.natural_frequency

    @property
    def given_mode(self) -> tuple[float, float]:
        """As ``AnyScene.given_mode``."""
        return self.natural_frequency, self.damping_ratio

    @property
    def no_beam(self) -> str:
        """As ``AnyScene.no_beam``."""
        return "this case gives the SDOF model directly, there is no beam"


@structure_of.register
def _(scene: SdofScene) -> Structure:
    """The one mode, mass-normalised."""
    one, zero = np.ones(1), np.zeros(1)
    omega, zeta = scene.given_mode
    matrices = np.eye(1), np.full((1, 1), 2 * zeta * omega), np.full((1, 1), omega**2)
    return Structure(*matrices, load=-one, static=zero, contact=one, outputs={"sensor": one})


@dataclass(frozen=True)
class SdofModel:
    """The paper's model of one scene: eq. 43–46 for a massless beam under a point mass.

    ``length`` L m; ``shape`` φ(L_m), φ = 1 at the sensor; ``stiffness`` K_S N/m; ``mass``
    M_S kg; ``damping_ratio`` β_S; ``gap`` Δ; ``restitution`` R.
    """

    length: float
    shape: float
    stiffness: float
    mass: float
    damping_ratio: float
    gap: float
    restitution: float

    @property
    def omega(self) -> float:
        """ω_n = √(K_S/M_S) in rad/s (eq. 45)."""
        return sqrt(self.stiffness / self.mass)

    def gain(self, base_per_volt: float) -> float:
        """γ = γ̃/(φ(L_m) L) in 1/V (eq. 46); ``base_per_volt`` γ̃ in m/V. The same turns a base amplitude into B."""
        return base_per_volt / (self.shape * self.length)

    def base_per_volt(self, gain: float) -> float:
        """γ̃ = γ φ(L_m) L in m/V, the inverse of ``gain``. The same turns B into a base amplitude in m."""
        return gain * self.shape * self.length

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
        stiffness=static.stiffness,
        mass=scene.mass.mass * shape**2,
        damping_ratio=beam.damping.ratios[0],
        gap=scene.stop.gap / beam.length / (contact if scene.stop.gap_at == "contact" else 1.0),
        restitution=scene.stop.usual_restitution,
    )
