from dataclasses import replace

import numpy as np
import pytest
from refusals import other_answers
from scipy.linalg import eigh

from tests.models.bench import RIG, STEEL
from vibeam_models import structure as structures
from vibeam_models.beam import assemble
from vibeam_models.beams.beam import Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.structure import Structure, natural_modes, signs


def test_modes_are_mass_normalised_and_push_toward_the_stop():
    structure = assemble(RIG)
    modes = structure.modes()
    np.testing.assert_allclose(modes.shapes.T @ structure.M @ modes.shapes, np.eye(structure.size), atol=1e-11)
    assert np.all(structure.contact @ modes.shapes >= 0)
    assert np.all(np.diff(modes.omega) > 0)


def test_a_few_modes_are_the_first_of_all():
    structure = assemble(RIG)
    few, every = structure.modes(3), structure.modes()
    assert np.array_equal(few.omega, every.omega[:3])
    assert np.array_equal(few.shapes, every.shapes[:, :3])


def test_with_changes_what_is_named():
    structure = assemble(RIG)
    other = structure.with_(C=0 * structure.C)
    assert other.K is structure.K
    assert not np.any(other.C)
    with pytest.raises(AttributeError):
        structure.M = other.M


def test_other_damping_or_load_keeps_the_modes_and_another_contact_or_mass_does_not():
    structure = assemble(RIG)
    before = structure.modes()
    assert structure.with_(C=0 * structure.C, load=2 * structure.load).modes() is before
    heavier = structure.with_(M=4 * structure.M)
    np.testing.assert_allclose(heavier.modes(4).omega, before.omega[:4] / 2, rtol=1e-8)
    away = structure.with_(contact=-structure.contact)
    np.testing.assert_allclose(-away.contact @ away.modes(4).shapes, -structure.contact @ before.shapes[:, :4])


def test_a_structure_with_the_same_matrices_solves_no_eigenproblem_again(monkeypatch):
    solved = []
    monkeypatch.setattr(structures, "natural_modes", lambda K, M: solved.append(len(K)) or natural_modes(K, M))
    structures._modes_of.cache_clear()
    first, softer = assemble(RIG), assemble(replace(RIG, beam=replace(STEEL, damping=Damping("constant", (0.05,)))))
    assert first.modes() is not softer.modes()
    assert solved == [first.size]
    squared, shapes = natural_modes(softer.K, softer.M)  # to the bit: what is kept is what would be found
    assert np.array_equal(softer.modes().omega, np.sqrt(squared))
    assert np.array_equal(softer.modes().shapes, shapes * signs(shapes, softer.contact))
    assemble(replace(RIG, beam=replace(STEEL, shape=Rectangle(0.02, 1.035e-3))))
    assert solved == [first.size, first.size]


def test_a_change_that_does_not_fit_is_refused():
    two = Structure(np.eye(2), np.eye(2), np.eye(2), np.ones(2), np.zeros(2), np.ones(2))
    wrong = {
        "load: must be": {"load": [1.0]},
        "C: must be 3 × 3 finite numbers": {"M": np.eye(3)},
        "K: must be symmetric": {"K": np.triu(np.ones((2, 2)))},
        r"outputs\['tip'\]: must be 2 finite numbers": {"outputs": {"tip": [np.nan, 1.0]}},
    }
    assert other_answers(lambda change: two.with_(**change), wrong) == []
    with pytest.raises(TypeError, match="no field stiffness"):
        two.with_(stiffness=np.eye(2))


def test_a_mode_with_a_node_at_the_contact_is_positive_where_it_first_moves():
    """Round-off of either sign at the node decides nothing."""
    shapes = np.array([[0.5, -0.6, -0.4], [0.7, 1e-17, -0.1], [-0.5, 0.6, 0.9]])
    contact = np.array([0.0, 1.0, 0.0])
    np.testing.assert_array_equal(signs(shapes, contact), [1, -1, -1])
    np.testing.assert_array_equal(signs(shapes * [1, -1, 1], contact), [1, 1, -1])


def chain(n, free=False):
    """n unit masses in a row, unit springs between them and, unless ``free``, one to the wall."""
    stiffness = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiffness[-1, -1] = 1.0
    stiffness[0, 0] = 1.0 if free else 2.0
    return stiffness


def test_a_chain_of_springs():
    squared, shapes = natural_modes(chain(40), np.eye(40))
    exact = 4 * np.sin((2 * np.arange(1, 41) - 1) * np.pi / (2 * 81)) ** 2
    np.testing.assert_allclose(squared, exact, rtol=1e-12)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(40), atol=1e-12)


def test_a_heavy_mass_among_tiny_ones_keeps_its_first_frequency():
    """A unit mass held by 21 springs in a row: ω₁² = 1/21; solved as it stands nothing of it is left."""
    masses = np.full(40, 1e-18)
    masses[20] = 1.0
    squared, _ = natural_modes(chain(40), np.diag(masses))
    assert abs(squared[0] * 21 - 1) < 1e-12
    assert abs(eigh(chain(40), np.diag(masses), eigvals_only=True)[0] * 21 - 1) > 1e-3


def test_a_free_body_has_a_mode_of_no_frequency():
    squared, _ = natural_modes(chain(2, free=True), np.eye(2))
    np.testing.assert_allclose(squared, [0, 2], atol=1e-15)
