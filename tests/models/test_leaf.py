"""A leaf spring with its mass on the opposite beam, against closed forms and an assembly of its own in numpy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from tests.models.bench import POINT_MASS, STEEL, deflection, with_effects
from vibeam_models.beam import assemble
from vibeam_models.effects.leaf import Leaf
from vibeam_models.effects.masses import AddedMass
from vibeam_models.effects.opposite import Opposite

BARE = replace(POINT_MASS, mass=None)
EI = STEEL.bending_stiffness
LENGTH, WIDTH, THICKNESS, MASS = 0.04, 0.012, 0.6e-3, 2.3e-3
LEAF = Leaf(LENGTH, WIDTH, THICKNESS, MASS)
LEAF_EI = 210e9 * WIDTH * THICKNESS**3 / 12


def flexibility(structure) -> float:
    return float(structure.contact @ np.linalg.solve(structure.K, structure.contact))


@pytest.mark.parametrize("arm", [LENGTH, 0.031])
def test_the_leafs_flexibility_adds_to_that_of_an_arm(arm: float) -> None:
    """a³/3EI more than on a rigid arm: massless limit and statics are those of a spring, 3EI/l³ at the tip."""
    rigid = assemble(with_effects(BARE, Opposite(0.12, arm)))
    sprung = assemble(with_effects(BARE, Opposite(0.12, arm), LEAF))
    x = 0.12
    beams = float(deflection(STEEL, 0.132, 0.132)) + (x**3 / 3 + x**2 * arm + x * arm**2) / EI
    assert flexibility(sprung) == pytest.approx(beams + arm**3 / (3 * LEAF_EI), rel=1e-7)
    assert flexibility(sprung) - flexibility(rigid) == pytest.approx(arm**3 / (3 * LEAF_EI), rel=1e-7)


def test_on_a_rigid_beam_it_has_the_frequencies_of_a_cantilever() -> None:
    """3.51602, 22.0345 and 61.6972 √(EI/ml³)."""
    stiff = assemble(
        with_effects(BARE, Opposite(0.132, LENGTH, youngs_modulus=210e17), replace(LEAF, youngs_modulus=210e9))
    )
    own = np.array([3.5160153, 22.0344916, 61.6972144]) * np.sqrt(LEAF_EI / (MASS * LENGTH**3))
    found = stiff.modes(40).omega
    for each, accuracy in zip(own, (1e-6, 1e-5, 1e-5), strict=True):
        assert np.abs(found / each - 1).min() < accuracy


def test_a_leaf_without_mass_is_the_spring_that_it_was() -> None:
    light = assemble(with_effects(BARE, Opposite(0.12, LENGTH), replace(LEAF, mass=1e-9)))
    without = assemble(with_effects(BARE, Opposite(0.12, LENGTH)))
    assert light.modes(6).omega == pytest.approx(without.modes(6).omega, rel=1e-5)
    loads = [np.abs(each.load @ each.modes(6).shapes) for each in (light, without)]
    assert loads[0] == pytest.approx(loads[1], rel=1e-3)


def beam_matrices(length: float, bending: float, per_length: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """M and K (2n + 2, 2n + 2) of n equal Hermite elements, from a table of any textbook."""
    h, size = length / count, 2 * count + 2
    M, K, turn = np.zeros((size, size)), np.zeros((size, size)), np.diag([1.0, h, 1.0, h])
    m = [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
    k = [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]
    m, k = turn @ m @ turn * per_length * h / 420, turn @ k @ turn * bending / h**3
    for i in range(count):
        at = slice(2 * i, 2 * i + 4)
        M[at, at] += m
        K[at, at] += k
    return M, K


def test_the_three_beams_are_those_assembled_in_numpy() -> None:
    """Modes, their shares of the contact's mobility and of the base's load, of other meshes: to 1e-5."""
    at, arm, tip = 0.12, 0.03, 3e-3
    structure = assemble(with_effects(BARE, Opposite(at, arm), LEAF, AddedMass(tip, STEEL.length, on="opposite")))
    one, other = (beam_matrices(STEEL.length, EI, STEEL.mass_per_length, 90) for _ in range(2))
    leaf = beam_matrices(LENGTH, LEAF_EI, MASS / LENGTH, 40)
    sizes = [182, 182, 82]
    starts = np.cumsum([0, *sizes])
    M, K = np.zeros((446, 446)), np.zeros((446, 446))
    for (mass, stiffness), start, size in zip((one, other, leaf), starts, sizes, strict=False):
        M[start : start + size, start : start + size], K[start : start + size, start : start + size] = mass, stiffness
    M[starts[2] - 2, starts[2] - 2] += tip
    clamping = starts[1] + 2 * 60  # 120 mm of 180 mm on 90 elements
    basis = np.eye(446)
    basis[starts[2], clamping] = basis[starts[2] + 1, clamping + 1] = 1.0
    basis = np.delete(basis, [0, 1, starts[1], starts[1] + 1, starts[2], starts[2] + 1], axis=1)
    contact, moved = np.zeros(446), np.zeros(446)
    contact[2 * 66], contact[starts[2] + 2 * 30] = 1.0, -1.0  # 132 mm; 30 mm of 40 mm on 40 elements
    moved[::2] = 1.0
    squared, shapes = eigh(basis.T @ K @ basis, basis.T @ M @ basis, subset_by_index=(0, 7))
    modes = structure.modes(8)
    assert modes.omega == pytest.approx(np.sqrt(squared), rel=1e-5)
    theirs = np.abs(contact @ basis @ shapes), np.abs(moved @ M @ basis @ shapes)
    ours = np.abs(structure.contact @ modes.shapes), np.abs(structure.load @ modes.shapes)
    for mine, independent in zip(ours, theirs, strict=True):
        assert mine == pytest.approx(independent, rel=1e-3, abs=1e-4 * independent.max())


def test_its_mass_is_weighed_and_its_clamping_moves_with_the_beam() -> None:
    scene = with_effects(BARE, Opposite(0.12, LENGTH), LEAF)
    assert scene.moving_mass == pytest.approx(2 * STEEL.mass_per_length * STEEL.length + MASS, rel=1e-14)
    structure = assemble(scene)
    count = assemble(BARE).size
    assert not structure.outputs["sensor"][count:].any()
    assert np.array_equal(structure.contact[count:], -structure.outputs["opposite"][count:])
    total = structure.load @ np.linalg.solve(structure.M, structure.load)  # rᵀMr less what stands in the clamps
    assert total == pytest.approx(scene.moving_mass, rel=0.02)
