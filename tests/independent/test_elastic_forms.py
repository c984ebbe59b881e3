"""The second program of solids, and exact solutions: each must stand by itself before anything is judged by it."""

import ast
import sys
from math import factorial
from pathlib import Path

import numpy as np
import pytest
from elastic_forms import (
    cube_mode,
    next_order,
    shear_coefficient,
    sliding_box,
    supported_plate,
    torsion_constant,
    warping,
)
from parallelepiped import bending_waves, free_frequencies
from tetrahedra import (
    deflection,
    frequencies,
    held,
    lattice,
    matrices,
    mean_over_patch,
    points,
    rigid_motions,
    rigid_zone,
    shape_functions,
)

HERE = Path(__file__).parent
STEEL = 210e9, 0.3, 7850.0
SIDES = np.array([0.1, 0.08, 0.05])
PROGRAMS = ["elastic_forms.py", "make_solid_rigs.py", "parallelepiped.py", "solid_rigs.py", "tetrahedra.py"]


def box(counts, sides=SIDES, bend=None):
    return lattice(*(np.linspace(0, side, n + 1) for side, n in zip(sides, counts, strict=True)), bend=bend)


def orders(errors):
    return np.log2(np.asarray(errors[:-1]) / errors[1:])


@pytest.mark.parametrize("file", PROGRAMS)
def test_imports_nothing_of_what_it_judges(file):
    nodes = list(ast.walk(ast.parse((HERE / file).read_text(encoding="utf-8"))))
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    own = {each.removesuffix(".py") for each in PROGRAMS}
    assert {name.split(".")[0] for name in names} <= {"mpmath", "numpy", "scipy"} | own | set(sys.stdlib_module_names)


def test_shape_functions_are_one_at_their_node_and_give_every_quadratic():
    corners = np.vstack([np.zeros(3), np.eye(3)])
    middles = [(corners[i] + corners[j]) / 2 for i, j in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))]
    value, slope = shape_functions(np.vstack([corners, middles]))
    np.testing.assert_allclose(value, np.eye(10), atol=1e-15)
    np.testing.assert_allclose(slope.sum(1), 0, atol=1e-14)


def test_the_rule_is_exact_to_the_fifth_degree():
    """∫ x^a y^b z^c over the reference tetrahedron: a! b! c!/(a + b + c + 3)!"""
    places, weights = points()
    for a, b, c in np.ndindex(4, 3, 3):
        if a + b + c <= 5:
            exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3)
            assert weights @ np.prod(places ** [a, b, c], 1) == pytest.approx(exact, rel=1e-13)


def test_a_bent_body_bears_no_force_when_moved_as_one():
    """Rigid motions of isoparametric cells: K R = 0, and Rᵀ M R holds volume × density."""
    body = box(
        (3, 2, 2), bend=lambda p: p + 0.1 * np.column_stack([p[:, 1] ** 2, p[:, 2] * p[:, 0], p[:, 0] * p[:, 1]])
    )
    stiff, _ = matrices(body, *STEEL)
    move = rigid_motions(body.nodes)
    assert np.abs(stiff @ move).max() < 1e-14 * np.abs(stiff).max()
    straight = matrices(box((3, 2, 2)), *STEEL)[1]
    straight_move = rigid_motions(box((3, 2, 2)).nodes)
    assert (straight_move.T @ (straight @ straight_move))[0, 0] == pytest.approx(7850 * SIDES.prod(), rel=1e-13)
    with pytest.raises(ArithmeticError, match="inside out"):
        matrices(box((1, 1, 1), bend=folded), *STEEL)


def folded(places):
    """One corner pushed through the opposite face."""
    return places + (places == [0, 0, 0]).all(1)[:, None] * [0.3, 0, 0]


