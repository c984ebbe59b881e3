"""Scene: the rig as frozen data in SI units, with what every kind of scene says of itself, and its effects."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, replace
from functools import reduce
from math import nan
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam
from vibeam_models.keys import keys_of, quantity, word
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam_models.outputs import Output
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure


class AnyScene(ABC):
    """Scene of any kind: what each says of itself, so that nobody need ask which kind it is."""

    stop: Stop | None
    outputs: tuple[Output, ...] = ()

    @property
    def harmonics(self) -> tuple[tuple[int, float, float], ...]:
        """Order, share and phase of every further harmonic of the drive, as ``Base.harmonics``."""
        rig: Any = self
        found: tuple[tuple[int, float, float], ...] = rig.base.harmonics
        return found

    @property
    @abstractmethod
    def held(self) -> tuple[str, float]:
        """Owner of the coefficient of restitution that the scene gives (empty: its one mode), and its value."""

    @property
    def natural_unit(self) -> float | None:
        """Frequency in rad/s that a scene without dimensions counts by; None: it has SI units."""
        return None

    @property
    def given_mode(self) -> tuple[float, float] | None:
        """ω (rad/s) and ζ of the one mode that the scene is; None: its structure is reduced as a fidelity asks."""
        return None

    @property
    def no_beam(self) -> str:
        """Reason that there is no beam to speak of, as the end of a sentence; empty where there is one."""
        return ""

    @property
    def spatial(self) -> str:
        """Module that knows the body of which its structure is: of three-dimensional elasticity; empty of any other.

        It has ``solid_shapes``, ``solid_system`` and the files of reduced bodies: ``place_of``, ``keep``, ``kept``.
        """
        return ""

    @property
    def in_three_dimensions(self) -> bool:
        """Test whether its structure is a body of three-dimensional elasticity."""
        return bool(self.spatial)

    @property
    def assumed(self) -> tuple[str, ...]:
        """Sentences about what its structure assumes where the case says nothing."""
        return ()

    @property
    def bulk(self) -> tuple[tuple[float, ...], float, float]:
        """Lengths of the beam in m, its length first; its mass and the moving mass in kg. Empty, NaN: not known."""
        return (), nan, nan

    def named(self, name: str) -> tuple[Any, ...]:
        """The effects of a name, in their order; empty where there is none."""
        return ()

    def without(self, *names: str) -> Any:
        """The scene less the effects of these names."""
        return self

    @property
    def platform(self) -> Any:
        """Platform under clamp and stop (``effects.platform``); None: the base motion is prescribed."""
        return next(iter(self.named("platform")), None)

    @property
    def shaker(self) -> Any:
        """The exciter on the platform (``effects.platform``); None: the force is prescribed."""
        return next(iter(self.named("shaker")), None)


class RigScene(AnyScene):
    """A scene in SI units with a stop and effects, which is reduced as a fidelity asks."""

    stop: Stop
    base: Base
    effects: tuple[Effect, ...]

    @property
    def held(self) -> tuple[str, float]:
        """As ``AnyScene.held``."""
        return self.stop.restitution_of, self.stop.usual_restitution

    @property
    @abstractmethod
    def moving_mass(self) -> float:
        """Mass carried by the base in kg."""

    @property
    def all_modes(self) -> bool:
        """Test whether the structure has all of the modes that its contact moves, and not a few that are known."""
        return True

    @abstractmethod
    def structural(self) -> Any:
        """The scene less what its structure does not depend on: equal ones have the same structure."""

    def named(self, name: str) -> tuple[Any, ...]:
        """As ``AnyScene.named``."""
        return tuple(effect for effect in self.effects if effect.name == name)

    def without(self, *names: str) -> Any:
        """As ``AnyScene.without``."""
        made: Any = self
        return replace(made, effects=tuple(effect for effect in self.effects if effect.name not in names))


@dataclass(frozen=True)
class Effect:
    """An optional table of a case: its docstring is the table's, its fields are the keys (``vibeam_models.keys``).

    With a ``name`` such as ``"mass.rotary_inertia"`` it is one optional key of [beam] or [mass], its only field,
    declared in ``EFFECTS``.
    ``inertias``: how many coordinates with inertia it brings to a massless beam; ``modes_per_element``: how many modes
    each finite element gains. ``shapes_beam``: part of what the beam is, in the SDOF model too.
    """

    name: ClassVar[str]
    inertias: ClassVar[int] = 0
    modes_per_element: ClassVar[int] = 0
    shapes_beam: ClassVar[bool] = False

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """(key, message) of what does not go together; the key is empty where it is the whole table.

        ``table`` (that in which its key is) and ``case`` have a case's values as attributes, None what is absent or
        cannot be read.
        """
        yield from ()

    @property
    def carried_by(self) -> str:
        """Beam that it is of: ``"beam"``, or the ``"opposite"`` one."""
        return "beam"

    def carrier(self, beam: Beam) -> Beam:
        """The beam that carries all else, from that which the scene has."""
        return beam

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """(mass in kg, position in m) of what it attaches to the beam."""
        return ()

    @property
    def rigid_zones(self) -> tuple[tuple[float, float], ...]:
        """(position, half-width) in m of where it keeps the beam from bending: both ends and the middle are nodes."""
        return ()

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """The structure with this effect, and the space that its coordinates belong to."""
        return structure, space


@dataclass(frozen=True)
class OnEitherBeam(Effect):
    """Effect that may be on the opposite beam too: ``on`` says which."""

    _: KW_ONLY
    on: Literal["beam", "opposite"] = word(("beam", "opposite"), "which beam it is of", "opposite", "beam")

    @property
    def carried_by(self) -> str:
        """As ``Effect.carried_by``."""
        return self.on


@dataclass(frozen=True)
class Mass:
    """The mass attached to the beam; absent = a bare beam."""

    mass: float = quantity("kg", "attached mass", "0.2 kg", above=0)
    position: float = quantity("m", "distance from x = 0, in (0, length]", "132 mm", above=0)


@dataclass(frozen=True)
class Sensor:
    """The sensor of the displacement."""

    position: float = quantity("m", "distance from x = 0, in (0, length]", "100 mm", above=0)


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


def line_of(scene: AnyScene) -> Scene | None:
    """The scene where its structure is a beam's line, whose elements can be refined; None of a solid, of matrices."""
    return scene if isinstance(scene, Scene) and not scene.in_three_dimensions else None


def _carried(beam: Beam, effects: tuple[Effect, ...]) -> Beam:
    return reduce(lambda carried, effect: effect.carrier(carried), effects, beam)
