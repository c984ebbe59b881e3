"""Elements of a solid against what elasticity says exactly: patches, rigid motions, bending, free modes."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import skfem
from scipy.sparse.linalg import spsolve
from solid_bodies import SIDES, components, frequencies, hexahedra, matrices, on_boundary, plane, solved

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam_models.beams.stretch import Material

sys.path.insert(0, str(Path(__file__).parents[3] / "independent"))

from elastic_forms import cube_mode, sliding_box, supported_plate, torsion_constant
from parallelepiped import bending_waves, free_frequencies

NUMBERS = 210e9, 0.3, 7850.0


def distorted(mesh, share=0.25):
    """The same box with its inner nodes moved by up to ``share`` of an element, always the same way."""
    places = mesh.p.copy()
    inner = ~np.isin(np.arange(places.shape[1]), np.unique(mesh.facets[:, mesh.boundary_facets()]))
    step = share * SIDES / 2
    places[:, inner] += step[:, None] * np.random.default_rng(5).uniform(-1, 1, (3, inner.sum()))
    return type(mesh)(places, mesh.t)


def curved(mesh, second):
    """A mesh of the second order of the same topology whose nodes lie on a bent body."""
    places = second.from_mesh(mesh).doflocs.copy()
    x, y, z = places.copy()
    places[0] += 2.0 * z * y + 3 * z**2
    places[2] += 3.0 * x**2
    return second(places, mesh.t)


def of_every_kind():
    boxes = hexahedra((2, 2, 2))
    return {
        "hexahedra": boxes,
        "hexahedra, distorted": distorted(boxes),
        "hexahedra, curved": curved(boxes, skfem.MeshHex2),
        "tetrahedra": skfem.MeshTet.init_tensor(*(np.linspace(0, side, 3) for side in SIDES)),
        "tetrahedra, distorted": distorted(skfem.MeshTet.init_tensor(*(np.linspace(0, side, 3) for side in SIDES))),
        "tetrahedra, curved": curved(skfem.MeshTet.init_tensor(*(np.linspace(0, s, 3) for s in SIDES)), skfem.MeshTet2),
    }


KINDS = of_every_kind()
STRAIGHT = {name: mesh for name, mesh in KINDS.items() if "curved" not in name}


@pytest.mark.parametrize("kind", KINDS)
def test_a_patch_holds_every_constant_strain(kind):
    """Surface nodes as a linear field says, inner ones free: the field itself, to round-off, in cells of any form."""
    elements, stiff, _ = matrices(KINDS[kind])
    strain = 1e-3 * np.array([[1.0, -0.3, 0.7], [0.2, 0.5, -0.4], [-0.6, 0.8, 0.9]])
    exact = (strain @ elements.points).T.ravel()
    held = np.repeat(on_boundary(elements, KINDS[kind]), 3)
    assert not held.all()
    found = solved(stiff, held, exact)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12 * np.abs(exact).max())
    shear = 210e9 / 2.6
    symmetric = (strain + strain.T) / 2
    density = 1.5 * shear * np.trace(symmetric) ** 2 / 2 * (2 * 0.3 / 0.4) / 1.5 + shear * (symmetric**2).sum()
    assert exact @ stiff @ exact / 2 == pytest.approx(density * elements.volumes().sum(), rel=1e-11)


def bent(points, radius=1.0, ratio=0.3):
    """Pure bending about y of a bar with free sides (Timoshenko & Goodier, art. 102): quadratic in x, y, z."""
    x, y, z = points
    return np.column_stack([-x * z, ratio * y * z, (x**2 + ratio * (z**2 - y**2)) / 2]).ravel() / radius


@pytest.mark.parametrize("kind", STRAIGHT)
def test_a_patch_holds_pure_bending(kind):
    """Cells of 27 or 10 nodes with straight edges hold every quadratic field: bending bears no shear, nothing locks."""
    elements, stiff, _ = matrices(KINDS[kind])
    exact = bent(elements.points)
    found = solved(stiff, np.repeat(on_boundary(elements, KINDS[kind]), 3), exact)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-11 * np.abs(exact).max())


def test_curved_cells_hold_bending_to_their_order_alone():
    """The tolerance of the patch of bending can fail: curved cells do not hold quadratic fields."""
    mesh = KINDS["hexahedra, curved"]
    elements, stiff, _ = matrices(mesh)
    exact = bent(elements.points)
    found = solved(stiff, np.repeat(on_boundary(elements, mesh), 3), exact)
    error = np.abs(found - exact).max() / np.abs(exact).max()
    assert error > 1e-6
    assert error < 0.05


@pytest.mark.parametrize("thickness", [1e-1, 1e-2, 1e-3])
def test_one_element_through_a_strip_bends_exactly(thickness):
    """Ends turned, sides free: M/EI = 1/R whatever the thickness, one element of ratio 1 : 1000 through it."""
    sides = np.array([1.0, 0.1, thickness])
    elements, stiff, _ = matrices(hexahedra((2, 1, 1), sides, (0, -0.05, -thickness / 2)))
    ends = plane(elements, 0, 0.0) | plane(elements, 0, 1.0)
    exact = bent(elements.points)
    found = solved(stiff, np.repeat(ends, 3), exact)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-7)
    assert found @ stiff @ found == pytest.approx(
        210e9 * 0.1 * thickness**3 / 12,
        rel=1e-12 / thickness**3,  # round-off of the stiffness along, 1/h² larger
    )


@pytest.mark.parametrize("kind", KINDS)
def test_six_motions_without_force_and_no_more(kind):
    """K has six zero eigenvalues, its rigid motions; the seventh is a strain. Mass and inertia by those motions."""
    mesh = KINDS[kind]
    elements, stiff, mass = matrices(mesh)
    x, y, z = elements.points
    nil, one = 0 * x, np.ones_like(x)
    moves = [(one, nil, nil), (nil, one, nil), (nil, nil, one), (nil, -z, y), (z, nil, -x), (-y, x, nil)]
    moves = np.column_stack([np.column_stack(each).ravel() for each in moves])
    assert np.abs(stiff @ moves).max() < 1e-14 * np.abs(stiff).max()
    values = np.linalg.eigvalsh(stiff.toarray())
    assert np.abs(values[:6]).max() < 1e-13 * values[-1]
    assert values[6] > 1e-5 * values[-1]
    carried = moves.T @ (mass @ moves)
    volume = elements.volumes().sum()
    np.testing.assert_allclose(carried[:3, :3], 7850 * volume * np.eye(3), atol=1e-12)
    if "curved" not in kind:
        assert volume == pytest.approx(SIDES.prod(), rel=1e-13)
        a, b, c = SIDES
        inertia = 7850 * volume / 3 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
        np.testing.assert_allclose(np.diag(carried)[3:], inertia, rtol=1e-12)


def test_free_modes_of_a_cube_with_order_four():
    """Lamé's three modes in closed form, the others by Ritz: eigenvalues err with h⁴, all from above."""
    exact = free_frequencies((0.1,) * 3, *NUMBERS, 14, 18)[6:]
    assert exact[8] == pytest.approx(cube_mode(0.1, *NUMBERS), rel=1e-9)
    errors = []
    for n in (2, 4):
        _, stiff, mass = matrices(hexahedra((n, n, n), (0.1,) * 3))
        none = np.zeros(stiff.shape[0], dtype=bool)
        errors.append(frequencies(stiff, mass, none, 18, -1e8)[6:] / exact - 1)
    observed = np.log2(errors[0] / errors[1])
    assert (errors[1] > 0).all()
    assert errors[1].max() < 4e-3
    assert observed[8:11] == pytest.approx(4, abs=0.3)  # Lamé's, smooth
    assert (observed[:11] > 3).all(), observed  # the others' corners are not smooth


