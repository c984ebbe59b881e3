"""Shapes of solids: cells by VTK's own places of nodes, whole bodies of halves, closed surfaces, files read back."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import skfem
from box_meshes import end_face, nodes_of
from scipy.sparse import identity
from solid_bodies import RIG
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.vtu import VtuPiece, write_series, write_vtu
from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.plan import GroupMaterial, OwnMesh, SurfaceMotion
from vibeam.extensions.solid.elasticity.space import SolidField
from vibeam.extensions.solid.meshes.own import own_structure
from vibeam.extensions.solid.shape import SolidShape, solid_shapes, solid_system
from vibeam.figures.kinds.vtu import steps_of
from vibeam.studies.modes import mode_table, write_shapes
from vibeam_models.base import Base
from vibeam_models.given import GivenScene
from vibeam_models.stop import Stop

#: places of the nodes in the reference cell, as VTK 9.7's GetParametricCoords prints them
PLACES = {
    "hexahedron27": [
        (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0.5, 0, 0),
        (1, 0.5, 0), (0.5, 1, 0), (0, 0.5, 0), (0.5, 0, 1), (1, 0.5, 1), (0.5, 1, 1), (0, 0.5, 1), (0, 0, 0.5),
        (1, 0, 0.5), (1, 1, 0.5), (0, 1, 0.5), (0, 0.5, 0.5), (1, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 1, 0.5),
        (0.5, 0.5, 0), (0.5, 0.5, 1), (0.5, 0.5, 0.5),
    ],
    "tetra10": [
        (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0), (0, 0, 0.5),
        (0.5, 0, 0.5), (0, 0.5, 0.5),
    ],
}  # fmt: skip
CUBE = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])

TEXT = (
    RIG
    + """[fidelity.beam]
reduction = "modal"
modes = 2
[fidelity.solid]
model = "solid"
reduction = "modal"
modes = 2
"""
)


def field_of(mesh: Any, half: bool = False) -> SolidField:
    elements = SolidElements(mesh)
    body = SolidBody(mesh, np.zeros(mesh.nelements, dtype=np.int64), (), half, {})
    return SolidField(body, elements, identity(elements.size, format="csc"))


def meshes() -> dict[str, Any]:
    """Skew bodies of straight cells, 2 × 2 × 2 cubes."""
    shear = np.array([[1.0, 0.2, 0.1], [0.0, 0.8, 0.3], [0.0, 0.0, 1.4]])
    made = {"hexahedron27": skfem.MeshHex().refined(1), "tetra10": skfem.MeshTet().refined(1)}
    return {name: type(mesh)(np.ascontiguousarray(shear @ mesh.p), mesh.t) for name, mesh in made.items()}


def polynomials(places: np.ndarray, name: str) -> np.ndarray:
    """Monomials (points, nodes) of VTK's interpolation in a cell."""
    powers = [(i, j, k) for i in range(3) for j in range(3) for k in range(3) if name[0] == "h" or i + j + k <= 2]
    return np.stack([np.prod(places ** np.array(each), axis=1) for each in powers], axis=1)


@pytest.mark.parametrize("name", PLACES)
def test_a_quadratic_field_is_read_back_within_the_cells_of_vtk(name: str, tmp_path: Path) -> None:
    """Places and u = quadratic in x, interpolated by VTK's polynomials at random points of every cell: to round-off."""
    shape = SolidShape.of(field_of(meshes()[name]))

    def quadratic(x: np.ndarray) -> np.ndarray:
        return np.stack([x[:, 0] ** 2, x[:, 1] * x[:, 2] - x[:, 0], x[:, 2] ** 2 + 1], axis=1)

    write_vtu(VtuPiece(shape.points, {"u": quadratic(shape.points)}, shape.cells), tmp_path / "a.vtu")
    read = meshio.read(tmp_path / "a.vtu")
    (block,) = read.cells
    assert (block.type, block.data.shape) == (name, shape.cells.shape)
    places = np.array(PLACES[name], dtype=float)
    inside = np.random.default_rng(1).dirichlet(np.ones(4), 20)[:, :3]
    weights = polynomials(inside, name) @ np.linalg.inv(polynomials(places, name))
    for cell in block.data:
        x, u = weights @ read.points[cell], weights @ read.point_data["u"][cell]
        np.testing.assert_allclose(u, quadratic(x), atol=1e-13)
        corners = read.points[cell[:4]] if name == "tetra10" else read.points[cell[[0, 1, 3, 4]]]
        assert np.linalg.det(corners[1:] - corners[0]) > 0  # not inside out


