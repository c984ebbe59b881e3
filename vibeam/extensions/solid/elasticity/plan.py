"""Solid: what a case says of the three-dimensional model of its rig; OwnMesh: the same of a mesh of the user's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from vibeam_models.beams.beam import Damping
from vibeam_models.keys import count, flag, quantity, text, word

MOST = 2000  # elements in any direction
CLAMPS = ("held", "sliding")
STUBBY = 30  # heights: constant shear across (κ = 1) raises f₃ of a cantilever by 0.2 % there, in proportion to 1/L²


@dataclass(frozen=True, kw_only=True)
class Solid:
    """The body that fidelities with model = "solid" have in place of the beam's line: mesh, contact, mass, clamp.

    ``along`` None: as many elements as the beam has; ``through`` None: two where shear across counts, else one;
    ``contact`` and ``mass_size`` in m, None: as their keys say; ``whole`` None: half of the body wherever rig and
    contact are symmetric about the plane of bending.
    """

    along: int | None = count(1, MOST, "finite elements along the beam; absent = beam.elements", 60, None)
    across: int = count(1, MOST, "elements over the width, of a round section around a quarter; absent = 4", 4, 4)
    through: int | None = count(
        1,
        MOST,
        "finite elements through each layer, a plate or the beam; absent = 2 in a beam with flat faces that is shorter "
        f"than {STUBBY} of its heights, else 1",
        2,
        None,
    )
    contact: tuple[float, ...] | None = quantity(
        "m",
        "length and width of the patch that the stop meets, half of it at the tip; absent = as long as "
        "the section is high, as wide as it, with [torsion] as wide as it is high",
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
        "held: a clamped end is held in all directions, as where it is absent; sliding: along the beam, and as a "
        "whole, free to contract across",
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
    """The mean displacement over a named group of a mesh in one of ``SURFACE_DIRECTIONS``.

    ``direction`` None: of the contact its outward normal, of all others that of the contact.
    """

    group: str
    direction: str | None = None


@dataclass(frozen=True, kw_only=True)
class GroupMaterial:
    """Material of a group of elements; absent: of all that no other has."""

    group: str | None = text("group of elements; absent = all that no other material has", "strip", None)
    youngs_modulus: float = quantity("Pa", "modulus of elasticity", "210 GPa", above=0)
    density: float = quantity("kg/m^3", "mass per volume", "7850 kg/m^3", above=0)
    poissons_ratio: float | None = quantity("", "absent = by the modulus, which is said", 0.3, None, least=0, most=0.49)


@dataclass(frozen=True, kw_only=True)
class GroupMass:
    """A mass on a group: the group moves as a rigid body, or else the mass with the group's mean."""

    group: str = text("group of facets, nodes or elements", "block")
    mass: float = quantity("kg", "mass of it", "0.2 kg", above=0)
    rotary_inertia: float | None = quantity(
        "kg m^2", "about every axis through the group's middle; absent = none", "1e-5 kg m^2", None, above=0
    )
    rigid: bool = flag("the group moves as a rigid body; false: the mass moves with the group's mean", True, True)


@dataclass(frozen=True, kw_only=True)
class OwnMesh:
    """A mesh of the user's own in place of a beam: ``file`` with coordinates in ``unit`` m, what its groups are.

    ``clamp``: groups held in all directions. ``sensor`` None: the contact. ``opposite``: face of a second body, which
    the contact meets. ``base``: direction in which the base moves, None that of the contact; ``force``: where a force
    drives instead. ``symmetry``: group in the plane about which the mesh is one half. ``extent``: its longest side in m
    as the user knows it; ``merge``: nodes nearer than this, in m, become one.
    """

    file: str
    unit: float
    materials: tuple[GroupMaterial, ...]
    clamp: tuple[str, ...]
    contact: SurfaceMotion
    sensor: SurfaceMotion | None = None
    opposite: SurfaceMotion | None = None
    outputs: Mapping[str, SurfaceMotion] = field(default_factory=dict)
    base: str | None = None
    force: SurfaceMotion | None = None
    symmetry: str | None = None
    masses: tuple[GroupMass, ...] = ()
    extent: float | None = None
    merge: float | None = None
    damping: Damping | None = None