def test_sliding_walls_with_order_four_on_distorted_cells():
    exact, errors = sliding_box(SIDES, *NUMBERS, 3), []
    for n in (1, 2):
        mesh = hexahedra((3 * n, 3 * n, 2 * n))
        elements, stiff, mass = matrices(distorted(mesh, 0.2 / n))
        walls = [plane(elements, a, 0.0) | plane(elements, a, SIDES[a]) for a in range(3)]
        errors.append(frequencies(stiff, mass, components(*walls), 3) / exact - 1)
    assert (errors[1] > 0).all()
    assert np.max(errors[1]) < 5e-4
    assert np.median(np.log2(errors[0] / errors[1])) > 3.2


def test_a_thick_plate_on_simple_supports():
    """NAFEMS' plate of FV52, its edges held across the plate and along each edge: Lamb's waves.

    One element through it bears shear with κ = 1 in place of 0.87; two are three to fifteen times nearer.
    """
    plate = Material(200e9, 8000.0, 0.3)
    truth = [supported_plate(10, 10, 1, 200e9, 0.3, 8000, waves) for waves in ((1, 1), (1, 2), (1, 2), (2, 2))]
    errors = []
    for through in (1, 2):
        elements, stiff, mass = matrices(hexahedra((6, 6, through), (10, 10, 1)), plate)
        at = [plane(elements, axis, 0) | plane(elements, axis, 10) for axis in (0, 1)]
        middle = plane(elements, 2, 0.5)  # moves across itself alone: bending, not stretching
        held = components(at[1] | middle, at[0] | middle, at[0] | at[1])
        errors.append(frequencies(stiff, mass, held, 4) / truth - 1)
    assert (errors[1] > 0).all()
    assert np.max(errors[1]) < 7e-3
    assert errors[1][0] < 1.2e-3
    assert errors[0][0] > 3 * errors[1][0]