@pytest.mark.parametrize("name", PLACES)
def test_the_triangles_are_a_closed_surface_seen_from_outside(name: str) -> None:
    mesh = meshes()[name]
    shape = SolidShape.of(field_of(mesh))
    edges = Counter(tuple(pair) for t in shape.triangles.tolist() for pair in zip(t, t[1:] + t[:1], strict=True))
    assert set(edges.values()) == {1}
    assert all((second, first) in edges for first, second in edges)
    a, b, c = (shape.points[corner] for corner in shape.triangles.T)
    volume = np.sum(a * np.cross(b, c)) / 6  # divergence theorem
    assert volume == pytest.approx(0.8 * 1.4, rel=1e-12)


def test_a_half_is_drawn_whole() -> None:
    """The mirrored half moves alike with u_y turned; on the plane of symmetry both share their nodes."""
    half = SolidShape.of(field_of(meshes()["hexahedron27"], half=False))
    body = field_of(skfem.MeshHex().refined(1), half=True)
    whole = SolidShape.of(body)
    count = body.elements.points.shape[1]
    assert len(whole.points) == 2 * count - 25  # 5 × 5 nodes at y = 0
    assert len(whole.cells) == 2 * len(half.cells)
    moved = whole.displacement(np.sin(np.arange(3.0 * count)))
    at = {tuple(np.round(point, 9)): u for point, u in zip(whole.points, moved, strict=True)}
    for (x, y, z), u in at.items():
        if y != 0:
            np.testing.assert_array_equal(at[x, -y, z] * [1, -1, 1], u)
    a, b, c = (whole.points[corner] for corner in whole.triangles.T)
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(2, rel=1e-12)
    both = whole.displacement(np.stack([np.sin(np.arange(3.0 * count)), np.ones(3 * count)], axis=1))
    np.testing.assert_array_equal(both[0], moved)


def test_modes_of_a_solid_are_drawn_with_their_beam(tmp_path: Path) -> None:
    """The largest displacement of each mode is 1 m, and the line is the mean of the sections to the same scale."""
    scene = parse(TEXT).scene_of("solid")
    table = mode_table(scene, 3)
    write_shapes(table, tmp_path / "a.vtu")
    read = meshio.read(tmp_path / "a.vtu")
    assert [name[:7] for name in read.point_data] == ["mode 01", "mode 02", "mode 03"]
    for moved in read.point_data.values():
        assert np.linalg.norm(moved, axis=1).max() == pytest.approx(1, rel=1e-12)
    write_shapes(table, tmp_path / "b.pvd")
    line, body = (meshio.read(tmp_path / "b" / f"{name}_0000.vtu") for name in ("beam", "solid_beam"))
    np.testing.assert_array_equal(body.point_data["displacement"], next(iter(read.point_data.values())))
    tip = body.point_data["displacement"][np.isclose(body.points[:, 0], 0.1), 2].mean()
    assert line.point_data["displacement"][-1, 2] == pytest.approx(tip, rel=1e-3)
    assert mode_table(parse(TEXT).scene, 1).bodies == {}


def test_the_bodies_of_a_system_move_as_its_outputs_do() -> None:
    """Sensor and section means by modal coordinates, from the nodes and from the rows of the reduced system."""
    case = parse(TEXT)
    system, _, shapes = solid_system(case.scene_of("solid"), case.fidelities["solid"])
    np.testing.assert_allclose(system.omega, case.system("solid").omega, rtol=1e-9)
    shape = shapes["beam"]
    node = np.flatnonzero(np.all(np.isclose(shape.points, (0.1, 0.0, 0.002)), axis=1))
    moved = shape.displacement(np.eye(2))[:, node[0], 2]
    np.testing.assert_allclose(moved, system.output("tip"), rtol=1e-9)


