"""The scene: what stands on the bench, as frozen data in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Damping:
    """How the beam is damped, said by its modal ratios.

    ``kind``: ``"constant"`` (every mode has ratios[0]), ``"stiffness"`` (C = D K, mode 1 has ratios[0]: the paper's),
    ``"rayleigh"`` (C = αM + DK, modes 1 and 2 have ratios[0] and ratios[1]) or ``"list"`` (mode i has ratios[i], every
    further mode the last one).
    """

    kind: Literal["constant", "stiffness", "rayleigh", "list"]
    ratios: tuple[float, ...]


@dataclass(frozen=True)
class Beam:
    """A uniform cantilever of rectangular section: lengths in m, modulus in Pa, density in kg/m³."""

    length: float
    width: float
    thickness: float
    youngs_modulus: float
    density: float
    damping: Damping
    elements: int = 36

    @property
    def bending_stiffness(self) -> float:
        """EI in N m²."""
        return self.youngs_modulus * self.width * self.thickness**3 / 12

    @property
    def mass_per_length(self) -> float:
        """ρA in kg/m."""
        return self.density * self.width * self.thickness


@dataclass(frozen=True)
class Mass:
    """Attached mass: kg, m; ``rotary_inertia`` in kg m² and ``rigid_half_width`` in m are effects, None if absent."""

    mass: float
    position: float
    rotary_inertia: float | None = None
    rigid_half_width: float | None = None


@dataclass(frozen=True)
class AddedMass:
    """A further point mass (an accelerometer, say): kg, m."""

    mass: float
    position: float


@dataclass(frozen=True)
class Stop:
    """A one-sided stop ``gap`` m from the contact point at ``position`` m along the beam.

    ``gap_at``: where the gap was measured, at the contact or, as grazing amplitude, at the sensor (it is then carried
    to the contact by the static mode). ``restitution_of``: whose coefficient ``restitution`` is, the contact's or the
    first mode's (each fidelity's contact value is then derived so that mode 1 sees it).
    """

    position: float
    gap: float
    restitution: float
    gap_at: Literal["contact", "sensor"] = "contact"
    restitution_of: Literal["contact", "first mode"] = "contact"


@dataclass(frozen=True)
class Sensor:
    """Where the displacement is measured, m from the clamp."""

    position: float


@dataclass(frozen=True)
class Base:
    """The base motion b(t) = amplitude · sin Ωt, either given (``amplitude``, m) or as ``voltage`` (V) times ``gain`` γ
    (1/V, eq. 46 of the paper: amplitude = γ V φ(L_m) L, with φ of the massless beam).
    """

    amplitude: float | None = None
    voltage: float | None = None
    gain: float | None = None


@dataclass(frozen=True)
class Scene:
    """A cantilever with an attached mass, a stop, a sensor and a shaken base."""

    beam: Beam
    mass: Mass
    stop: Stop
    sensor: Sensor
    base: Base
    added_masses: tuple[AddedMass, ...] = ()


@dataclass(frozen=True)
class SdofScene:
    """The single-degree-of-freedom model given directly (the paper's §2): q̈ + 2ζω q̇ + ω² q = Ω² B sin Ωt, q ≤ gap.

    ``natural_frequency`` in rad/s (1: the nondimensional model), ``gap`` and ``amplitude`` (B) in the unit of q.
    """

    natural_frequency: float
    damping_ratio: float
    gap: float
    restitution: float
    amplitude: float