@pytest.mark.parametrize("width", [0.5, 4.0])
def test_a_wave_of_a_bar(width):
    """Half a wave between ends held across (pinned-pinned): the exact frequency, deep bar and plate strip."""
    truth = bending_waves(width, 1.0, 210e9, 0.3, 7850, np.pi / 5, 12)[0]
    elements, stiff, mass = matrices(hexahedra((8, 2, 2), (5.0, width / 2, 1.0), (0, 0, -0.5)))
    ends = plane(elements, 0, 0) | plane(elements, 0, 5)
    middle, symmetric = plane(elements, 2, 0), plane(elements, 1, 0)
    held = components(middle, ends | symmetric | middle, ends)  # z = 0 moves along z alone: bending across z
    assert frequencies(stiff, mass, held, 1)[0] == pytest.approx(truth, rel=1.1e-3)


def test_torsion_of_a_rectangle():
    """Ends turned about x, free to warp: twice the energy is G J/L with Saint-Venant's J, from above, to 0.1 %."""
    elements, stiff, _ = matrices(hexahedra((1, 6, 4), (0.02, 0.02, 0.01), (0, -0.01, -0.005)))
    x, y, z = elements.points
    turn = np.column_stack([0 * x, -z * x, y * x]).ravel() / 0.02
    ends = plane(elements, 0, 0) | plane(elements, 0, 0.02)
    found = solved(stiff, components(np.hypot(y, z) < 1e-9, ends, ends), turn)
    ratio = found @ stiff @ found / (210e9 / 2.6 * torsion_constant(0.02, 0.01) / 0.02) - 1
    assert 0 < ratio < 1e-3
    assert torsion_constant(0.02, 0.01) / (0.02 * 0.01 / 12 * (0.02**2 + 0.01**2)) < 0.6  # not the polar moment


def test_reciprocity_and_tension():
    """Maxwell's reciprocity of two places; a bar in tension whose end slides: F L/EA and ν F/EA across, exactly."""
    elements, stiff, _ = matrices(distorted(hexahedra((2, 2, 2))))
    held = components(
        plane(elements, 0, 0), np.hypot(*elements.points[[0, 1]]) < 1e-9, np.hypot(*elements.points[[0, 2]]) < 1e-9
    )
    kept = np.flatnonzero(~held)
    inner = stiff[kept][:, kept]
    one, two = np.eye(len(kept))[[7, 40]]
    assert spsolve(inner, one)[40] == pytest.approx(spsolve(inner, two)[7], rel=1e-9)
    force = 1e3
    strain = force / (210e9 * SIDES[1] * SIDES[2])
    exact = (np.diag([strain, -0.3 * strain, -0.3 * strain]) @ elements.points).T.ravel()
    reaction = stiff @ exact
    end = plane(elements, 0, SIDES[0])
    assert reaction.reshape(-1, 3)[end, 0].sum() == pytest.approx(force, rel=1e-11)
    assert (
        np.abs(np.delete(reaction.reshape(-1, 3), np.flatnonzero(end | plane(elements, 0, 0)), 0)).max() < 1e-8 * force
    )


def test_one_element_of_each_material():
    """Two materials side by side in tension: their strains are as their flexibilities."""
    mesh = hexahedra((2, 1, 1), (2.0, 1.0, 1.0))
    soft = Material(105e9, 1000.0, 0.0)
    hard = Material(210e9, 7850.0, 0.0)
    elements = SolidElements(mesh)
    second = (mesh.p[0][mesh.t].mean(0) > 1).astype(np.intp)
    stiff = elements.stiffness((soft, hard), second).tocsc()
    x = elements.points[0]
    held = components(plane(elements, 0, 0) | plane(elements, 0, 2), x > -1, x > -1)
    values = components(plane(elements, 0, 2), None, None) * 1.0
    found = solved(stiff, held, values).reshape(-1, 3)[:, 0]
    np.testing.assert_allclose(found, np.where(x <= 1, 2 / 3 * x, 2 / 3 + (x - 1) / 3), atol=1e-12)
    mass = elements.mass(np.array([1000.0, 7850.0])[second])
    assert mass.sum() / 3 == pytest.approx(8850.0, rel=1e-13)