def test_sliding_faces_to_the_fourth_order():
    """A box between walls without friction, in closed form: eigenvalues by quadratic cells err with h⁴."""
    exact, errors = sliding_box(SIDES, *STEEL, 1)[0], []
    for n in (2, 3):
        body = box((2 * n, 2 * n, n))
        stiff, mass = matrices(body, *STEEL)
        walls = [(np.isclose(body.nodes[:, a], 0) | np.isclose(body.nodes[:, a], SIDES[a]), (a,)) for a in range(3)]
        free = held(body, *walls)
        errors.append(frequencies(free.T @ stiff @ free, free.T @ mass @ free, 1)[0][0] / exact - 1)
    assert 0 < errors[1] < 1e-3
    assert np.log(errors[0] / errors[1]) / np.log(3 / 2) == pytest.approx(4, abs=0.4)


def test_lames_modes_of_a_free_cube_by_ritz():
    """Three of the cube's modes are known exactly; Ritz' values meet them from above."""
    found = free_frequencies((0.1,) * 3, *STEEL, 14, 18)
    exact = cube_mode(0.1, *STEEL)
    assert np.max(found[:6]) < 1
    np.testing.assert_allclose(found[14:17], exact, rtol=1e-10)
    coarse = free_frequencies((0.1,) * 3, *STEEL, 6, 18)
    assert (coarse[6:] >= found[6:] * (1 - 1e-12)).all()
    assert coarse[14] / exact - 1 > 1e-5


def test_a_free_body_by_ritz_and_by_tetrahedra():
    sides = np.array([0.1, 0.07, 0.03])
    truth = free_frequencies(sides, *STEEL, 14, 12)[6:]
    errors = []
    for n in (1, 2):
        stiff, mass = matrices(box((3 * n, 2 * n, n), sides), *STEEL)
        errors.append(frequencies(stiff, mass, 12, -1e6)[0][6:] / truth - 1)
    assert (errors[1] > 0).all()
    assert errors[1].max() < 0.025
    assert (orders(errors) > 2).all()


def test_a_supported_plate_is_lambs_wave():
    """Thin: Kirchhoff's plate. Thick: cells of a plate whose edges are held in their plane come to it from above."""
    thin = supported_plate(1.0, 2.0, 1e-3, *STEEL, (1, 1))
    kirchhoff = np.pi / 2 * (1 + 1 / 4) * 1e-3 * np.sqrt(210e9 / (12 * 7850 * (1 - 0.09)))
    assert thin == pytest.approx(kirchhoff, rel=1e-5)
    body = box((6, 6, 1), (10, 10, 1))
    stiff, mass = matrices(body, *STEEL)
    at = [np.isclose(body.nodes[:, a], 0) | np.isclose(body.nodes[:, a], 10) for a in (0, 1)]
    free = held(body, (at[0] | at[1], (2,)), (at[0], (1,)), (at[1], (0,)))
    assert frequencies(free.T @ stiff @ free, free.T @ mass @ free, 1)[0][0] == pytest.approx(
        supported_plate(10, 10, 1, *STEEL, (1, 1)), rel=0.025
    )


def test_torsion_of_a_rectangle():
    """Saint-Venant's series: φ is harmonic and meets its edge; J as cells of a twisted bar say, ends free to warp."""
    width, height, h = 0.02, 0.01, 1e-5
    y, z = np.array([0.003, 0.009]), np.array([0.002, -0.004])
    around = sum(warping(y + a * h, z + b * h, width, height) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1)))
    assert np.abs(around - 4 * warping(y, z, width, height)).max() < 1e-3 * h**2
    edge = (
        warping(np.array([width / 2]), z[:1], width, height, 4000) - warping([width / 2 - h], z[:1], width, height)
    ) / h
    assert edge == pytest.approx(z[0], rel=0.05)
    assert torsion_constant(1, 1) == pytest.approx(0.1405770, abs=1e-7)
    assert torsion_constant(1, 1e3) == pytest.approx(1e3 / 3, rel=1e-3)
    bar = lattice(np.linspace(0, 0.02, 3), np.linspace(-0.01, 0.01, 7), np.linspace(-0.005, 0.005, 5))
    stiff, _ = matrices(bar, *STEEL)
    ends = np.isclose(bar.nodes[:, 0] % 0.02, 0) | np.isclose(bar.nodes[:, 0], 0.02)
    turn = rigid_motions(bar.nodes)[:, 3] * np.repeat(bar.nodes[:, 0] / 0.02, 3)
    free = held(bar, (ends, (1, 2)), (np.isclose(np.abs(bar.nodes).sum(1), 0), (0,)))
    moved = turn + free @ deflection(free.T @ stiff @ free, -free.T @ (stiff @ turn))
    energy = 210e9 / 2.6 * torsion_constant(width, height) / 0.02
    assert moved @ (stiff @ moved) == pytest.approx(energy, rel=4e-3)
    assert moved @ (stiff @ moved) > energy


