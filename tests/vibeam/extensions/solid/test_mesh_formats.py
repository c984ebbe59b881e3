"""Files of meshes: each format as its own programs write it; volumes and faces prove the orders of nodes."""

from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from box_meshes import CORNERS, SIZE, bent, end_face, nodes_of

from vibeam.exchange.files import FormatError
from vibeam.extensions.solid.elasticity.own_mesh import (
    Numbering,
    facets_of,
    finite_element_mesh,
    mean_normal,
)
from vibeam.extensions.solid.meshes.read import read_mesh


def volume_of(path: Path) -> float:
    made = finite_element_mesh(read_mesh(path))
    from skfem.quadrature import get_quadrature

    points, weights = get_quadrature(made.elem.refdom, 6)
    return float(np.sum(np.abs(made._mapping().detDF(points)) @ weights))


WRITERS = {  # endings and what meshio's writer is called; Nastran's and Abaqus' are by hand below
    "hexahedron": ("gmsh", "gmsh22", "vtk", "vtu", "medit", "med"),
    "hexahedron20": ("gmsh", "gmsh22", "vtk", "vtu", "med"),
    "hexahedron27": ("gmsh", "gmsh22", "vtu"),
    "tetra": ("gmsh", "gmsh22", "vtk", "vtu", "medit", "med"),
    "tetra10": ("gmsh", "gmsh22", "vtk", "vtu", "med"),
}
ENDINGS = {"gmsh": ".msh", "gmsh22": ".msh", "medit": ".mesh"}


@pytest.mark.parametrize("kind", WRITERS)
def test_volume_of_a_bent_body_in_every_format(kind: str, tmp_path: Path) -> None:
    """A shear keeps the volume to round-off; middle nodes in another order do not."""
    straight, cells = nodes_of(kind)
    curved = kind not in ("hexahedron", "tetra")
    for writer in WRITERS[kind]:
        path = tmp_path / f"{writer}{ENDINGS.get(writer, '.' + writer)}"
        meshio.Mesh(bent(straight) if curved else straight, [(kind, np.array(cells))]).write(path, file_format=writer)
        found = read_mesh(path)
        assert found.kind == kind
        assert type(finite_element_mesh(found)).__name__.endswith("2" if curved else "1")
        assert volume_of(path) == pytest.approx(2 * float(np.prod(SIZE)), rel=1e-12), writer