def test_a_motion_of_a_solid_is_that_of_its_beam_line(tmp_path: Path) -> None:
    """Nodes of the tip's section move by the line's deflection, and as fast; cells, stops and line are pieces."""
    loop = '[show.loop]\nkind = "vtu"\nfrequency = 240.0\nframes = 8\nfidelities = ["solid"]\n'
    result = vibeam.run(parse(TEXT + loop))
    (sheet,) = result.shown["loop"]
    steps = steps_of([sheet])
    assert sorted(steps[0][1]) == ["beam", "solid beam", "stop"]
    size = np.abs(sheet["beam_deflection"]).max()
    for _, pieces in steps:
        line, body = pieces["beam"], pieces["solid beam"]
        tip = np.isclose(body.points[:, 0], 0.1)
        for what in ("displacement", "velocity"):
            mean = (body.data[what][tip, 2].max() + body.data[what][tip, 2].min()) / 2
            scale = np.abs(sheet["beam_deflection" if what == "displacement" else "beam_velocity"]).max()
            assert mean == pytest.approx(line.data[what][-1, 2], abs=2e-3 * scale)
    assert size > 1e-5
    write_series(steps, tmp_path / "loop.pvd")
    read = meshio.read(tmp_path / "loop" / "solid_beam_0000.vtu")
    np.testing.assert_array_equal(read.point_data["velocity"], steps[0][1]["solid beam"].data["velocity"])


def test_a_mesh_of_ones_own_is_drawn_in_the_axes_of_its_file(tmp_path: Path) -> None:
    """Two boxes clamped at x = 0: all nodes of the file are there, the largest displacement of each mode is 1 m."""
    points, cells = nodes_of("hexahedron")
    faces = [[0, 3, 7, 4], *end_face(points, "hexahedron")[1]]
    groups = {"clamp": [np.zeros(2, int), np.array([1, 0])], "end": [np.zeros(2, int), np.array([0, 1])]}
    blocks = [("hexahedron", np.array(cells)), ("quad", np.array(faces))]
    meshio.Mesh(points, blocks, cell_data=groups).write(tmp_path / "rig.vtu")
    steel = GroupMaterial(youngs_modulus=210e9, density=7850.0, poissons_ratio=0.3)
    plan = OwnMesh(file="rig.vtu", unit=1e-3, materials=(steel,), clamp=("clamp",), contact=SurfaceMotion("end"))
    given, faults = own_structure(plan, tmp_path)
    assert given is not None, faults
    table = mode_table(GivenScene(given, Stop(1e-4, 0.6), Base()), 2)
    assert list(table.bodies) == ["mesh"]
    write_shapes(table, tmp_path / "modes.pvd")
    read = meshio.read(tmp_path / "modes" / "solid_mesh_0000.vtu")
    for point in points:
        assert np.min(np.linalg.norm(read.points - 1e-3 * point, axis=1)) < 1e-15
    moved = np.linalg.norm(read.point_data["displacement"], axis=1)
    assert moved.max() == pytest.approx(1, rel=1e-12)
    assert moved[np.isclose(read.points[:, 0], 0)].max() == 0


def test_an_opposite_body_stands_off_by_the_gap() -> None:
    opposite = "[opposite]\nposition = 0.06\nlength = 0.06\nwidth = 0.02\nthickness = 0.002\n"
    scene = parse(TEXT + opposite).scene_of("solid")
    shapes = solid_shapes(scene)
    assert shapes["opposite"].points[:, 2].min() == pytest.approx(shapes["beam"].points[:, 2].max() + 1e-4)
    with pytest.raises(ValueError, match="no solid to draw"):
        solid_shapes(replace(parse(TEXT).scene))


def test_the_command_writes_the_modes_of_the_fidelity_that_is_named(tmp_path: Path) -> None:
    case, runner = tmp_path / "case.toml", CliRunner()
    case.write_text(TEXT, encoding="utf-8")
    asked = ["modes", str(case), "--fidelity", "solid", "--count", "2", "--out", str(tmp_path / "a.vtu")]
    said = runner.invoke(app, asked)
    assert said.exit_code == 0, said.output
    assert meshio.read(tmp_path / "a.vtu").cells[0].type == "hexahedron27"
    said = runner.invoke(app, ["modes", str(case), "--fidelity", "nothing"])
    assert said.exit_code == 2
    assert "--fidelity nothing: no such fidelity" in said.output


def test_modes_of_a_beam_import_nothing_of_solids() -> None:
    code = "import sys, vibeam; vibeam.modes('cases/dtu_neutral.toml', 2); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "vibeam.studies.modes" in done.stdout.split()
    assert "solid_shape" not in done.stdout
