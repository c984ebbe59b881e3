"""Files of meshes that would take all memory, never end, or be read in part: each is refused, or costs nothing."""

from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from box_meshes import nodes_of
from damaged_meshes import WRITERS, plan_of

from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.declaration import read_matrix
from vibeam.extensions.solid.meshes import declared
from vibeam.extensions.solid.meshes.abaqus import NAMED
from vibeam.extensions.solid.meshes.own import own_structure
from vibeam.extensions.solid.meshes.read import read_mesh

POINTS, CELLS = nodes_of("hexahedron")
NODES = "*NODE\n" + "\n".join(f"{1 + at}, {x}, {y}, {z}" for at, (x, y, z) in enumerate(POINTS.tolist()))
BOXES = "\n".join(f"{1 + at}, {', '.join(str(1 + node) for node in cell)}" for at, cell in enumerate(CELLS))
DECK = f"{NODES}\n*ELEMENT, TYPE=C3D8, ELSET=both\n{BOXES}\n"


def deck(folder: Path, more: str) -> Path:
    path = folder / "rig.inp"
    path.write_text(DECK + more)
    return path


def test_sets_that_name_themselves_and_each_other_cost_nothing(tmp_path: Path) -> None:
    itself = "*NSET, NSET=A\n1\n" + "A, a, A, A, A, A, A, A\n" * 8
    chain = "*NSET, NSET=S0\n1, 2\n" + "".join(f"*NSET, NSET=S{at}\n{f'S{at - 1}, ' * 11}\n" for at in range(1, 12))
    cells = "*ELSET, ELSET=E\nboth, both, 1\n" + "E, E, E, E, E, E, E, E\n" * 8
    groups = read_mesh(deck(tmp_path, itself + chain + cells)).groups
    assert (list(groups["A"].nodes), list(groups["S11"].nodes), list(groups["E"].cells)) == ([0], [0, 1], [0, 1])


def test_a_set_is_the_same_in_capitals_or_not(tmp_path: Path) -> None:
    groups = read_mesh(deck(tmp_path, "*NSET, NSET=Tip\n1\n*NSET, NSET=TIP\n2\n")).groups
    assert {name: list(group.nodes) for name, group in groups.items() if len(group.nodes)} == {"Tip": [0, 1]}


MANY = f"1, {NAMED // 4}\n"
TOO_MANY = f"its sets name more than {NAMED} nodes and elements: name fewer"


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (f"*NSET, NSET=A, GENERATE\n{MANY * 5}", f"line 17: \\*NSET: {TOO_MANY}"),
        (f"*ELSET, ELSET=A, GENERATE\n1, {NAMED + 1}\n", f"line 17: \\*ELSET: {TOO_MANY}"),
        ("*ELSET, ELSET=A, GENERATE\n1, 999999999999999, 1\n", TOO_MANY),
        (f"*ELSET, ELSET=A, GENERATE\n{MANY}*ELSET, ELSET=B\n{'A,' * 9}\n", f"line 19: \\*ELSET: {TOO_MANY}"),
        (f"*ELSET, ELSET=A, GENERATE\n{MANY}*SURFACE, NAME=B\n{'A, S1' * 1}\n" + "A, S1\n" * 9, TOO_MANY),
        ("*NSET, NSET=A, GENERATE\n1, 8, 0\n", "line 17: \\*NSET: range"),
        ("*NSET\n1\n", "line 17: \\*NSET: 'NSET'"),
        ("*NODE,\n" + "a,\n" * 9000, "line 17: has a keyword of more than 10000 characters"),
    ],
)
def test_a_deck_that_asks_for_too_much(more: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=message):
        read_mesh(deck(tmp_path, more))


def test_every_face_of_abaqus_has_its_nodes(tmp_path: Path) -> None:
    """Faces of the manual: S1 and S2 below and above, S3 to S6 around, from nodes 1-2 on."""
    sides = "".join(f"*SURFACE, NAME=side{face}\n1, S{face}\n" for face in range(1, 7))
    mesh = read_mesh(deck(tmp_path, sides))
    own = mesh.points[mesh.cells[0]]
    for face, (axis, high) in enumerate([(2, 0), (2, 1), (1, 0), (0, 1), (1, 1), (0, 0)], 1):
        found = mesh.points[mesh.groups[f"side{face}"].faces[0][0]]
        assert set(found[:, axis]) == {own[:, axis].max() if high else own[:, axis].min()}, face
    tetrahedra = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n"
    (tmp_path / "one.inp").write_text(tetrahedra + sides)
    mesh = read_mesh(tmp_path / "one.inp")
    left = [set(range(4)) - set(mesh.groups[f"side{face}"].faces[0][0].tolist()) for face in range(1, 5)]
    assert left == [{3}, {2}, {0}, {1}]  # S1 is 1-2-3, S2 is 1-4-2, S3 is 2-4-3, S4 is 3-4-1


