"""Optional effects, one a file, each declared once and imported only where a scene names it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from vibeam_models.beams.support import PAIRS
from vibeam_models.homes import Home
from vibeam_models.keys import Key, word
from vibeam_models.registry import Registry

if TYPE_CHECKING:
    from vibeam_models.beams.beam import Beam
    from vibeam_models.scene import Scene
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure

#: by the case file's table, or its key in another table, in the order in which they are applied
EFFECTS: Registry[Home] = Registry(
    "effect",
    Home(
        "beam.ends",
        "vibeam_models.effects.beam_keys:Ends",
        key=Key(
            "how the ends are held, at x = 0 and at the full length; absent = clamped-free",
            "clamped-pinned",
            words=PAIRS,
            written=False,
        ),
    ),
    Home(
        "beam.added_mass_per_length",
        "vibeam_models.effects.beam_keys:AddedMassPerLength",
        key=Key(
            "carried all along without stiffening: a fluid, a cladding", "0.2 kg/m", "kg/m", above=0, written=False
        ),
    ),
    Home(
        "beam.theory",
        "vibeam_models.effects.beam_keys:Theory",
        key=Key(
            "shear deformation and rotary inertia of the section; absent = Euler-Bernoulli",
            "timoshenko",
            words=("timoshenko",),
            written=False,
        ),
    ),
    Home("section", "vibeam_models.effects.section:Section", repeated=True),
    Home("plate", "vibeam_models.effects.plate:BondedPlate", repeated=True),
    Home("support", "vibeam_models.effects.support:Support", repeated=True),
    Home("clamp", "vibeam_models.effects.sprung_clamp:Clamp"),
    Home("added_mass", "vibeam_models.effects.added_mass:AddedMass", repeated=True),
    Home(
        "mass.rotary_inertia",
        "vibeam_models.effects.rotary_inertia:RotaryInertia",
        key=Key(
            "moment of inertia about the axis of bending; absent = a point mass", "2.988e-5 kg m^2", "kg m^2", above=0
        ),
    ),
    Home(
        "mass.rigid_half_width",
        "vibeam_models.effects.rigid_zone:RigidZone",
        key=Key("the beam is rigid this far on either side of the mass; absent = nowhere", "11.7 mm", "m", above=0),
    ),
    Home("further_stop", "vibeam_models.effects.further_stop:FurtherStop", repeated=True),
    Home("opposite", "vibeam_models.effects.opposite:Opposite"),
    Home("torsion", "vibeam_models.effects.torsion:Torsion"),
    Home("gravity", "vibeam_models.effects.gravity:Gravity"),
    Home(
        "beam.massless",
        "vibeam_models.effects.massless_beam:MasslessBeam",
        key=Key("the beam's own mass is neglected, as in the paper's m ≫ ρAL", True, flag=True, written=False),
    ),
    Home("platform", "vibeam_models.effects.platform:Platform", on="base"),
    Home("shaker", "vibeam_models.effects.platform:Shaker", on="base"),
)

LAST = "beam.massless"  # it condenses what all others have left


def tables() -> dict[str, Home]:
    """The effects that have a table of their own."""
    return {name: home for name, home in EFFECTS.items() if "." not in name}


def keys_in(table: str) -> dict[str, Key]:
    """The keys of a table that are effects."""
    homes = {name.rpartition("."): home for name, home in EFFECTS.items()}
    return {key: home.key for (above, _, key), home in homes.items() if home.key and above == table}


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
        """Which beam it is of: ``"beam"``, or the ``"opposite"`` one."""
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
    """What may be on the opposite beam too: ``on`` says which."""

    _: KW_ONLY
    on: Literal["beam", "opposite"] = word(("beam", "opposite"), "which beam it is of", "opposite", "beam")

    @property
    def carried_by(self) -> str:
        """As ``Effect.carried_by``."""
        return self.on
