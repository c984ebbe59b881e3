"""Scene: the rig as frozen data in SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING, Any, Literal

from vibeam_models.keys import quantity

if TYPE_CHECKING:
    from vibeam_models.effects import Effect
    from vibeam_models.effects.platform import Platform, Shaker
    from vibeam_models.laws import ContactLaw


@dataclass(frozen=True)
class Damping:
    """Damping of the beam by modal ratios.

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
    """Attached mass in kg at a ``position`` in m."""

    mass: float
    position: float


@dataclass(frozen=True)
class Stop:
    """A one-sided stop ``gap`` m from the contact point at ``position`` m along the beam.

    ``gap_at``: where the gap was measured, at the contact or, as grazing amplitude, at the sensor (it is then carried
    to the contact by the static mode). ``restitution_of``: whose coefficient ``restitution`` is, the contact's or the
    first mode's (each fidelity's contact value is then derived so that mode 1 sees it); None where the law says the
    loss otherwise. ``law``: None is constant restitution. ``second_gap`` (m): to a second stop on the other side.
    ``drift`` (m): added to the gap at ``drift_frequency`` (Hz), linear between. ``wear`` (m): added to the gap at the
    contact by each impact.
    """

    position: float
    gap: float
    restitution: float | None = None
    gap_at: Literal["contact", "sensor"] = "contact"
    restitution_of: Literal["contact", "first mode"] = "contact"
    law: ContactLaw | None = None
    second_gap: float | None = quantity(
        "m",
        "gap to a second stop on the other side; absent = none",
        "1 mm",
        None,
        written=False,
        effect=True,
        plain=("gap to a second stop on the other side; absent = none", 0.01, ""),
    )
    drift_frequency: tuple[float, ...] | None = quantity(
        "Hz",
        "drive frequencies between which the gap drifts; absent = it stays",
        ["14 Hz", "17 Hz"],
        None,
        above=0,
        several=True,
        ascending=True,
        written=False,
        effect=True,
        plain=("drive frequencies between which the gap drifts; absent = it stays", ["1.5 rad/s", "2.5 rad/s"], ""),
    )
    drift: tuple[float, ...] | None = quantity(
        "m",
        "what is added to the gap at these frequencies, linear between them",
        ["0 mm", "0.02 mm"],
        None,
        several=True,
        written=False,
        of="drift_frequency",
        plain=("what is added to the gap at these frequencies, linear between them", [0.0, 1e-4], ""),
    )
    wear: float | None = quantity(
        "m",
        "what each impact adds to the gap at the contact, from point to point; absent = none",
        "0.1 nm",
        None,
        least=0,
        written=False,
        effect=True,
        plain=("what each impact adds to the gap, from point to point; absent = none", 1e-8, ""),
    )

    @property
    def usual_restitution(self) -> float:
        """The restitution, or 1 where the law says the loss otherwise: for tables that compare coefficients."""
        return 1.0 if self.restitution is None else self.restitution


@dataclass(frozen=True)
class Sensor:
    """Sensor of the displacement, ``position`` m from the clamp."""

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
class Scene:
    """A cantilever with an attached mass (None: a bare beam), a stop, a sensor, a shaken base, and its effects."""

    beam: Beam
    mass: Mass | None
    stop: Stop
    sensor: Sensor
    base: Base
    effects: tuple[Effect, ...] = ()

    def named(self, name: str) -> tuple[Any, ...]:
        """The effects of a name, in their order; empty where there is none."""
        return tuple(effect for effect in self.effects if effect.name == name)

    def without(self, *names: str) -> Scene:
        """The scene less the effects of these names."""
        return replace(self, effects=tuple(effect for effect in self.effects if effect.name not in names))

    @property
    def platform(self) -> Platform | None:
        """Platform under clamp and stop; None: the base motion is prescribed."""
        return next(iter(self.named("platform")), None)

    @property
    def shaker(self) -> Shaker | None:
        """The exciter on the platform; None: the force is prescribed."""
        return next(iter(self.named("shaker")), None)

    @property
    def moving_mass(self) -> float:
        """Mass carried by the base in kg: the beam with all that is on it."""
        return self.carrier.mass_per_length * self.beam.length + sum(mass for mass, _ in self.weights)

    @property
    def carrier(self) -> Beam:
        """The beam as its effects take it: massless, say."""
        return reduce(lambda beam, effect: effect.carrier(beam), self.effects, self.beam)

    @property
    def rigid_half_width(self) -> float:
        """Half-width of the rigid zone at the mass in m, 0 without one."""
        return sum((zone.rigid_half_width for zone in self.named("mass.rigid_half_width")), 0.0)

    def attached(self, effect: str) -> Mass:
        """The attached mass; ValueError that an effect needs one where there is none."""
        if self.mass is None:
            raise ValueError(f"{effect}: is of an attached mass, and the scene has none")
        return self.mass

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """(mass in kg, position in m) of everything attached, the mass first."""
        attached = () if self.mass is None else ((self.mass.mass, self.mass.position),)
        return (*attached, *(each for effect in self.effects for each in effect.weights))


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
