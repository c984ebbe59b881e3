"""Optional effects, one a file, each declared once and imported only where a scene names it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from vibeam_models.homes import Home
from vibeam_models.keys import Key
from vibeam_models.registry import Registry

if TYPE_CHECKING:
    from vibeam_models.scene import Beam, Scene
    from vibeam_models.space import BeamSpace
    from vibeam_models.structure import Structure

#: by the case file's table, or its key in another table, in the order in which they are applied
EFFECTS: Registry[Home] = Registry(
    "effect",
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
    each finite element gains. ``on_bare_beam``: applied before mass, stop and sensor are there, as it changes the
    beam's support.
    """

    name: ClassVar[str]
    inertias: ClassVar[int] = 0
    modes_per_element: ClassVar[int] = 0
    on_bare_beam: ClassVar[bool] = False

    @classmethod
    def faults(cls, table: Any, case: Any) -> Iterator[tuple[str, str]]:
        """(key, message) of what does not go together; the key is empty where it is the whole table.

        ``table`` (that in which its key is) and ``case`` have a case's values as attributes, None what is absent or
        cannot be read.
        """
        yield from ()

    def carrier(self, beam: Beam) -> Beam:
        """The beam that carries all else, from that which the scene has."""
        return beam

    @property
    def weights(self) -> tuple[tuple[float, float], ...]:
        """(mass in kg, position in m) of what it attaches to the beam."""
        return ()

    def apply(self, structure: Structure, space: BeamSpace, scene: Scene) -> tuple[Structure, BeamSpace]:
        """The structure with this effect, and the space that its coordinates belong to."""
        return structure, space