GMSH_2 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "tip"
3 2 "strip"
3 3 "all of it"
$EndPhysicalNames
$Nodes
13
{nodes}
13 99 99 99
$EndNodes
$Elements
5
1 3 2 1 7 {face}
2 5 2 2 1 {first}
3 5 2 3 1 {first}
4 5 2 2 1 {second}
5 5 2 3 1 {second}
$EndElements
"""


def test_gmsh_repeats_a_cell_for_every_group_that_it_is_in(tmp_path: Path) -> None:
    points, cells = nodes_of("hexahedron")
    (_, faces), text = end_face(points, "hexahedron"), " ".join
    path = tmp_path / "rig.msh"
    path.write_text(
        GMSH_2.format(
            nodes="\n".join(f"{index} {' '.join(map(str, place))}" for index, place in enumerate(points, 1)),
            face=text(str(each + 1) for each in faces[0]),
            first=text(str(each + 1) for each in cells[0]),
            second=text(str(each + 1) for each in cells[1]),
        )
    )
    mesh = read_mesh(path)
    assert (len(mesh.cells), len(mesh.points)) == (2, len(points))
    assert list(mesh.groups["strip"].cells) == list(mesh.groups["all of it"].cells) == [0, 1]
    made, numbering = finite_element_mesh(mesh), Numbering(mesh)
    facets = facets_of(made, numbering.vertices[mesh.groups["tip"].faces[0]])
    np.testing.assert_allclose(mean_normal(made, facets)[0], [1, 0, 0], atol=1e-12)


GMSH_EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
GMSH_FACES = ((0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7))
GMSH_TETRAHEDRON = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))


@pytest.mark.parametrize(("number", "kind"), [(17, "hexahedron20"), (12, "hexahedron27"), (11, "tetra10")])
def test_order_of_nodes_in_the_manual_of_gmsh(number: int, kind: str, tmp_path: Path) -> None:
    own = CORNERS * SIZE if kind.startswith("hexa") else CORNERS[[0, 1, 3, 4]] * SIZE
    middles = [own[list(each)].mean(axis=0) for each in (GMSH_EDGES if kind.startswith("hexa") else GMSH_TETRAHEDRON)]
    if kind == "hexahedron27":
        middles += [*(own[list(face)].mean(axis=0) for face in GMSH_FACES), own.mean(axis=0)]
    points = bent(np.array([*own, *middles]))
    rows = [f"{index} {x!r} {y!r} {z!r}" for index, (x, y, z) in enumerate(points.tolist(), 1)]
    cell = " ".join(str(index) for index in range(1, len(points) + 1))
    nodes = "\n".join([f"$Nodes\n{len(rows)}", *rows, "$EndNodes"])
    path = tmp_path / "one.msh"
    path.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{nodes}\n$Elements\n1\n1 {number} 2 1 1 {cell}\n$EndElements\n"
    )
    assert volume_of(path) == pytest.approx(float(np.prod(SIZE)) / (1 if kind.startswith("hexa") else 6), rel=1e-12)


def deck(kind: str, points: np.ndarray, cells: list[list[int]], more: str = "") -> str:
    """As CalculiX and Abaqus write it: node numbers with gaps, elements over two lines."""
    lines = ["*Heading", "** by hand", "*Part, name=Rig", "*Node"]
    lines += [f"{10 * index + 5:8d}, {x:.9g}, {y:.9g}, {z:.9g}" for index, (x, y, z) in enumerate(points)]
    lines += [f"*Element, type={kind}, elset=Strip"]
    for number, cell in enumerate(cells):
        names = [str(10 * each + 5) for each in cell]
        row = [str(100 + number), *names]
        lines += [", ".join(row[:11]) + ("," if len(row) > 11 else "")]
        lines += [", ".join(row[11:])] if len(row) > 11 else []
    return "\n".join([*lines, more, "*End Part", "*Assembly, name=Assembly", "*Instance, name=Rig-1, part=Rig"]) + (
        "\n*End Instance\n*End Assembly\n"
    )


@pytest.mark.parametrize(
    ("called", "kind"), [("C3D8R", "hexahedron"), ("C3D20R", "hexahedron20"), ("C3D4", "tetra"), ("C3D10", "tetra10")]
)
def test_abaqus(called: str, kind: str, tmp_path: Path) -> None:
    straight, cells = nodes_of(kind)
    points = bent(straight) if kind in ("hexahedron20", "tetra10") else straight
    face = [10 * index + 5 for index, place in enumerate(straight) if place[0] == 60]
    sets = (
        f"*Nset, nset=Tip, internal\n{', '.join(map(str, face))},\n*Nset, nset=all, generate\n5, {10 * len(points)}, 10"
    )
    sets += f"\n*Elset, elset=first, generate\n100, {100 + len(cells) // 2 - 1}, 1\n*Elset, elset=both\nfirst, strip"
    sets += "\n*Surface, type=ELEMENT, name=Side\nfirst, S1\n*Surface, type=node, name=End\nTip, 1."
    path = tmp_path / "rig.inp"
    path.write_text(deck(called, points, cells, sets))
    mesh = read_mesh(path)
    assert (mesh.kind, len(mesh.cells)) == (kind, len(cells))
    assert volume_of(path) == pytest.approx(2 * float(np.prod(SIZE)), rel=1e-7)
    assert len(mesh.groups["Tip"].nodes) == len(face) == len(mesh.groups["End"].nodes)
    assert len(mesh.groups["all"].nodes) == len(points)
    assert list(mesh.groups["first"].cells) == list(range(len(cells) // 2))
    assert len(mesh.groups["both"].cells) == len(cells) == len(mesh.groups["Strip"].cells)
    side = mesh.groups["Side"].faces
    assert sum(map(len, side)) == len(cells) // 2
    if kind.startswith("hexa"):
        assert np.ptp(mesh.points[side[0], 1]) == SIZE[1]  # S1 is the face of nodes 1 to 4, whose first two are along x
        assert np.max(mesh.points[side[0], 2]) < SIZE[2] / 2


NASTRAN_20 = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]  # its middles of the upright edges come before the upper ones


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "tetra", "tetra10"])
def test_nastran(kind: str, tmp_path: Path) -> None:
    straight, cells = nodes_of(kind)
    points = bent(straight) if kind in ("hexahedron20", "tetra10") else straight
    bulk = [f"GRID    {index + 1:<8d}        {x:<8.5f}{y:<8.5f}{z:<8.5f}" for index, (x, y, z) in enumerate(points)]
    for number, cell in enumerate(cells):
        named = [cell[each] + 1 for each in (NASTRAN_20 if kind == "hexahedron20" else range(len(cell)))]
        card = f"{'CHEXA' if kind.startswith('hexa') else 'CTETRA':8}{number + 1:<8d}{3 + number % 2:<8d}"
        bulk.append(card + "".join(f"{each:<8d}" for each in named[:6]))
        for at in range(6, len(named), 8):
            bulk.append(" " * 8 + "".join(f"{each:<8d}" for each in named[at : at + 8]))
    tip = [index + 1 for index, place in enumerate(straight) if place[0] == 60]
    rest = [f"{'':8}" + "".join(f"{each:<8d}" for each in tip[at : at + 8]) for at in range(6, len(tip), 8)]
    bulk += [
        "SPC1    7       123     " + "".join(f"{each:<8d}" for each in tip[:6]),
        *rest,
        f"SPC1,9,123,1,THRU,{len(points)}",
    ]
    control = "SOL 103\nCEND\nSET 4 = 1 THRU 3,\n 5\n"
    whole = tmp_path / "whole.bdf"
    whole.write_text(control + "BEGIN BULK\n" + "\n".join(bulk) + "\nENDDATA\n")
    bare = tmp_path / "bare.nas"
    bare.write_text("$ an include file\n" + "\n".join(bulk))
    mesh = read_mesh(whole)
    assert (mesh.kind, len(mesh.cells)) == (kind, len(cells))
    assert volume_of(bare) == pytest.approx(2 * float(np.prod(SIZE)), rel=1e-6)
    assert {name: len(group.cells) for name, group in mesh.groups.items() if group.cells.size} == {
        "property 3": len(cells) // 2,
        "property 4": len(cells) // 2,
    }
    held = {name: len(group.nodes) for name, group in mesh.groups.items() if group.nodes.size}
    assert held == {"SPC 7": len(tip), "SPC 9": len(points), "SET 4": 4}


def test_nastran_in_free_and_large_fields(tmp_path: Path) -> None:
    path = tmp_path / "rig.fem"
    large = f"GRID*   {3:>16}{'':16}{'0.':>16}{'1.5D-3':>16}\n*       {'0.':>16}\n"
    path.write_text(
        f"$ by hand\nGRID,1,,0.,0.,0.\nGRID*,2,,1.5-3,0.\n*,0.\n{large}grid,4,0,,,1.5e-3 $ last\nctetra,1,9,1,2\n"
    )
    with pytest.raises(FormatError, match="line 8: CTETRA: has 2 nodes"):
        read_mesh(path)
    path.write_text(path.read_text() + "+,3,4\n")
    mesh = read_mesh(path)
    np.testing.assert_array_equal(mesh.points, 1.5e-3 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))
    assert list(mesh.groups) == ["property 9"]


def test_arrays_of_whole_numbers_are_groups(tmp_path: Path) -> None:
    points, cells = nodes_of("hexahedron")
    kind, faces = end_face(points, "hexahedron")
    data = {
        "region": [np.array([1, 2]), np.array([7])],
        "tip": [np.array([0, 0]), np.array([1])],
        "stress": [np.ones(2), np.ones(1)],
    }
    for name in ("rig.vtu", "rig.vtk"):
        path = tmp_path / name
        meshio.Mesh(points, [("hexahedron", np.array(cells)), (kind, np.array(faces))], cell_data=data).write(path)
        groups = read_mesh(path).groups
        assert set(groups) == {"region 1", "region 2", "region 7", "tip"}
        assert (list(groups["region 2"].cells), len(groups["tip"].faces[0])) == ([1], 1)


DAMAGED = {
    "rig.stl": ("solid rig", "'.stl' is no ending of a mesh: .msh, "),
    "rig.msh": ("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 99999999999999 1 2\n", "cannot be read as gmsh: "),
    "cut.msh": ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0\n", "cannot be read as gmsh: "),
    "text.msh": ("a letter", "cannot be read: it is none of Gmsh's versions 2 and 4.1"),
    "rig.vtu": ("<VTKFile", "cannot be read as vtu: "),
    "rig.med": ("no HDF5", "cannot be read as med: "),
    "rig.bdf": ("BEGIN BULK\n", "has no GRID"),
    "five.bdf": ("GRID,1\nCTETRA,1,1,1,1,1,1,1\n", "line 2: CTETRA: has 5 nodes: it must have 4 or 10"),
    "system.bdf": (
        "GRID,1,5,0.,0.,0.\nGRID,2,,1.,0.,0.\nCROD,1,1,1,2\n",
        "line 1: GRID: is in the coordinate system 5: write all grids in the basic one",
    ),
    "rig.inp": ("*Heading\n", "has no .NODE"),
    "cell.inp": ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n", "node 2 is named and not there"),
    "short.inp": (
        "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2\n",
        "line 3: .ELEMENT: its numbers are no multiple of 5",
    ),
    "twice.inp": ("*NODE\n1, 0, 0, 0\n*NODE\n1, 2, 3, 4\n", "line 3: .NODE: node 1 is there twice"),
    "word.inp": ("*NODE\n1, 0, zero, 0\n", "line 1: .NODE: 'zero' is no number"),
    "moved.inp": ("*INSTANCE, name=a, part=b\n1, 0, 0\n", "moves the part, or is a second one"),
    "include.inp": ("*INCLUDE, INPUT=other.inp\n", "another file is not read"),
    "empty.msh": ("", "is empty"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_what_is_no_mesh(name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / name
    path.write_text(DAMAGED[name][0])
    with pytest.raises(FormatError, match=DAMAGED[name][1]):
        read_mesh(path)
    assert capfd.readouterr() == ("", "")  # meshio prints


def test_values_in_other_files_are_not_followed(tmp_path: Path) -> None:
    points, cells = nodes_of("hexahedron")
    path = tmp_path / "rig.med"
    meshio.Mesh(points, [("hexahedron", np.array(cells))]).write(path)
    with h5py.File(path, "r+") as file:
        file["far"] = h5py.ExternalLink("other.h5", "/x")
    with pytest.raises(FormatError, match="'far' lies in another file: copy it into this one"):
        read_mesh(path)


def test_elements_that_are_not_taken(tmp_path: Path) -> None:
    points, cells = nodes_of("hexahedron")
    mixed = meshio.Mesh(points, [("hexahedron", np.array(cells[:1])), ("wedge", np.array([cells[1][:6]]))])
    mixed.write(tmp_path / "mixed.vtu")
    with pytest.raises(FormatError, match="holds 1 hexahedra, 1 wedges: only hexahedra alone or tetrahedra alone"):
        read_mesh(tmp_path / "mixed.vtu")
    kind, faces = end_face(points, "hexahedron")
    meshio.Mesh(points, [(kind, np.array(faces))]).write(tmp_path / "skin.vtu")
    with pytest.raises(FormatError, match=r"holds no cells of volume \(1 quad\): mesh the volume"):
        read_mesh(tmp_path / "skin.vtu")
    meshio.Mesh(np.where(points > 50, np.nan, points), [("hexahedron", np.array(cells))]).write(tmp_path / "nan.vtu")
    with pytest.raises(FormatError, match="4 of its nodes have coordinates that are no finite numbers"):
        read_mesh(tmp_path / "nan.vtu")
