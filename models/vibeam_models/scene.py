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
    """A uniform cantilever of rectangular section: lengths in m, modulus in Pa, density in kg/m³.

    ``massless`` is an effect: the beam's own mass is neglected, the paper's m ≫ ρAL.
    """

    length: float
    width: float
    thickness: float
    youngs_modulus: float
    density: float
    damping: Damping
    elements: int = 36
    massless: bool = False

    @property
    def bending_stiffness(self) -> float:
        """EI in N m²."""
        return self.youngs_modulus * self.width * self.thickness**3 / 12

    @property
    def mass_per_length(self) -> float:
        """ρA in kg/m, 0 of a massless beam."""
        return 0.0 if self.massless else self.density * self.width * self.thickness


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
class Clamp:
    """A clamp that yields: ``stiffness`` in N m/rad against being turned."""

    stiffness: float


@dataclass(frozen=True)
class Gravity:
    """Weight, ``acceleration`` in m/s². ``"hanging"``: the clamp is above, the beam's axis vertical; ``"standing"``: it
    is below; ``"transverse"``: the axis is level and the weight draws toward the stop (away from it if negative).
    """

    direction: Literal["hanging", "standing", "transverse"]
    acceleration: float = 9.80665


@dataclass(frozen=True)
class Torsion:
    """The strip twists: the contact lies ``eccentricity`` m off its axis; ``shear_modulus`` in Pa.

    ``polar_inertia``: the attached mass's about the beam's axis, kg m².
    """

    eccentricity: float
    shear_modulus: float
    polar_inertia: float


@dataclass(frozen=True)
class Stop:
    """A one-sided stop ``gap`` m from the contact point at ``position`` m along the beam.

    ``gap_at``: where the gap was measured, at the contact or, as grazing amplitude, at the sensor (it is then carried
    to the contact by the static mode). ``restitution_of``: whose coefficient ``restitution`` is, the contact's or the
    first mode's (each fidelity's contact value is then derived so that mode 1 sees it); None where the law says the
    loss otherwise. ``law``: None is constant restitution; see ``contact`` and ``compliant`` for the others and what
    they take: ``stiffness`` (N/m) and ``damping`` (N s/m) of a linear stop, ``hertz_stiffness`` (N/m^exponent),
    ``exponent``, ``velocity`` (m/s), ``speeds`` (m/s) and ``restitutions``. ``second_gap`` (m): to a second stop on the
    other side. ``drift`` (m): added to the gap at ``drift_frequency`` (Hz), linear between. ``wear`` (m): added to the
    gap at the contact by each impact.
    """

    position: float
    gap: float
    restitution: float | None = None
    gap_at: Literal["contact", "sensor"] = "contact"
    restitution_of: Literal["contact", "first mode"] = "contact"
    law: Literal["restitution", "velocity restitution", "linear", "hertz", "hunt-crossley"] | None = None
    stiffness: float | None = None
    damping: float | None = None
    hertz_stiffness: float | None = None
    exponent: float | None = None
    velocity: float | None = None
    speeds: tuple[float, ...] | None = None
    restitutions: tuple[float, ...] | None = None
    second_gap: float | None = None
    drift_frequency: tuple[float, ...] | None = None
    drift: tuple[float, ...] | None = None
    wear: float | None = None

    @property
    def usual_restitution(self) -> float:
        """The restitution, or 1 where the law says the loss otherwise: for tables that compare coefficients."""
        return 1.0 if self.restitution is None else self.restitution


@dataclass(frozen=True)
class Sensor:
    """Where the displacement is measured, m from the clamp."""

    position: float


@dataclass(frozen=True)
class Base:
    """The base motion b(t) = amplitude · sin Ωt, either given (``amplitude``, m) or as ``voltage`` (V) times ``gain`` γ
    (1/V, eq. 46 of the paper: amplitude = γ V φ(L_m) L, with φ of the massless beam).

    On a platform it may be the ``force`` (N) on that instead, or the ``voltage`` alone of its shaker.
    """

    amplitude: float | None = None
    voltage: float | None = None
    gain: float | None = None
    force: float | None = None


@dataclass(frozen=True)
class Platform:
    """What the clamp and the stop stand on, sprung and shaken: kg, N/m.

    ``damping_ratio`` and natural frequency are those of the platform without the beam. ``coupling``: ``"one-way"``
    filters the drive, ``"two-way"`` lets the beam push back. ``calibrated_at`` (rad/s): where the base's amplitude, or
    voltage and gain, hold; None where the drive is a force or a shaker's voltage.
    """

    mass: float
    stiffness: float
    damping_ratio: float
    coupling: Literal["one-way", "two-way"]
    calibrated_at: float | None = None


@dataclass(frozen=True)
class Shaker:
    """A voltage-driven electrodynamic exciter on the platform: ohm, N/A (its Bl), H."""

    resistance: float
    force_factor: float
    inductance: float = 0.0


@dataclass(frozen=True)
class Scene:
    """A cantilever with an attached mass (None: a bare beam), a stop, a sensor and a shaken base."""

    beam: Beam
    mass: Mass | None
    stop: Stop
    sensor: Sensor
    base: Base
    added_masses: tuple[AddedMass, ...] = ()
    clamp: Clamp | None = None
    gravity: Gravity | None = None
    torsion: Torsion | None = None
    platform: Platform | None = None
    shaker: Shaker | None = None

    @property
    def moving_mass(self) -> float:
        """What the base carries, in kg: the beam with all that is on it."""
        return self.beam.mass_per_length * self.beam.length + sum(mass for mass, _ in self.weights)

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """(mass in kg, position in m) of everything attached."""
        attached = () if self.mass is None else (self.mass,)
        return tuple((each.mass, each.position) for each in (*attached, *self.added_masses))


@dataclass(frozen=True)
class SdofScene:
    """The single-degree-of-freedom model given directly (the paper's §2): q̈ + 2ζω q̇ + ω² q = Ω² B sin Ωt, q ≤ gap.

    ``natural_frequency`` in rad/s (1: the nondimensional model), ``gap`` and ``amplitude`` (B) in the unit of q.
    ``restitution`` is 1 where the stop's law says the loss otherwise. ``stop``: what the stop does beyond one
    coefficient of restitution, in these units and per unit of mass (its position means nothing); None: nothing.
    """

    natural_frequency: float
    damping_ratio: float
    gap: float
    restitution: float
    amplitude: float
    stop: Stop | None = None
