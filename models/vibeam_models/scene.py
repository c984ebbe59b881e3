"""Scene: the rig as frozen data in SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from typing import TYPE_CHECKING

from vibeam_models.any_scene import AnyScene, RigScene
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam
from vibeam_models.keys import keys_of
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam_models.effects import Effect
    from vibeam_models.outputs import Output
    from vibeam_models.structure import Structure


@dataclass(frozen=True)
class Mass:
    """Attached mass in kg at a ``position`` in m."""

    mass: float
    position: float


@dataclass(frozen=True)
class Sensor:
    """Sensor of the displacement, ``position`` m from the clamp."""

    position: float


@dataclass(frozen=True)
class Scene(RigScene):
    """A cantilever with an attached mass (None: a bare beam), a stop, a sensor, a shaken base, its effects, and further
    outputs."""

    beam: Beam
    mass: Mass | None
    stop: Stop
    sensor: Sensor
    base: Base
    effects: tuple[Effect, ...] = ()
    outputs: tuple[Output, ...] = ()

    def structure(self) -> Structure:
        """As ``AnyScene.structure``: the finite elements with all effects on the beam."""
        from vibeam_models.beam import assemble

        return assemble(self)

    def structural(self) -> Scene:
        """As ``RigScene.structural``: of stop and drive their positions."""
        return replace(self, stop=Stop(self.stop.position, 0.0), base=self.base.place)

    @property
    def moving_mass(self) -> float:
        """Mass carried by the base in kg: the beam with all that is on it."""
        own = self.carrier.mass + sum(mass for mass, _ in self.weights)
        return own + sum((float(each.moving_mass(self)) for each in self.named("opposite")), 0.0)

    @property
    def bulk(self) -> tuple[tuple[float, ...], float, float]:
        """As ``AnyScene.bulk``."""
        shape = self.beam.shape
        across = (getattr(shape, name) for name, key in keys_of(type(shape)).items() if key.unit == "m")
        return (self.beam.length, *(float(each) for each in across)), self.carrier.mass, self.moving_mass

    def of(self, beam: str) -> tuple[Effect, ...]:
        """The effects of one beam: ``"beam"``, or the ``"opposite"`` one."""
        return tuple(effect for effect in self.effects if effect.carried_by == beam)

    @property
    def carrier(self) -> Beam:
        """The beam as its effects take it: massless, say."""
        return _carried(self.beam, self.of("beam"))

    @property
    def shaped_beam(self) -> Beam:
        """The beam with its sections, plates and supports, and no other effect."""
        return _carried(self.beam, tuple(effect for effect in self.of("beam") if effect.shapes_beam))

    @property
    def rigid_half_width(self) -> float:
        """Half-width of the rigid zone at the mass in m, 0 without one."""
        return sum((zone.rigid_half_width for zone in self.named("mass.rigid_half_width")), 0.0)

    @property
    def rigid_zones(self) -> tuple[tuple[float, float], ...]:
        """(position, half-width) in m of all rigid zones, that at the mass first."""
        own = () if self.mass is None else ((self.mass.position, self.rigid_half_width),)
        further = (zone for effect in self.of("beam") for zone in effect.rigid_zones)
        return tuple(zone for zone in (*own, *further) if zone[1] > 0)

    def attached(self, effect: str) -> Mass:
        """The attached mass; ValueError that an effect needs one where there is none."""
        if self.mass is None:
            raise ValueError(f"{effect}: is of an attached mass, and the scene has none")
        return self.mass

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """(mass in kg, position in m) of everything attached, the mass first."""
        attached = () if self.mass is None else ((self.mass.mass, self.mass.position),)
        return (*attached, *(each for effect in self.of("beam") for each in effect.weights))


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

    def structure(self) -> Structure:
        """As ``AnyScene.structure``: its one mode, mass-normalised."""
        import numpy as np

        from vibeam_models.structure import Structure

        one, zero = np.ones(1), np.zeros(1)
        omega, zeta = self.given_mode
        matrices = np.eye(1), np.full((1, 1), 2 * zeta * omega), np.full((1, 1), omega**2)
        return Structure(*matrices, load=-one, static=zero, contact=one, outputs={"sensor": one})


def _carried(beam: Beam, effects: tuple[Effect, ...]) -> Beam:
    return reduce(lambda carried, effect: effect.carrier(carried), effects, beam)