BULK = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,1,9,1,2,3,4\n"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (BULK + "INCLUDE 'rest.bdf'\n", 6),
        (BULK + "include rest.bdf\n", 6),
        (BULK + "  Include 'a\n,b.bdf'\n", 6),
        (BULK + 'INCLUDE "a, b.bdf"\n', 6),
        ("SOL 103\ninclude 'case.dat'\nCEND\nBEGIN BULK\n" + BULK, 2),
        ("SOL 103\nCEND\nBEGIN BULK\n" + BULK + "INCLUDE='rest.bdf'\nENDDATA\n", 9),
        ("\tINCLUDE 'all.bdf'\n", 1),
    ],
)
def test_a_bulk_data_file_that_includes_another_is_refused(text: str, line: int, tmp_path: Path) -> None:
    (tmp_path / "rig.bdf").write_text(text)
    with pytest.raises(FormatError, match=f"line {line}: INCLUDE: another file is not read: put its lines into this"):
        read_mesh(tmp_path / "rig.bdf")


def test_an_include_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "rig.bdf").write_text(f"$ INCLUDE 'a.bdf'\n{BULK}$INCLUDE\nENDDATA\nINCLUDE 'behind the end'\n")
    assert len(read_mesh(tmp_path / "rig.bdf").cells) == 1


def test_a_matrix_that_includes_another_file_is_refused(tmp_path: Path) -> None:
    header = "DMIG    K              0       6       1\n"
    (tmp_path / "rig.pch").write_text(f"{header}DMIG    K             11       0              11       0     4.0\n")
    assert read_matrix(tmp_path / "rig.pch").matrix.toarray() == [[4.0]]
    (tmp_path / "half.pch").write_text(f"{header}INCLUDE 'rest.pch'\n")
    with pytest.raises(FormatError, match="line 2: INCLUDE: another file is not read"):
        read_matrix(tmp_path / "half.pch")


def test_sets_of_nastran(tmp_path: Path) -> None:
    control = "SET 1 = 1 THRU 3\nSET 2 = 4, 1,\n 2\nSET 3 = 1 THRU 4 EXCEPT 2\nSET 4 = 3 THRU 1, 2\nSET 5 = ALL\n"
    (tmp_path / "rig.bdf").write_text(f"{control}BEGIN BULK\n{BULK}SPC1,7,123,2,THRU,9\nSPC,8,1,123,0.0,4,1,0.0\n")
    groups = {name: group.nodes.tolist() for name, group in read_mesh(tmp_path / "rig.bdf").groups.items()}
    held = {"SPC 7": [1, 2, 3], "SPC 8": [0, 3]}
    assert groups == held | {"SET 1": [0, 1, 2], "SET 2": [0, 1, 3], "SET 4": [1], "property 9": []}


def test_many_spans_and_blank_lines_take_no_time(tmp_path: Path) -> None:
    """Ten thousand times ten thousand comparisons, were each span looked for by itself; blank lines, squared."""
    grids = "".join(f"GRID,{at},,{at}.,0.,0.\n" for at in range(5, 20_000))
    spans = "".join(f"SPC1,1,123,{at},THRU,{at + 1}\n" for at in range(1, 20_000, 2))
    (tmp_path / "rig.bdf").write_text("SET\n" + "\n" * 300_000 + "BEGIN BULK\n" + BULK + grids + spans)
    assert len(read_mesh(tmp_path / "rig.bdf").groups["SPC 1"].nodes) == 4


def test_nodes_that_no_cell_uses_are_counted(tmp_path: Path) -> None:
    WRITERS["abaqus.inp"](tmp_path / "abaqus.inp")
    plan = plan_of("abaqus.inp")
    structure, _ = own_structure(plan, tmp_path)
    assert structure is not None
    assert not any("nodes" in each for each in structure.assumed)
    text = (tmp_path / "abaqus.inp").read_text()
    (tmp_path / "abaqus.inp").write_text(text + "*NODE\n900, 0, 0, 99\n901, 0, 0, 98\n")
    assert read_mesh(tmp_path / "abaqus.inp").unused == 2
    structure, _ = own_structure(plan, tmp_path)
    assert structure is not None
    said = "abaqus.inp has 2 cells of 12 nodes; 2 further nodes of no cell of volume are left out"
    assert said in structure.assumed


