from dataclasses import replace

import numpy as np
import pytest
from refusals import other_answers

from tests.models.bench import POINT_MASS, RIG, STEEL
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping
from vibeam_models.damping import modal_ratios

KINDS = [
    Damping("constant", (0.017,)),
    Damping("stiffness", (0.017,)),
    Damping("rayleigh", (0.017, 0.02)),
    Damping("list", (0.017, 0.01, 0.03)),
]


def with_damping(damping, elements=36):
    return assemble(replace(RIG, beam=replace(STEEL, damping=damping, elements=elements)))


def modal(structure):
    modes = structure.modes()
    matrix = modes.shapes.T @ structure.C @ modes.shapes
    return matrix, np.diag(matrix) / (2 * modes.omega), modes.omega


@pytest.mark.parametrize("damping", KINDS, ids=lambda d: d.kind)
def test_the_damping_is_diagonal_in_the_modes_to_rounding(damping):
    matrix, _, _ = modal(with_damping(damping))
    off = matrix - np.diag(np.diag(matrix))
    assert np.max(np.abs(off)) < 1e-12 * np.max(matrix)


@pytest.mark.parametrize("damping", KINDS, ids=lambda d: d.kind)
def test_given_ratios_are_recovered(damping):
    _, ratios, _ = modal(with_damping(damping))
    np.testing.assert_allclose(ratios[: len(damping.ratios)], damping.ratios, rtol=1e-6)


def test_constant_and_list_go_on_to_the_last_mode():
    np.testing.assert_allclose(modal(with_damping(KINDS[0]))[1], 0.017, rtol=1e-9)
    np.testing.assert_allclose(modal(with_damping(KINDS[3]))[1][2:], 0.03, rtol=1e-9)


def test_stiffness_damping_is_proportional_to_stiffness():
    structure = with_damping(KINDS[1])
    factor = 2 * 0.017 / structure.modes(1).omega[0]
    assert np.max(np.abs(structure.C - factor * structure.K)) < 1e-9 * factor * np.max(structure.K)


def test_stiffness_damping_kills_the_second_mode():
    assert round(modal(with_damping(KINDS[1]))[1][1], 2) == 0.23


def test_rayleigh_damping_is_a_sum_of_mass_and_stiffness():
    structure = with_damping(KINDS[2])
    first, second = structure.modes(2).omega
    alpha = 2 * first * second * (0.017 * second - 0.02 * first) / (second**2 - first**2)
    beta = 2 * (0.02 * second - 0.017 * first) / (second**2 - first**2)
    expected = alpha * structure.M + beta * structure.K
    assert np.max(np.abs(structure.C - expected)) < 1e-9 * np.max(expected)
    assert np.max(np.abs(structure.C - beta * structure.K)) > 1e-9 * np.max(expected)


def test_the_ratios_are_those_of_the_whole_structure():
    """Damping comes after the effects: without the rigid zone mode 2 lies elsewhere, its ratio stays."""
    bare = POINT_MASS
    np.testing.assert_allclose(modal(assemble(bare))[1], 0.017, rtol=1e-9)


def test_faults_are_named():
    wrong = {
        "'rayleigh' takes 2": Damping("rayleigh", (0.017,)),
        "'constant' takes 1": Damping("constant", (0.017, 0.02)),
        "'list' takes 1": Damping("list", ()),
        "finite and ≥ 0": Damping("constant", (-0.1,)),
        "mode 3 negative": Damping("rayleigh", (0.5, 0.0)),
        "unknown kind": Damping("viscous", (0.1,)),
    }
    assert other_answers(lambda damping: modal_ratios(damping, np.array([1.0, 5.0, 9.0])), wrong) == []
