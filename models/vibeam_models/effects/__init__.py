"""Optional effects by chapter, each declared once and imported only where a scene names it."""

from __future__ import annotations

from vibeam_models.beams.beam import PAIRS
from vibeam_models.keys import Key
from vibeam_models.registry import Home, Registry

#: by the case file's table, or its key in another table, in the order in which they are applied
EFFECTS: Registry[Home] = Registry(
    "effect",
    Home(
        "beam.ends",
        "vibeam_models.effects.supports:BeamEnds",
        key=Key(
            "how the ends are held, at x = 0 and at the full length; free-free: not at all; absent = clamped-free",
            "clamped-pinned",
            words=PAIRS,
        ),
    ),
    Home(
        "beam.added_mass_per_length",
        "vibeam_models.effects.sections:AddedMassPerLength",
        key=Key("carried all along without stiffening: a fluid, a cladding", "0.2 kg/m", "kg/m", above=0),
    ),
    Home(
        "beam.theory",
        "vibeam_models.effects.sections:Theory",
        key=Key(
            "shear deformation and rotary inertia of the section; absent = Euler-Bernoulli",
            "timoshenko",
            words=("timoshenko",),
        ),
    ),
    Home("section", "vibeam_models.effects.sections:Section", repeated=True),
    Home("plate", "vibeam_models.effects.sections:BondedPlate", repeated=True),
    Home("support", "vibeam_models.effects.supports:FurtherSupport", repeated=True),
    Home("clamp", "vibeam_models.effects.supports:Clamp"),
    Home("added_mass", "vibeam_models.effects.masses:AddedMass", repeated=True),
    Home(
        "mass.rotary_inertia",
        "vibeam_models.effects.masses:RotaryInertia",
        key=Key(
            "moment of inertia about the axis of bending; absent = a point mass", "2.988e-5 kg m^2", "kg m^2", above=0
        ),
    ),
    Home(
        "mass.rigid_half_width",
        "vibeam_models.effects.masses:RigidZone",
        key=Key("the beam is rigid this far on either side of the mass; absent = nowhere", "11.7 mm", "m", above=0),
    ),
    Home("further_stop", "vibeam_models.effects.further_stop:FurtherStop", repeated=True),
    Home("opposite", "vibeam_models.effects.opposite:Opposite"),
    Home("leaf", "vibeam_models.effects.leaf:Leaf", part_of="opposite"),
    Home("torsion", "vibeam_models.effects.torsion:Torsion"),
    Home("gravity", "vibeam_models.effects.gravity:Gravity"),
    Home(
        "beam.massless",
        "vibeam_models.effects.masses:MasslessBeam",
        key=Key("the beam's own mass is neglected, as in the paper's m ≫ ρAL", True, flag=True),
    ),
    Home("platform", "vibeam_models.effects.platform:Platform", on="base"),
    Home("shaker", "vibeam_models.effects.platform:Shaker", on="base"),
)

LAST = "beam.massless"  # it condenses what all others have left


def tables() -> dict[str, Home]:
    """The effects that have a table of their own."""
    return {name: home for name, home in EFFECTS.items() if "." not in name}


def parts_of(table: str) -> list[str]:
    """The tables of effects that go with another one."""
    return [name for name, home in EFFECTS.items() if home.part_of == table]


def keys_in(table: str) -> dict[str, Key]:
    """The keys of a table that are effects."""
    homes = {name.rpartition("."): home for name, home in EFFECTS.items()}
    return {key: home.key for (above, _, key), home in homes.items() if home.key and above == table}
