"""Files of meshes in every format, and damage to their bytes; as a script: what reading the damaged ones says.

``python damaged_meshes.py FOLDER FIRST COUNT FORMAT …`` reads the files FIRST … FIRST + COUNT − 1 of each format in
2 GiB of memory, and ends with an error for anything but a mesh, or faults in words.
"""

import random
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
from box_meshes import end_face, nodes_of

from vibeam.extensions.solid.elasticity.plan import GroupMaterial, OwnMesh, SurfaceMotion
from vibeam.extensions.solid.meshes.own import own_structure

ROOM = 2 << 30  # bytes
POINTS, CELLS = nodes_of("hexahedron")
FACES = [[0, 3, 7, 4], *end_face(POINTS, "hexahedron")[1]]  # clamp and tip


def _by_meshio(called: str, **how: bool) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        faces = [FACES] if called == "med" else [[each] for each in FACES]  # Gmsh: a block has one group
        tags = [np.array([9, 9]), np.array([1]), np.array([2])]
        names = {"clamp": np.array([1, 2]), "tip": np.array([2, 2])}
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags} if "gmsh" in called else {"region": tags}
        data = {"cell_tags": [np.array([-9, -9]), np.array([-1, -2])]} if called == "med" else data
        blocks = [("hexahedron", np.array(CELLS)), *(("quad", np.array(each)) for each in faces)]
        made = meshio.Mesh(POINTS, blocks, cell_data=data)
        on = [next((number for number, face in enumerate(FACES, 1) if at in face), 0) for at in range(len(POINTS))]
        entities = np.array([[2, each] if each else [3, 9] for each in on])
        made.point_data = {"gmsh:dim_tags": entities} if called == "gmsh" else {}
        made.field_data = names if "gmsh" in called else {}
        made.cell_tags = {-1: ["clamp"], -2: ["tip"], -9: ["body"]}
        made.write(path, file_format=called, **how)

    return write


def _deck(path: Path) -> None:
    lines = ["*NODE", *(f"{1 + at}, {x}, {y}, {z}" for at, (x, y, z) in enumerate(POINTS.tolist()))]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=body"]
    lines += [f"{1 + at}, {', '.join(str(1 + node) for node in cell)}" for at, cell in enumerate(CELLS)]
    lines += ["*ELSET, ELSET=both, GENERATE", "1, 2, 1", "*NSET, NSET=clamp", ", ".join(str(1 + at) for at in FACES[0])]
    path.write_text("\n".join([*lines, "*NSET, NSET=more", "clamp, 9", "*SURFACE, NAME=tip", "2, S4", ""]))


def _bulk(path: Path) -> None:
    lines = ["SOL 103", "CEND", "SET 4 = 1 THRU 3,", " 5", "BEGIN BULK"]
    lines += [f"GRID,{1 + at},,{x},{y},{z}" for at, (x, y, z) in enumerate(POINTS.tolist())]
    rows = [[str(1 + node) for node in cell] for cell in CELLS]
    lines += [f"CHEXA,{1 + at},3,{','.join(row[:6])}\n,{','.join(row[6:])}" for at, row in enumerate(rows)]
    lines += [f"CQUAD4,{8 + at},{1 + at},{','.join(str(1 + node) for node in face)}" for at, face in enumerate(FACES)]
    path.write_text("\n".join([*lines, "SPC1,1,123,1,THRU,4", "ENDDATA", ""]))


WRITERS: dict[str, Callable[[Path], None]] = {
    "abaqus.inp": _deck,
    "nastran.bdf": _bulk,
    "gmsh22.msh": _by_meshio("gmsh22", binary=False),
    "gmsh22_binary.msh": _by_meshio("gmsh22"),
    "gmsh41.msh": _by_meshio("gmsh", binary=False),
    "gmsh41_binary.msh": _by_meshio("gmsh"),
    "vtk42.vtk": _by_meshio("vtk42", binary=False),
    "vtk42_binary.vtk": _by_meshio("vtk42"),
    "vtk51.vtk": _by_meshio("vtk"),
    "text.vtu": _by_meshio("vtu", binary=False),
    "packed.vtu": _by_meshio("vtu"),
    "medit.mesh": _by_meshio("medit"),
    "salome.med": _by_meshio("med"),
}


def damaged(content: bytes, seed: int, same_size: bool) -> bytes:
    """The content with one to three faults: a byte changed, a number made large, odd or another's, a part out, cut."""
    chance = random.Random(seed)
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(max(1, len(content)))
        size = chance.choice((1, 1, 2, 4, 8, 40))
        new = chance.choice(
            (
                bytes([chance.randrange(256)]),
                chance.randbytes(size),
                chance.choice((b"9" * size, b"-1", b"1_0", "٣".encode(), b"nan", b"1e400", b" ", b"\n")),
                b"\xff" * size,
                b"",
                content[at : at + size] * 2,
            )
        )
        new = new[:size].ljust(size, b"\0") if same_size else new
        content = content[:at] + new + content[at + size :]
        content = content[:at] if chance.random() < 0.1 else content
    return content


def plan_of(name: str) -> OwnMesh:
    """A case that asks for groups which the whole files have."""
    groups = {"bdf": ("property 1", "property 2"), "vtk": ("region 1", "region 2"), "vtu": ("region 1", "region 2")}
    groups["mesh"] = ("medit:ref 1", "medit:ref 2")
    clamp, tip = groups.get(name.rpartition(".")[2], ("clamp", "tip"))
    steel = GroupMaterial(youngs_modulus=210e9, density=7850.0, poissons_ratio=0.3)
    return OwnMesh(file=name, unit=1e-3, materials=(steel,), clamp=(clamp,), contact=SurfaceMotion(tip, "x"))


def main(folder: str, first: str, count: str, *names: str) -> None:
    """Read so many damaged files of every format; print what is said of each, and how many still were a mesh."""
    warnings.simplefilter("error", RuntimeWarning)
    for name in names:
        path, sound = Path(folder) / name, 0
        WRITERS[name](path)
        content = path.read_bytes()
        faults = own_structure(plan_of(name), path.parent)[1]
        assert faults == (), faults
        for seed in range(int(first), int(first) + int(count)):
            path.write_bytes(damaged(content, seed, name.endswith(".med")))  # HDF5 knows its own size
            print(name, seed, flush=True)
            structure, faults = own_structure(plan_of(name), path.parent)
            sound += structure is not None
            assert all(message and "\n" not in message for _, message in faults), faults
            print(faults)
        print(f"{name}: {sound} of {count} sound")


if __name__ == "__main__":
    if sys.platform == "linux":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))
    main(*sys.argv[1:])
