"""Bodies of a user's meshes: what groups become, and every fault of a mesh in one message with its group."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from box_meshes import SIZE, bent, end_face, nodes_of

from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.own_mesh import OwnRig
from vibeam.extensions.solid.elasticity.plan import GroupMass, GroupMaterial, OwnMesh, SurfaceMotion
from vibeam.extensions.solid.meshes.body import BodyReading
from vibeam.extensions.solid.meshes.own import own_structure
from vibeam.extensions.solid.meshes.read import read_mesh

STEEL = GroupMaterial(youngs_modulus=210e9, density=7850.0, poissons_ratio=0.3)
BRASS = replace(STEEL, group="far", density=8500.0, youngs_modulus=110e9)
PLAN = OwnMesh(
    file="rig.vtu", unit=1e-3, materials=(STEEL,), clamp=("clamp",), contact=SurfaceMotion("end"), extent=None
)  # fmt: skip
VOLUME = float(np.prod(SIZE)) * 1e-9  # m³ of one box
LEFT = [[0, 3, 7, 4]]  # face x = 0 of the first box


def written(
    folder: Path,
    points: np.ndarray | None = None,
    cells: Sequence[Sequence[int]] | None = None,
    faces: Mapping[str, Sequence[Sequence[int]]] | None = None,
    nodes: Mapping[str, Sequence[int]] | None = None,
    regions: Mapping[str, Sequence[int]] | None = None,
) -> None:
    """A VTU file of the two boxes, or others, with faces, nodes and cells as groups by name."""
    own, boxes = nodes_of("hexahedron")
    points, cells = (own if points is None else points), (boxes if cells is None else cells)
    faces = {"clamp": LEFT, "end": end_face(own, "hexahedron")[1]} if faces is None else faces
    regions = {"far": [1]} if regions is None else regions
    every = [face for each in faces.values() for face in each]
    data = {
        name: [np.zeros(len(cells), int), np.array([int(face in group) for face in every], dtype=int)]
        for name, group in faces.items()
    }
    for name, indices in regions.items():
        data[name] = [np.isin(np.arange(len(cells)), indices).astype(int), np.zeros(len(every), int)]
    point_data = {name: np.isin(np.arange(len(points)), each).astype(int) for name, each in (nodes or {}).items()}
    blocks = [("hexahedron", np.array(cells)), ("quad", np.array(every))]
    meshio.Mesh(points, blocks, point_data=point_data, cell_data=data).write(folder / "rig.vtu")


def read(folder: Path, **changes: Any) -> tuple[SolidBody, OwnRig]:
    plan = replace(PLAN, **changes)
    mesh = read_mesh(folder / plan.file)
    reading = BodyReading(plan, replace(mesh, points=mesh.points * plan.unit))
    body, rig = reading.body_and_rig()
    assert reading.faults == []
    assert body is not None
    assert rig is not None
    return body, rig


def faults(folder: Path, **changes: Any) -> list[str]:
    given, found = own_structure(replace(PLAN, **changes), folder)
    assert given is None
    return [f"{key}: {message}" for key, message in found]


def test_groups_become_clamp_contact_materials_and_masses(tmp_path: Path) -> None:
    written(tmp_path, nodes={"tip": [0, 4]})
    mass = GroupMass(group="far", mass=0.2, rotary_inertia=1e-5)
    body, rig = read(
        tmp_path, materials=(STEEL, BRASS), masses=(mass,), outputs={"tip": SurfaceMotion("tip", "-z")}, base="z"
    )
    assert body.mass == pytest.approx(VOLUME * (7850 + 8500))
    np.testing.assert_allclose(body.mesh.p[0][body.mesh.facets[:, body.patches["clamp"]]], 0)
    ((facets, vertices, along, factor),) = rig.rows["contact"].parts
    np.testing.assert_allclose(body.mesh.p[0][body.mesh.facets[:, facets]], 0.06)
    np.testing.assert_array_equal(along, [1, 0, 0])
    assert (len(vertices), factor, rig.rows["sensor"]) == (0, 1.0, rig.rows["contact"])
    ((facets, vertices, along, _),) = rig.rows["tip"].parts
    np.testing.assert_array_equal(along, [0, 0, -1])
    np.testing.assert_allclose(np.sort(body.mesh.p[2][vertices]), [0, 0.01])
    np.testing.assert_array_equal(rig.base, [0, 0, 1])
    assert (body.masses[0].mass, body.masses[0].inertia, body.masses[0].rigid) == (0.2, 1e-5, True)
    assert body.mesh.p[0][body.masses[0].vertices].min() == 0.03


def test_nodes_that_hold_whole_faces_are_a_surface(tmp_path: Path) -> None:
    own, _ = nodes_of("hexahedron")
    written(tmp_path, nodes={"end nodes": [index for index, place in enumerate(own) if place[0] == 60]})
    by_nodes, by_faces = (read(tmp_path, contact=SurfaceMotion(name))[1] for name in ("end nodes", "end"))
    np.testing.assert_array_equal(by_nodes.rows["contact"].parts[0][0], by_faces.rows["contact"].parts[0][0])


def test_half_of_a_body_is_turned_to_y_above_0(tmp_path: Path) -> None:
    for place, group in ((0.0, "low"), (SIZE[2], "high")):
        own, _ = nodes_of("hexahedron")
        side = [[0, 1, 2, 3]] if group == "low" else [[4, 5, 6, 7]]
        written(tmp_path, faces={"clamp": LEFT, "end": end_face(own, "hexahedron")[1], group: side})
        body, rig = read(tmp_path, symmetry=group, base="y")
        assert body.half
        assert body.mass == pytest.approx(4 * VOLUME * 7850)
        assert (body.mesh.p[1].min(), body.mesh.p[1].max()) == (0, pytest.approx(SIZE[2] * 1e-3))
        np.testing.assert_allclose((body.mesh.p.T @ body.turn + body.origin)[:, 2].max(), SIZE[2] * 1e-3)
        assert np.linalg.det(body.turn) == 1
        np.testing.assert_array_equal(rig.base, body.turn @ [0, 1, 0])
        ((facets, _, along, _),) = rig.rows["contact"].parts
        np.testing.assert_array_equal(body.turn.T @ along, [1, 0, 0])
        assert np.ptp(along @ body.mesh.p[:, body.mesh.facets[:, facets].ravel()]) == 0
        assert place in (0.0, SIZE[2])
        assert faults(tmp_path, symmetry=group, base="z") == [
            "symmetry: the motion is across the plane of symmetry: mesh the whole body"
        ]
    written(
        tmp_path,
        faces={
            "clamp": LEFT,
            "end": end_face(own, "hexahedron")[1],
            "inner": [[1, 2, 6, 5]],
            "bent": [LEFT[0], [0, 1, 2, 3]],
        },
    )
    said = "symmetry: 'inner' has the body on both sides: mesh one half alone"
    assert faults(tmp_path, symmetry="inner", base="z")[0] == said
    said = "symmetry: 'bent' lies in no plane normal to an axis, as the face of one half does"
    assert faults(tmp_path, symmetry="bent", base="z")[0] == said


def two_boxes(gap: float = 0.0) -> tuple[np.ndarray, list[list[int]]]:
    """The two boxes with nodes of their own, ``gap`` mm between them."""
    own, cells = nodes_of("hexahedron")
    second = own[cells[1]] + [gap, 0, 0]
    return np.vstack([own[cells[0]], second]), [list(range(8)), list(range(8, 16))]


FACES = {"clamp": [[0, 3, 7, 4]], "end": [[9, 10, 14, 13]]}


def test_bodies_that_only_touch(tmp_path: Path) -> None:
    written(tmp_path, *two_boxes(), faces=FACES)
    (said,) = faults(tmp_path)
    assert said.startswith("clamp: does not hold a body of 1 cells of group 'far' at (45, 10, 5) mm, which touches no ")
    assert "4 of its nodes lie on nodes of another body without being the same" in said
    assert said.endswith('or write merge = "1 µm"')
    body, _ = read(tmp_path, merge=1e-6)
    assert (body.mesh.p.shape[1], body.mass) == (12, pytest.approx(2 * VOLUME * 7850))
    assert faults(tmp_path, merge=6e-3) == ["merge: 0.006 m is no small part of the shortest edge, 0.01 m: write less"]
    both = {**FACES, "clamp": [[0, 3, 7, 4], [9, 10, 14, 13]]}
    written(tmp_path, *two_boxes(), faces=both)
    (said,) = faults(tmp_path, contact=SurfaceMotion("clamp", "z"))
    assert said.startswith("mesh: 4 pairs of its nodes lie on each other without being the same, the first at (30, ")


def test_bodies_with_a_gap_and_bodies_in_contact(tmp_path: Path) -> None:
    written(tmp_path, *two_boxes(0.5), faces=FACES)
    (said,) = faults(tmp_path)
    assert said.endswith("at (45.5, 10, 5) mm, whose nodes are 0.5 mm off any other: join them, or clamp it")
    said = "merge: no two nodes of the mesh are nearer than 1e-06 m: leave it out, or write more"
    assert faults(tmp_path, merge=1e-6) == [said]
    meeting = {"clamp": [[0, 3, 7, 4], [9, 10, 14, 13]], "end": [[1, 2, 6, 5]], "anvil": [[8, 11, 15, 12]]}
    for gap in (0.5, 0.0):
        written(tmp_path, *two_boxes(gap), faces=meeting)
        _, rig = read(tmp_path, opposite=SurfaceMotion("anvil"))
        assert [part[3] for part in rig.rows["contact"].parts] == [1.0, -1.0]
        assert rig.rows["sensor"].parts == rig.rows["contact"].parts[:1]
        assert [list(part[2]) for part in rig.rows["contact"].parts] == [[1, 0, 0], [1, 0, 0]]


def test_bodies_whose_faces_do_not_match(tmp_path: Path) -> None:
    points, cells = two_boxes()
    points[8:, 1] *= 2
    written(tmp_path, points, cells, faces=FACES)
    assert faults(tmp_path, merge=1e-6) == [
        "merge: the faces that touch at (30, 0, 0) mm do not match node by node: mesh the bodies together"
    ]


def test_groups_that_are_wrong(tmp_path: Path) -> None:
    own, _ = nodes_of("hexahedron")
    faces = {
        "clamp": LEFT,
        "end": end_face(own, "hexahedron")[1],
        "off": [[0, 1, 6, 7]],
        "inner": [[1, 2, 6, 5]],
        "round": [LEFT[0], end_face(own, "hexahedron")[1][0]],
    }
    written(tmp_path, np.vstack([own, [99, 99, 99]]), faces=faces, nodes={"none": [], "stray": [0, 12], "two": [0, 1]})
    two = GroupMaterial(group="far", youngs_modulus=70e9, density=2700.0)
    found = faults(
        tmp_path,
        clamp=("Clamp", "none"),
        contact=SurfaceMotion("far"),
        sensor=SurfaceMotion("stray"),
        materials=(two, two, replace(two, group="end")),
        masses=(GroupMass(group="mass", mass=1.0),),
    )
    assert found == [
        "clamp.0: the mesh has no group 'Clamp': did you mean 'clamp'?",
        "clamp.1: the group 'none' is empty",
        "contact: the group 'far' is 1 cells of volume, and a surface is wanted: name a group of faces or nodes (Gmsh: "
        "a Physical Surface)",
        "sensor: 1 of the nodes of group 'stray' are of no cell of volume, and nothing moves them: name nodes of the "
        "body",
        "mass.0.group: the mesh has no group 'mass': known here: clamp, end, off, inner, round, far, none, stray, two",
        "material.1.group: 1 cells of 'far' are of 'far' too: a cell has one material",
        "material.2.group: the group 'end' has no cells of volume, which alone have a material",
        "material: missing for 1 of 2 cells: add a material of their group, or one without group for all the rest",
    ]
    found = faults(tmp_path, contact=SurfaceMotion("off", "z"), sensor=SurfaceMotion("inner"))
    assert found == [
        "contact: 1 of the 1 faces of group 'off' are no faces of the volume's cells: mesh surface and volume together",
        "sensor: 1 of the 1 faces of group 'inner' lie inside the body: name faces of its surface",
    ]
    assert faults(tmp_path, contact=SurfaceMotion("round")) == [
        'contact: the faces of \'round\' look in all directions: write { group = "round", direction = "z" }'
    ]
    assert faults(tmp_path, contact=SurfaceMotion("two")) == [
        'contact: \'two\' is of nodes alone, which have no normal: write { group = "two", direction = "z" }'
    ]


def test_cells_that_are_wrong(tmp_path: Path) -> None:
    own, cells = nodes_of("hexahedron")
    first, second = cells
    written(tmp_path, cells=[first, [second[each] for each in (4, 5, 6, 7, 0, 1, 2, 3)]])
    inverted = "mesh: 1 of 2 cells is inverted or folded, of group 'far' at (45, 10, 5) mm: mesh again there"
    assert faults(tmp_path)[0].startswith(inverted)
    folded = own.copy()
    folded[second[6]] = [31, 1, 1]
    written(tmp_path, folded)
    assert "1 of 2 cells is inverted or folded, of group 'far'" in faults(tmp_path)[0]
    flat = own.copy()
    flat[second[1]], flat[second[2]], flat[second[5]], flat[second[6]] = (own[second[each]] for each in (0, 3, 4, 7))
    written(tmp_path, flat)
    assert faults(tmp_path)[0].startswith("mesh: 1 of 2 cells is degenerate, without volume, of group 'far' at")
    written(tmp_path, cells=[first, [*second[:6], second[5], second[7]]])
    assert faults(tmp_path)[0].startswith("mesh: 1 of 2 cells is degenerate, with a corner named twice, of group 'far'")
    mirrored = own * [1, -1, 1]  # all cells alike: only the numbering is left-handed
    written(tmp_path, mirrored)
    assert read(tmp_path)[0].mass == pytest.approx(2 * VOLUME * 7850)


def test_middle_nodes_in_another_order(tmp_path: Path) -> None:
    own, cells = nodes_of("hexahedron20")
    shuffled = [[*cell[:12], *cell[16:20], *cell[12:16]] for cell in cells]  # as Nastran's, and not told so
    blocks = [("hexahedron20", np.array(shuffled)), ("quad", np.array([*LEFT, *end_face(own, "hexahedron")[1]]))]
    data = {"clamp": [[0, 0], [1, 0]], "end": [[0, 0], [0, 1]]}
    meshio.Mesh(own, blocks, cell_data={name: list(map(np.array, each)) for name, each in data.items()}).write(
        tmp_path / "rig.vtu"
    )
    assert faults(tmp_path)[0].startswith("mesh: 2 of 2 cells are with middle nodes far off their edges, the first at ")


def test_unit_of_the_coordinates(tmp_path: Path) -> None:
    written(tmp_path)
    assert faults(tmp_path, unit=1.0) == [
        'mesh_unit: the mesh is 60 m long: is mesh_unit = "mm" meant? Where it is, write extent = "60 m"'
    ]
    assert faults(tmp_path, extent=0.6) == ['extent: is 0.6 m, and the mesh is 0.06 m long: is mesh_unit = "cm" meant?']
    points, cells = nodes_of("hexahedron")
    written(tmp_path, points / 300, cells)
    assert faults(tmp_path)[0].startswith('mesh_unit: the mesh is 0.0002 m long: is mesh_unit = "m" meant?')
    written(tmp_path)
    assert faults(tmp_path, extent=0.05)[0].endswith("long: one of mesh_unit and extent is wrong")
    assert read(tmp_path, unit=1.0, extent=60.0)[0].mass == pytest.approx(2e9 * VOLUME * 7850)
    assert faults(tmp_path, file="none.msh") == ["mesh: none.msh: no such file"]


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "hexahedron27", "tetra", "tetra10"])
def test_patch_of_a_linear_displacement_on_every_kind(kind: str, tmp_path: Path) -> None:
    """u = A x has the energy V σ:ε/2, on bent elements of the second order as on straight ones, to round-off."""
    own, cells = nodes_of(kind)
    points = own if kind in ("hexahedron", "tetra") else bent(own)
    (called, right), (_, left) = end_face(own, kind), end_face(own, kind, 0)
    blocks = [(kind, np.array(cells)), (called, np.array([*left, *right]))]
    count = len(left)
    data = {"clamp": [1] * count + [0] * count, "end": [0] * count + [1] * count}
    none = np.zeros(len(cells), int)
    arrays = {name: [none, np.array(each)] for name, each in data.items()}
    meshio.Mesh(points, blocks, cell_data=arrays).write(tmp_path / "rig.vtu")
    body, _ = read(tmp_path)
    assert body.mass == pytest.approx(2 * VOLUME * 7850, rel=1e-12)
    given, _ = own_structure(replace(PLAN, contact=SurfaceMotion("end", "z")), tmp_path)
    assert given is not None
    assert np.all(given.structure.modes(2).omega > 1e4)
    elements = SolidElements(body.mesh)
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.7, 0.4], [0.6, 0.2, 0.5]]) * 1e-3
    displacement = (gradient @ elements.points).T.ravel()
    strain = (gradient + gradient.T) / 2
    twice = 210e9 / 1.3
    density = twice / 2 * np.sum(strain**2) + 0.3 * twice / 0.4 / 2 * np.trace(strain) ** 2
    K = elements.stiffness(body.materials, body.material)
    assert displacement @ (K @ displacement) / 2 == pytest.approx(2 * VOLUME * density, rel=1e-11)


def gmsh_4(points: np.ndarray, cells: list[list[int]], faces: Mapping[str, list[int]]) -> str:
    """As Gmsh writes format 4.1: groups are of entities, cells stand by entity; those of 8 nodes are of type 5."""
    names = [f'2 {index} "{name}"' for index, name in enumerate(faces, 1)]
    entities = [f"{index} 0 0 0 1 1 1 1 {index} 0" for index in range(1, len(faces) + 1)]
    nodes = [
        *(str(index) for index in range(1, len(points) + 1)),
        *(" ".join(map(repr, each)) for each in points.tolist()),
    ]
    rows = [
        line for index, each in enumerate(faces.values(), 1) for line in (f"2 {index} 3 1", f"{index} {_one(each)}")
    ]
    rows += [f"3 1 5 {len(cells)}", *(f"{10 + index} {_one(each)}" for index, each in enumerate(cells))]
    size, count = len(points), len(faces) + len(cells)
    sections = {
        "MeshFormat": ["4.1 0 8"],
        "PhysicalNames": [str(len(names) + 1), *names, '3 5 "strip"'],
        "Entities": [f"0 0 {len(faces)} 1", *entities, "1 0 0 0 1 1 1 1 5 0"],
        "Nodes": [f"1 {size} 1 {size}", f"3 1 0 {size}", *nodes],
        "Elements": [f"{len(faces) + 1} {count} 1 {count}", *rows],
    }
    return "".join("\n".join([f"${name}", *lines, f"$End{name}\n"]) for name, lines in sections.items())


def _one(nodes: Sequence[int]) -> str:
    return " ".join(str(each + 1) for each in nodes)


def test_structure_is_the_same_whatever_the_format(tmp_path: Path) -> None:
    """Nodes in another order leave the frequencies, to round-off."""
    own, cells = nodes_of("hexahedron")
    faces = {"clamp": LEFT[0], "end": end_face(own, "hexahedron")[1][0]}
    (tmp_path / "rig.msh").write_text(gmsh_4(own, cells, faces))
    deck = ["*NODE", *(f"{index}, {x}, {y}, {z}" for index, (x, y, z) in enumerate(own, 1)), "*ELEMENT, TYPE=C3D8"]
    deck += [f"{index}, {_one(each).replace(' ', ', ')}" for index, each in enumerate(cells[::-1], 1)]
    deck += [line for name, each in faces.items() for line in (f"*NSET, NSET={name}", _one(each).replace(" ", ", "))]
    (tmp_path / "rig.inp").write_text("\n".join(deck))
    written(tmp_path)
    found = []
    for name in ("rig.msh", "rig.inp", "rig.vtu"):
        given, said = own_structure(replace(PLAN, file=name, contact=SurfaceMotion("end", "z")), tmp_path)
        assert said == ()
        assert given is not None
        assert (given.kind, given.carried) == ("solid", pytest.approx(2 * VOLUME * 7850))
        found.append(given.structure.modes(4).omega)
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-9)
    # the cantilever 60 × 20 × 10 mm of Euler and Bernoulli: 1.875² √(E/12ρ) h/L², of which shear takes some
    beam = 1.8751**2 * np.sqrt(210e9 / (12 * 7850)) * 0.01 / 0.06**2
    assert found[0][0] == pytest.approx(beam, rel=0.05)


def test_masses_that_cannot_be_rigid(tmp_path: Path) -> None:
    written(tmp_path, regions={"near": [0], "far": [1]})
    masses = tuple(GroupMass(group=name, mass=0.1) for name in ("near", "far"))
    cure = "write rigid = false, or make the group smaller"
    assert faults(tmp_path, masses=masses) == [
        f"mass.0.group: 4 nodes of the rigid group 'near' are of the clamp too: {cure}",
        f"mass.1.group: 4 nodes of the rigid group 'far' are of 'near' too: {cure}",
    ]
    assert len(read(tmp_path, masses=(replace(masses[0], rigid=False), masses[1]))[0].masses) == 2


def test_no_more_groups_are_listed_than_are_read(tmp_path: Path) -> None:
    written(tmp_path, nodes={f"set {index}": [index % 12] for index in range(40)})
    (said,) = faults(tmp_path, sensor=SurfaceMotion("xyz"))
    assert said.count("set ") == 9
    assert said.endswith(", …")
    assert "did you mean 'set 39'?" in faults(tmp_path, sensor=SurfaceMotion("set39"))[0]


def test_what_is_held_on_a_line_can_turn(tmp_path: Path) -> None:
    written(tmp_path, nodes={"line": [0, 3], "one": [1]})
    assert faults(tmp_path, clamp=("line",), outputs={"force": SurfaceMotion("end")}) == [
        "outputs.force: 'force' is a name of its own in [solid]: call the output otherwise",
        "clamp: holds a body of 2 cells at (30, 10, 5) mm on a line or in a point alone, about which it turns: hold a "
        "face",
    ]
    assert faults(tmp_path, masses=(GroupMass(group="one", mass=0.1),)) == [
        "mass.0.group: the group 'one' is a line or a point, which cannot turn as a body does: write rigid = false, or "
        "name a face"
    ]
    given, _ = own_structure(replace(PLAN, masses=(GroupMass(group="one", mass=0.1, rigid=False),)), tmp_path)
    assert given is not None
    assert given.structure.modes(3).omega[0] > 1e3


def test_what_is_assumed_is_said(tmp_path: Path) -> None:
    written(tmp_path)
    given, _ = own_structure(replace(PLAN, materials=(replace(STEEL, poissons_ratio=None),)), tmp_path)
    assert given is not None
    assert given.assumed == (
        "Poisson's ratio 0.3, of steel by E = 210 GPa, is assumed: poissons_ratio says it",
        "solid.contact is read along (1, 0, 0), the outward normal of 'end'",
    )


def slab(folder: Path, across: int) -> None:
    """VTU of a strip 60 × 20 × 4 mm of 6 × ``across`` × 1 cells; with one across that half of it with y ≥ 0."""
    x, y, z = np.linspace(0, 60, 7), np.linspace(-10, 10, 3)[-across - 1 :], np.array([0.0, 4.0])
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape(7, across + 1, 2)
    at = (slice(None, -1), slice(1, None))
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[at[a], at[b], at[c]].ravel() for a, b, c in corners], axis=1)
    groups = {"clamp": points[:, 0] == 0, "end": points[:, 0] == 60, "middle": points[:, 1] == 0}
    groups |= {"last": points[:, 0] >= 50}
    groups["top"] = (points[:, 2] == 4) & (points[:, 0] >= 30)
    data = {name: each.astype(int) for name, each in groups.items()}
    meshio.Mesh(points, [("hexahedron", cells)], point_data=data).write(folder / f"slab{across}.vtu")


@pytest.mark.parametrize("rigid", [True, False])
def test_half_of_a_body_moves_as_the_whole(rigid: bool, tmp_path: Path) -> None:
    """Its modes are those of the whole that are symmetric: frequency, contact, load; masses are said whole."""
    plan = replace(PLAN, contact=SurfaceMotion("top"), masses=(GroupMass(group="end", mass=0.05, rigid=rigid),))
    modes = []
    for across in (1, 2):
        slab(tmp_path, across)
        said = replace(plan, file=f"slab{across}.vtu", symmetry="middle" if across == 1 else None)
        given, found = own_structure(said, tmp_path)
        assert found == ()
        assert given is not None
        assert given.carried == pytest.approx(0.05 + 60 * 20 * 4e-9 * 7850)
        few, structure = given.structure.modes(8), given.structure
        moved = np.abs(structure.load @ few.shapes), np.abs(structure.contact @ few.shapes)
        modes.append(np.column_stack((few.omega, *moved)))
    half, whole = modes
    symmetric = [int(np.argmin(np.abs(whole[:, 0] / each - 1))) for each in half[:3, 0]]
    np.testing.assert_allclose(whole[symmetric], half[:3], rtol=1e-6, atol=1e-9)
    assert symmetric[1] > 1  # of the whole some are not


def test_more_coordinates_than_are_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path)
    monkeypatch.setattr("vibeam.extensions.solid.meshes.body.COORDINATES", 134)
    (said,) = faults(tmp_path, contact=SurfaceMotion("end", "x"))
    assert said.startswith("mesh: makes 135 coordinates by quadratic elements, and 134 are the most that are taken")