MEDIT = "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
MEDIT += "Tetrahedra\n1\n1 2 3 4 1\nEnd"
MOST = "and a mesh may have 5000000 nodes or cells at most"
GRID = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
GMSH = "$MeshFormat\n{} 0 8\n$EndMeshFormat\n$Nodes\n{}\n$EndNodes\n$Elements\n{}\n$EndElements\n"
FOUR = "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n{} 0 0 1"
BLOCK = "1 4 1 4\n3 1 0 4\n1\n2\n3\n{}\n0 0 0\n1 0 0\n0 1 0\n0 0 1"
VAST = {
    "skip.mesh": (MEDIT.replace("End", "RequiredVertices\n1000000000\n1"), f"it says 1000000000, {MOST}"),
    "ridges.mesh": (MEDIT.replace("End", "Ridges 99999999"), f"it says 99999999, {MOST}"),
    "points.vtk": (
        GRID + "STRUCTURED_POINTS\nDIMENSIONS 400 400 400\nORIGIN 0 0 0\nSPACING 1 1 1\n",
        "it says 64000000, ",
    ),
    "lower.vtk": (GRID + "structured_grid\ndimensions 40000 40000 4\n", "it says 6400000000, "),
    "axes.vtk": (
        GRID + "RECTILINEAR_GRID\nX_COORDINATES 300 float\nY_COORDINATES 300 float\nZ_COORDINATES 300 float\n",
        "it says 27000000, ",
    ),
    "cells.vtk": (GRID + "UNSTRUCTURED_GRID\nPOINTS 99999999 float\n", "it says 99999999, "),
    "tag2.msh": (GMSH.format("2.2", FOUR.format(2**31 - 5), "1\n1 4 2 1 1 1 2 3 4"), "it says 2147483643, "),
    "tag4.msh": (GMSH.format("4.1", BLOCK.format(2**40), "1 1 1 1\n3 1 4 1\n1 1 2 3 4"), "it says 1099511627776, "),
    "block.msh": (GMSH.format("4.1", BLOCK.format(4), "1 1 1 1\n3 1 4 99999999\n1 1 2 3 4"), "it says 99999999, "),
    "old.msh": (GMSH.format("4.0", "1", "1"), "it is none of Gmsh's versions 2 and 4.1"),
    "faces.vtu": ('<VTKFile><DataArray Name="faceoffsets"/></VTKFile>', "it has polyhedra"),
}
ODD = {
    "under.mesh": (MEDIT.replace("Vertices\n4", "Vertices\n0_4"), "'0_4' is no whole number"),
    "arabic.mesh": (MEDIT.replace("Vertices\n4", "Vertices\n٤"), "is no whole number"),
    "under.vtk": (GRID + "STRUCTURED_POINTS\nDIMENSIONS 4_00 4_00 4_00\n", "'4_00' is no whole number"),
    "under.msh": (GMSH.format("2.2", FOUR.format(4), "1\n1 4 2 1 1 1 2 3 0_4"), "'0_4' is no number"),
    "arabic.msh": (GMSH.format("2.2", FOUR.format(4), "1\n1 4 2 1 1 1 2 3 ٤"), "is no number"),
    "under.inp": (DECK.replace("1, 0.0", "1, 0_0.0", 1), "line 1: .NODE: '0_0.0' is no number"),
    "arabic.inp": (DECK.replace("1, 0.0", "١, 0.0", 1), "line 1: .NODE: '١' is no whole number"),
    "type.inp": (DECK.replace("C3D8", "C3D٨"), "holds no cells of volume"),
    "name.inp": (DECK + "*NSET, NSET=A\n1_0\n", "line 17: .NSET: '1_0' is no whole number"),
    "side.inp": (DECK + "*SURFACE, NAME=A\n٣, S1\n", "'٣' is no whole number"),
    "infinite.inp": (DECK.replace("1, 0.0", "1, inf", 1), "line 1: .NODE: 'inf' is no number"),
    "large.inp": (DECK.replace("1, 0.0", "1, 1e999", 1), "line 1: .NODE: '1e999' is beyond the largest number"),
    "far.inp": (
        DECK.replace("1, 0.0", "1, 1e150", 1),
        "1 of its nodes have coordinates that are no finite numbers, or",
    ),
    "under.bdf": (BULK.replace("GRID,1,,0.", "GRID,1,,0_0."), "line 1: GRID: '0_0.' is no number"),
    "number.bdf": (BULK.replace("GRID,1", "GRID,1_1"), "line 1: GRID: '1_1' is no whole number"),
    "arabic.bdf": (BULK.replace("1,2,3,4", "1,2,3,٤"), "line 5: CTETRA: '٤' is no whole number"),
    "raised.bdf": (BULK.replace("1,2,3,4", "1,2,3,²"), "line 5: CTETRA: '²' is no whole number"),
    "property.bdf": (BULK.replace("CTETRA,1,9", "CTETRA,1,9_9"), "line 5: CTETRA: '9_9' is no whole number"),
}


