"""Table [solid]: the rig as a three-dimensional body, meshed or by a mesh of the user's own, and what it may hold."""

from __future__ import annotations

from typing import Any

from vibeam.casefile.field_tables import by_name
from vibeam.casefile.fields import TEXT, Each, Entry, Several, ValueEntry, Word
from vibeam.casefile.quantities import LENGTH, UnitSystem, to_si
from vibeam.casefile.tables.declared import Table, key, table
from vibeam.casefile.tables.table import Length, Ratio, declared_key, plan_keys
from vibeam.exchange.faults import as_shown_in_message, suggest
from vibeam.extensions.solid.elasticity.plan import SURFACE_DIRECTIONS, GroupMass, GroupMaterial, Solid
from vibeam_models.keys import keys_of

SURFACE = '"GROUP" | { group = "GROUP", direction = "z" }'


def _surface(value: Any) -> dict[str, str] | None:
    said = {"group": value} if isinstance(value, str) else value
    if not isinstance(said, dict):
        return None
    for name, each in said.items():
        if name not in ("group", "direction"):
            raise ValueError(f"unknown key {as_shown_in_message(name)}; {suggest(str(name), ('group', 'direction'))}")
        if not isinstance(each, str) or not each:
            raise ValueError(f"{name} must be text in quotes, not {as_shown_in_message(each)}")
    if "group" not in said:
        raise ValueError("group is missing: it names one of the mesh's groups")
    if said.get("direction", "normal") not in SURFACE_DIRECTIONS:
        known = Word(SURFACE_DIRECTIONS).describe()
        raise ValueError(f"direction must be one of {known}, not {as_shown_in_message(said['direction'])}")
    return dict(said)


#: a surface of a mesh by its group, and the direction in which it is read
SURFACE_MOTION = ValueEntry(_surface, SURFACE, {"anyOf": [{"type": "string"}, {"type": "object"}]})


SIZE = Several(Length)


class PatchEntry(Entry):
    """The contact: length and width of a patch in m, or a surface of a mesh."""

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``: two numbers, or a table."""
        if not isinstance(value, list):
            return SURFACE_MOTION.read(value, units)
        return SIZE.read(value, units)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"{SIZE.describe()} | with a mesh {SURFACE}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"anyOf": [SIZE.schema(), SURFACE_MOTION.schema()]}


def _length_unit(value: Any) -> str | None:
    if not isinstance(value, str):
        return None
    to_si(f"1 {value}", LENGTH)
    return value


LENGTH_UNIT = ValueEntry(_length_unit, "unit of a length", {"type": "string"})

_BODY = {name: declared_key(each, None) for name, each in keys_of(Solid).items()}
_BODY["contact"] = key(
    PatchEntry(),
    f"{keys_of(Solid)['contact'].meaning}; of a mesh the group of facets that meets the stop, absent = the group "
    "contact, read along its outward normal",
    ["6 mm", "20 mm"],
    None,
)
_BODY["clamp"] = key(
    Each(TEXT, alone=True, called="groups"),
    f"{keys_of(Solid)['clamp'].meaning}; of a mesh the groups that are held in all directions, absent = the group "
    "clamp",
    "held",
    None,
)

MaterialTable = table("GroupMaterialTable", GroupMaterial.__doc__, plan_keys(GroupMaterial))
GroupMassTable = table("GroupMassTable", GroupMass.__doc__, plan_keys(GroupMass))


class _Mesh(Table):
    mesh = key(
        TEXT,
        "file of a mesh of your own (Gmsh, Abaqus, CalculiX, Nastran, VTK, VTU, MED, Medit): beside [beam] what "
        "fidelities of a solid fly in place of the beam with all that is on it, without [beam] the whole rig",
        "rig.msh",
        None,
    )
    mesh_unit = key(LENGTH_UNIT, "unit of its coordinates", "mm", None)
    extent = key(Length, "of a mesh its longest side as you know it, to check mesh_unit by", "180 mm", None)
    merge = key(
        Length, "of a mesh: nodes nearer than this become one, of bodies that touch; absent = none", "1 µm", None
    )
    sensor = key(
        SURFACE_MOTION,
        "of a mesh the group whose mean the sensor reads, absent = the contact; along the contact's direction unless "
        "it says another",
        "sensor",
        None,
    )
    outputs = key(by_name(SURFACE_MOTION, SURFACE), "of a mesh further outputs, each a group", {"tip": "end"}, None)
    opposite = key(
        SURFACE_MOTION, "of a mesh of two bodies the group of the second that the contact meets", "anvil", None
    )
    base = key(
        Word(SURFACE_DIRECTIONS[1:]),
        "of a mesh the direction in which the base moves; absent = that of the contact",
        "z",
        None,
    )
    force = key(SURFACE_MOTION, "of a mesh the group on which drive.force acts", "load", None)
    symmetry = key(TEXT, "of a mesh of one half the group of facets in the plane of symmetry", "middle", None)
    damping_ratio = key(Several(Ratio, alone=True), "of a mesh without [beam], as beam.damping_ratio", 0.01, None)
    damping = key(
        Several(Ratio, words=("constant", "stiffness", "rayleigh")),
        "of a mesh without [beam], as beam.damping; absent = constant",
        "constant",
        None,
    )
    material = key(
        MaterialTable,
        "materials of a mesh, each of a group; absent = the beam's",
        [{"youngs_modulus": "210 GPa", "density": "7850 kg/m^3"}],
        (),
        many=tuple,
    )
    mass = key(GroupMassTable, "masses on a mesh's groups", [{"group": "block", "mass": "0.2 kg"}], (), many=tuple)


OF_MESH = tuple(name for name in _Mesh.KEYS if name not in ("mesh", "damping", "damping_ratio"))
OF_BODY = tuple(name for name in _BODY if name not in ("contact", "clamp"))

SolidTable = table(
    "SolidTable",
    'The rig as a three-dimensional body, which fidelities with model = "solid" fly: meshed, or a mesh of your own.',
    _BODY,
    _Mesh,
)
