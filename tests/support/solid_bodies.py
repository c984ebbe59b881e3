"""Boxes of hexahedra, their matrices, held components and frequencies: what tests of solids share."""

from __future__ import annotations

import numpy as np
import skfem
from scipy.sparse.linalg import eigsh, spsolve

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam_models.beams.stretch import Material

STEEL = Material(210e9, 7850.0, 0.3)
SIDES = np.array([0.1, 0.08, 0.05])
#: case of a short strip with a mass, less its fidelities
RIG = """units = "SI"
[beam]
length = 0.1
width = 0.02
thickness = 0.004
youngs_modulus = 70e9
density = 2700
damping_ratio = 0.01
elements = 6
[mass]
mass = 0.02
position = 0.08
[stop]
gap = 1e-4
restitution = 0.6
[sensor]
position = 0.09
[drive]
amplitude = 1e-5
[sweep]
frequency = {from = 200, to = 300, points = 3}
settle = 10
hold = 5
[solid]
across = 2
"""


def hexahedra(counts, sides=SIDES, lower=(0.0, 0.0, 0.0)):
    lines = [np.linspace(a, a + side, n + 1) for a, side, n in zip(lower, sides, counts, strict=True)]
    return skfem.MeshHex.init_tensor(*lines)


def matrices(mesh, material=STEEL):
    elements = SolidElements(mesh)
    count = mesh.t.shape[1]
    stiff = elements.stiffness((material,), np.zeros(count, dtype=np.intp))
    return elements, stiff.tocsc(), elements.mass(np.full(count, material.density)).tocsc()


def on_boundary(elements, mesh):
    """Nodes (k,) of the field on the surface."""
    scalar = skfem.Basis(mesh, elements.element)
    found = np.zeros(elements.points.shape[1], dtype=bool)
    found[scalar.get_dofs(mesh.boundary_facets()).flatten()] = True
    return found


def solved(stiff, held, values):
    """u with the components ``held`` (n,) at their ``values`` and no force on the others."""
    u = np.where(held, values, 0.0)
    u[~held] = spsolve(stiff[~held][:, ~held], -(stiff @ u)[~held])
    return u


def frequencies(stiff, mass, held, count, shift=0.0):
    kept = np.flatnonzero(~held)
    squared = eigsh(stiff[kept][:, kept], count, mass[kept][:, kept], sigma=shift, return_eigenvectors=False)
    return np.sqrt(np.maximum(np.sort(squared), 0)) / (2 * np.pi)


def plane(elements, axis, at):
    return np.isclose(elements.points[axis], at, rtol=0, atol=1e-9)


def components(*masks):
    """(3 k,) of masks (k,) for x, y, z; None: none."""
    none = np.zeros_like(next(each for each in masks if each is not None))
    return np.column_stack([none if each is None else each for each in masks]).ravel()