@pytest.mark.parametrize("name", [*VAST, *ODD])
def test_counts_and_numbers_that_are_none(name: str, tmp_path: Path) -> None:
    text, message = (VAST | ODD)[name]
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(FormatError, match=message):
        read_mesh(tmp_path / name)


def test_the_files_that_these_start_from_are_meshes(tmp_path: Path) -> None:
    sound = {
        "a.mesh": MEDIT, "a.inp": DECK, "a.bdf": BULK,
        "b.msh": GMSH.format("2.2", FOUR.format(4), "1\n1 4 2 1 1 1 2 3 4"),
        "c.msh": GMSH.format("4.1", BLOCK.format(4), "1 1 1 1\n3 1 4 1\n1 1 2 3 4"),
    }  # fmt: skip
    for name, text in sound.items():
        (tmp_path / name).write_text(text)
        assert len(read_mesh(tmp_path / name).cells) == (2 if name == "a.inp" else 1)


def test_counts_and_tags_in_binary_files_of_gmsh(tmp_path: Path) -> None:
    made = meshio.Mesh(POINTS, [("hexahedron", np.array(CELLS))])
    made.write(tmp_path / "four.msh", file_format="gmsh")
    whole = (tmp_path / "four.msh").read_bytes()
    nodes, elements = (whole.index(name) + len(name) for name in (b"$Nodes\n", b"$Elements\n"))
    # highest tag of a node, nodes of the block, blocks, elements of the block
    places = {nodes + 32 + 20 + 8 * 11: 2**33, nodes + 32 + 12: 2**30, nodes: 2**28, elements + 32 + 12: 2**31}
    for place, number in places.items():
        content = whole[:place] + number.to_bytes(8, "little") + whole[place + 8 :]
        (tmp_path / "four.msh").write_bytes(content)
        with pytest.raises(FormatError, match=f"cannot be read: it says {number}, {MOST}"):
            read_mesh(tmp_path / "four.msh")
    made.write(tmp_path / "two.msh", file_format="gmsh22")
    (tmp_path / "two.msh").write_bytes(
        (tmp_path / "two.msh").read_bytes().replace(b"$Nodes\n12\n", b"$Nodes\n999999999\n")
    )
    with pytest.raises(FormatError, match="it says 999999999"):
        read_mesh(tmp_path / "two.msh")


def test_counts_beside_the_values_of_med(tmp_path: Path) -> None:
    """The attribute NBR of a family, by which meshio makes a list of names."""
    WRITERS["salome.med"](tmp_path / "salome.med")
    assert set(read_mesh(tmp_path / "salome.med").groups) == {"clamp", "tip", "body"}
    with h5py.File(tmp_path / "salome.med", "r+") as file:
        family = file["FAS/mesh/ELEME"]
        next(iter(family.values()))["GRO"].attrs["NBR"] = 10**9
    with pytest.raises(FormatError, match="an array may have 25 000 000 numbers at most"):
        read_mesh(tmp_path / "salome.med")


def test_a_mesh_as_large_as_is_read_declares_no_more() -> None:
    """A million nodes, hexahedra of 20 nodes: counts of numbers may be larger than those of nodes and cells."""
    head = b"POINTS 1000000 double\nCELLS 240000 5040000\nCELL_TYPES 240000\n"
    declared.require_counts(head, "vtk")
    declared.require_counts(
        b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 12345678 0 0.123456789\n$EndNodes\n", "gmsh"
    )


def test_many_groups_take_no_time(tmp_path: Path) -> None:
    """Each cell of a property of its own, were each looked for by itself: as many comparisons as cells squared."""
    cells = "".join(f"CTETRA,{at},{at},1,2,3,4\n" for at in range(2, 5_000))
    (tmp_path / "rig.bdf").write_text(BULK + cells)
    assert len(read_mesh(tmp_path / "rig.bdf").groups) == 4_998