@pytest.mark.parametrize(("width", "poisson"), [(0.5, 0.3), (2.0, 0.3), (1.0, 0.0), (3.0, 0.4)])
def test_the_next_order_of_bending(width, poisson):
    """Waves of an endless bar: ω² = EI k⁴/ρA (1 − c k²h² + O(k⁴h⁴)), c by κ of the exact equations, to 10⁻³.

    From k h = 0.4 and 0.2, the next term taken out. κ = 5/6 would be 2 % off at width 2 and 14 % at width 3.
    """
    coefficients = []
    for k_h in (0.4, 0.2):
        omega = 2 * np.pi * bending_waves(width, 1.0, 1.0, poisson, 1.0, k_h, 10)[0]
        coefficients.append((1 - omega**2 * 12 / k_h**4) / k_h**2)
    assert (4 * coefficients[1] - coefficients[0]) / 3 == pytest.approx(next_order(width, 1.0, poisson), rel=2e-3)
    assert shear_coefficient(1e-3, 1.0, poisson) == pytest.approx(5 * (1 + poisson) / (6 + 5 * poisson), rel=1e-5)


def test_a_wave_of_a_bar_by_tetrahedra():
    """Half a wave between ends held across: cells come to the exact frequency from above, with h⁴."""
    truth, errors = bending_waves(0.5, 1.0, 1.0, 0.3, 1.0, np.pi / 4)[0], []
    for n in (1, 2):
        bar = lattice(
            np.linspace(0, 4, 6 * n + 1), np.linspace(-0.25, 0.25, 2 * n + 1), np.linspace(-0.5, 0.5, 2 * n + 1)
        )
        stiff, mass = matrices(bar, 1.0, 0.3, 1.0)
        x, y, z = bar.nodes.T
        ends = np.isclose(x, 0) | np.isclose(x, 4)
        free = held(bar, (ends, (1, 2)), (np.isclose(y, 0), (1,)), (np.isclose(z, 0), (0, 1)))
        errors.append(frequencies(free.T @ stiff @ free, free.T @ mass @ free, 1)[0][0] / truth - 1)
    assert 0 < errors[1] < 5e-4
    assert orders(errors)[0] > 3.4


def test_a_rigid_zone_carries_its_mass_and_a_patch_its_mean():
    """A block that is one zone: mass and inertia of both as one; a patch's row gives 1 for a motion along it."""
    body = lattice(np.linspace(-0.05, 0.05, 3), np.linspace(-0.04, 0.04, 2), np.linspace(-0.025, 0.025, 2))
    mask = np.ones(len(body.nodes), bool)
    tied, extra = rigid_zone(body, mask, (0, 0, 0), 2.0, (0.1, 0.2, 0.3))
    whole = (tied.T @ matrices(body, *STEEL)[1] @ tied).toarray() + extra
    own = 7850 * SIDES.prod()
    inertia = np.array([0.1, 0.2, 0.3]) + own / 12 * np.array([0.08**2 + 0.05**2, 0.1**2 + 0.05**2, 0.1**2 + 0.08**2])
    np.testing.assert_allclose(whole, np.diag([*[own + 2] * 3, *inertia]), atol=1e-14)
    row = mean_over_patch(body, np.isclose(body.nodes[:, 2], 0.025), (0, 0, 1))
    np.testing.assert_allclose(row @ rigid_motions(body.nodes), [0, 0, 1, 0, 0, 0], atol=1e-16)
    assert row @ np.column_stack([0 * mask, 0 * mask, body.nodes[:, 0] ** 2]).ravel() == pytest.approx(0.1**2 / 12)
