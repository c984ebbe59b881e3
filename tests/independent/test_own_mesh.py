"""A mesh of one's own, curved tetrahedra in a file of Gmsh, against the second program on the same nodes."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
import scipy.sparse as sparse
from tetrahedra import EDGES, frequencies, lattice, matrices, mean_over_patch, rigid_zone

import vibeam

GROUPS = {"clamp": 1, "top": 2, "strip": 3, "block": 4}
MATERIALS = {"strip": (210e9, 0.3, 7850.0), "block": (70e9, 0.33, 2700.0)}
CASE = """units = "SI"
[solid]
mesh = "rig.msh"
mesh_unit = "mm"
contact = { group = "top", direction = "-x" }
damping_ratio = 0.01
[[solid.material]]
group = "strip"
youngs_modulus = 210e9
density = 7850
poissons_ratio = 0.3
[[solid.material]]
group = "block"
youngs_modulus = 70e9
density = 2700
poissons_ratio = 0.33
[[solid.mass]]
group = "top"
mass = 0.02
rigid = true
[stop]
gap = 1e-4
restitution = 0.7
[drive]
amplitude = 1e-5
[sweep]
frequency = [100.0]
settle = 20
hold = 5
[fidelity.six]
reduction = "modal"
modes = 6
"""


def bent(nodes):
    """Along y, thickness along −x; the half that is clamped on an arc, with waves: cells of every form."""
    y, z, x = nodes.T
    share = np.maximum(0.03 - y, 0)
    return np.column_stack([-x - 3 * share**2 + 40 * share**2 * z, y + 30 * share**2 * z, z])


LINES = np.linspace(0, 0.06, 7), (-0.005, 0.0, 0.005), (0, 0.003, 0.008)


def body(bend=None):
    """A strip of 60 × 10 × 3 mm with a block at y = 40 … 50 mm."""
    return lattice(*LINES, lambda y, z, x: (x < 0.003) | ((y > 0.04) & (y < 0.05)), bend)


def faces(mesh, on):
    """Triangles (k, 6) whose six nodes are ``on`` (n,), middles as meshio counts them."""
    found = []
    for a, b, c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
        middles = [4 + [set(edge) for edge in EDGES].index(set(pair)) for pair in ((a, b), (b, c), (c, a))]
        found.append(mesh.cells[:, [a, b, c, *middles]])
    every = np.concatenate(found)
    return every[on[every].all(1)]


def right_handed(mesh):
    """The cells (m, 10) with a positive determinant, as files have them: where it is not, corners 0 and 1 change."""
    sides = mesh.nodes[mesh.cells[:, 1:4]] - mesh.nodes[mesh.cells[:, :1]]
    mirrored = mesh.cells[:, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]]
    return np.where(np.linalg.det(sides)[:, None] > 0, mesh.cells, mirrored)


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    straight, mesh = body(), body(bent)
    y, _, x = straight.nodes.T
    block = straight.middles[:, 2] > 0.003
    triangles = [faces(mesh, on) for on in (y == 0, x == 0.008)]
    cells = right_handed(mesh)
    parts = [*(("triangle6", each) for each in triangles), ("tetra10", cells[~block]), ("tetra10", cells[block])]
    data = [np.full(len(cells), number) for number, (_, cells) in enumerate(parts, 1)]
    folder = tmp_path_factory.mktemp("own")
    meshio.Mesh(
        mesh.nodes * 1e3,
        parts,
        cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
        field_data={name: np.array([number, 2 if number < 3 else 3]) for name, number in GROUPS.items()},
    ).write(folder / "rig.msh", file_format="gmsh22", binary=False)
    (folder / "rig.toml").write_text(CASE, encoding="utf-8")
    return vibeam.load(folder / "rig.toml")


def second():
    """Frequencies (Hz), contact's rows and loads of six modes by the second program, and all that moves in kg.

    The top moves as one with 20 g at its centre; the base moves along −x, as the contact reads.
    """
    straight, mesh = body(), body(bent)
    y, _, x = straight.nodes.T
    block = straight.middles[:, 2] > 0.003
    stiff, mass = matrices(mesh, *np.where(block[:, None], MATERIALS["block"], MATERIALS["strip"]).T)
    clamp, top = y == 0, x == 0.008
    row = mean_over_patch(mesh, top, (-1, 0, 0))
    centre = -row.reshape(-1, 3)[:, 0] @ mesh.nodes
    tied, extra = rigid_zone(mesh, top, centre, 0.02, (0, 0, 0))
    empty = tied.shape[1] - 6
    mass = tied.T @ mass @ tied + sparse.block_diag([sparse.csc_matrix((empty, empty)), sparse.csc_matrix(extra)])
    kept = np.flatnonzero(np.append(np.repeat(~clamp, 3)[np.repeat(~top, 3)], np.ones(6, bool)))
    lift = np.append(np.tile([-1.0, 0, 0], len(mesh.nodes))[np.repeat(~top, 3)], [-1.0, 0, 0, 0, 0, 0])
    stiff, inertia = ((each.tocsc())[kept][:, kept] for each in (tied.T @ stiff @ tied, mass))
    found, shapes = frequencies(stiff, inertia, 6)
    contact = (tied.T @ row)[kept] @ shapes
    return found, np.abs(contact), np.sign(contact) * ((mass @ lift)[kept] @ shapes), lift @ mass @ lift


def test_a_file_of_curved_cells_is_the_same_body_in_both_programs(case):
    """Frequencies, contact, load and mass on the same nodes: to what the eigenvalue solvers leave."""
    frequency, contact, load, mass = second()
    structure = case.scene.given.structure
    modes = structure.modes(6)
    np.testing.assert_allclose(modes.frequency, frequency, rtol=1e-7)
    np.testing.assert_allclose(structure.contact @ modes.shapes, contact, rtol=0, atol=1e-6 * contact.max())
    np.testing.assert_allclose(-structure.load @ modes.shapes, load, rtol=0, atol=1e-6 * np.abs(load).max())
    assert case.scene.given.carried == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(case.system("six").omega / (2 * np.pi), frequency, rtol=1e-7)
