"""Numbers that the solids of ``cases/solid`` state, beside the second program: fine tetrahedra of the same bodies."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sparse
from tetrahedra import frequencies, held, lattice, matrices, mean_over_patch, rigid_zone

import vibeam

CASES = Path(__file__).parents[2] / "cases" / "solid"


def planes(size, *marks):
    pieces = [np.linspace(a, b, int(np.ceil((b - a) / size)) + 1) for a, b in pairwise(marks)]
    return np.unique(np.round(np.concatenate(pieces), 12))


def clamped(mesh, stiff, mass):
    """K and M of a body that is held at x = 0."""
    free = held(mesh, (mesh.nodes[:, 0] == 0, (0, 1, 2)))
    return (free.T @ stiff @ free).tocsc(), (free.T @ mass @ free).tocsc()


def carrying(mesh, mass, at, kilograms):
    """M with a mass on the mean displacement of the section at ``at`` m."""
    on = np.isclose(mesh.nodes[:, 0], at) & (np.abs(mesh.nodes[:, 2]) < np.abs(mesh.nodes[0, 2]) + 1e-9)
    rows = [sparse.csc_matrix(mean_over_patch(mesh, on, direction)[:, None]) for direction in np.eye(3)]
    return mass + kilograms * sum(row @ row.T for row in rows)


def block(length, side, at, size):
    across = planes(size[1], -side / 2, side / 2)
    mesh = lattice(planes(size[0], 0, at, length), across, across)
    stiff, mass = matrices(mesh, 210e9, 0.3, 7850.0)
    return frequencies(*clamped(mesh, stiff, carrying(mesh, mass, at, 1.0)), 8)[0]


def dtu():
    """The strip with its rigid zone, whole: lateral bending and twist among its modes."""
    zone, inertia = (0.132 - 0.0117, 0.132 + 0.0117), 2.988e-5
    mesh = lattice(planes(0.0026, 0, *zone, 0.18), planes(0.0034, -0.01, 0.01), planes(0.0012, -0.517e-3, 0.517e-3))
    x = mesh.nodes[:, 0]
    mask = (x > zone[0] - 1e-9) & (x < zone[1] + 1e-9)
    stiff, mass = matrices(mesh, 210e9, 0.3, 7850.0)
    tied, extra = rigid_zone(mesh, mask, (0.132, 0, 0), 0.2, (inertia,) * 3)
    size = tied.shape[1] - 6
    mass = tied.T @ mass @ tied + sparse.block_diag([sparse.csc_matrix((size, size)), sparse.csc_matrix(extra)])
    kept = np.flatnonzero(np.append(np.repeat(x[~mask] > 0, 3), np.ones(6, bool)))
    return frequencies(*((each.tocsc())[kept][:, kept] for each in (tied.T @ stiff @ tied, mass)), 5)[0]


def stuttgart():
    mesh = lattice(
        planes(0.01, 0, 0.29, 0.33, 0.381, 0.3925),
        planes(0.01, -0.03, -0.02, 0.02, 0.03),
        [-0.003, 0, 0.003, 0.004],
        lambda x, y, z: (z < 0.003) | ((x > 0.29) & (x < 0.33) & (np.abs(y) < 0.02)),
    )
    density = np.where(mesh.middles[:, 2] > 0.003, 0.0427 / (0.04 * 0.04 * 0.001), 7720.0)
    stiff, mass = matrices(mesh, 210e9, 0.3, density)
    return frequencies(*clamped(mesh, stiff, carrying(mesh, mass, 0.381, 0.0133)), 6)[0]


RIGS = {
    "ratio_3": (lambda: block(0.09, 0.03, 0.08, (0.006, 0.006)), 3),
    "slender": (lambda: block(0.5, 0.01, 0.48, (0.006, 0.0034)), 3),
    "dtu": (dtu, 2),
    "stuttgart_left": (stuttgart, 4),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", RIGS)
def test_tetrahedra_give_the_natural_frequencies_of_a_case(name):
    """Each mode of the case among the tetrahedra's, to 0.4 %: these are too stiff, thin strips of one layer most."""
    truth, count = RIGS[name][0](), RIGS[name][1]
    found = vibeam.load(CASES / f"{name}.toml").system("solid").omega[:count] / (2 * np.pi)
    nearest = np.array([truth[np.argmin(np.abs(truth / each - 1))] for each in found])
    np.testing.assert_allclose(found, nearest, rtol=4e-3)
