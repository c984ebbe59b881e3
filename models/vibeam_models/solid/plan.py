"""Solid: what a case says of the three-dimensional model of its rig; OwnMesh: the same of a mesh of the user's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from vibeam_models.beams.beam import Damping
from vibeam_models.keys import count, flag, quantity, word

MOST = 2000  # elements in any direction
CLAMPS = ("held", "sliding")


@dataclass(frozen=True, kw_only=True)
class Solid:
    """The body that fidelities with model = "solid" have in place of the beam's line: mesh, contact, mass, clamp.

    ``along`` None: as many elements as the beam has; ``contact`` and ``mass_size`` in m, None: as their keys say;
    ``whole`` None: half of the body wherever rig and contact are symmetric about the plane of bending.
    """

    along: int | None = count(1, MOST, "finite elements along the beam; absent = beam.elements", 60, None)
    across: int = count(1, MOST, "finite elements over the width; of a round section around a quarter of it", 4, 4)
    through: int = count(1, MOST, "finite elements through the thickness of each layer, a plate or the beam", 1, 1)
    contact: tuple[float, ...] | None = quantity(
        "m",
        "length along the beam and width of the patch that the stop meets; absent = as long as the section is high, "
        "as wide as it, with [torsion] as wide as it is high",
        ["6 mm", "20 mm"],
        None,
        above=0,
        several=True,
    )
    mass_size: tuple[float, ...] | None = quantity(
        "m",
        "length, width and height of the mass, a block bonded on each side; absent = a rigid zone where [mass] has "
        "one, else a mass spread over the section",
        ["22 mm", "30 mm", "20 mm"],
        None,
        above=0,
        several=True,
    )
    mass_youngs_modulus: float | None = quantity(
        "Pa", "modulus of elasticity of these blocks; absent = the beam's", "70 GPa", None, above=0, of="mass_size"
    )
    clamp: Literal["held", "sliding"] = word(
        CLAMPS,
        "held: a clamped end is held in all directions; sliding: along the beam, and as a whole, free to contract "
        "across",
        "held",
        "held",
    )
    whole: bool | None = flag(
        "the whole body in any case, lateral bending and twist too; absent = half of it wherever all is symmetric",
        True,
        None,
    )


#: of a surface's motion: along its outward normal, or along an axis of the mesh
SURFACE_DIRECTIONS = ("normal", "x", "y", "z", "-x", "-y", "-z")


@dataclass(frozen=True)
class SurfaceMotion:
    """The mean displacement over a named group of a mesh in one of ``SURFACE_DIRECTIONS``."""

    group: str
    direction: str = "normal"


@dataclass(frozen=True)
class GroupMaterial:
    """Material of a group of elements, empty: of all that no other has; ``poissons_ratio`` None: by the modulus."""

    group: str
    youngs_modulus: float
    density: float
    poissons_ratio: float | None = None


@dataclass(frozen=True)
class GroupMass:
    """A mass in kg spread over a group: its nodes move as a rigid body where ``rigid``."""

    group: str
    mass: float
    rigid: bool = False


@dataclass(frozen=True, kw_only=True)
class OwnMesh:
    """A mesh of the user's own in place of a beam: ``file`` with coordinates in ``unit`` m, what its groups are.

    ``clamp``: groups held in all directions. ``sensor`` None: the contact. ``base``: axis along which the base moves;
    ``force``: where a force drives instead.
    """

    file: str
    unit: float
    materials: tuple[GroupMaterial, ...]
    clamp: tuple[str, ...]
    contact: SurfaceMotion
    sensor: SurfaceMotion | None = None
    outputs: Mapping[str, SurfaceMotion] = field(default_factory=dict)
    base: str | None = None
    force: SurfaceMotion | None = None
    masses: tuple[GroupMass, ...] = ()
    damping: Damping | None = None
