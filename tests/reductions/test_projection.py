import numpy as np
import pytest
from refusals import answers, other_answers
from scipy.linalg import null_space

from tests.models.bench import RIG
from vibeam_models.beam import assemble
from vibeam_reductions.modes import full, modal
from vibeam_reductions.projection import projection
from vibeam_reductions.static_shapes import static_mode


@pytest.fixture(scope="module")
def rig():
    return assemble(RIG)


def test_every_array_is_projected(rig):
    basis = np.random.default_rng(1).normal(size=(rig.size, 3))
    small, x = projection(rig, basis).structure, np.array([0.3, -1.0, 2.0])
    y = basis @ x
    assert x @ small.M @ x == pytest.approx(y @ rig.M @ y)
    assert x @ small.C @ x == pytest.approx(y @ rig.C @ y)
    assert x @ small.K @ x == pytest.approx(y @ rig.K @ y)
    assert small.load @ x == pytest.approx(rig.load @ y)
    assert small.contact @ x == pytest.approx(rig.contact @ y)
    assert small.outputs["tip"] @ x == pytest.approx(rig.outputs["tip"] @ y)
    assert small.units == rig.units


def test_expand_takes_one_state_or_many(rig):
    reduction = modal(rig, 3)
    np.testing.assert_array_equal(reduction.expand(np.array([0, 1.0, 0])), reduction.basis[:, 1])
    assert reduction.expand(np.ones((3, 7))).shape == (rig.size, 7)


def test_a_basis_of_the_wrong_shape_or_of_dependent_columns_is_refused(rig):
    wrong = {"basis: shape": np.ones((3, 2)), r"basis: shape \(64,\)": np.ones(64), "not independent": np.ones((64, 2))}
    assert other_answers(lambda basis: projection(rig, basis), wrong) == []


@pytest.mark.parametrize("n", [1, 2, 8])
def test_modal_coordinates_are_orthogonal_and_keep_their_frequencies(rig, n):
    basis, small = modal(rig, n).basis, modal(rig, n).structure
    np.testing.assert_allclose(basis.T @ rig.M @ basis, np.eye(n), atol=1e-11)
    np.testing.assert_allclose(basis.T @ rig.K @ basis, small.K, atol=1e-6 * small.K[0, 0])
    np.testing.assert_allclose(small.modes().omega, rig.modes(n).omega, rtol=1e-12)


def test_modes_that_are_not_there_are_refused(rig):
    assert answers(lambda n: modal(rig, n), [0, -1, 65], "has 1 to 64") == []


def test_full_keeps_every_frequency_and_the_whole_contact(rig):
    everything = full(rig)
    np.testing.assert_allclose(everything.structure.modes().omega, rig.modes().omega, rtol=1e-12)
    assert everything.flexibility_kept == pytest.approx(1, abs=1e-9)
    assert everything.mobility_kept == pytest.approx(1, abs=1e-10)


def test_static_mode_is_the_deflection_under_a_contact_force(rig):
    reduction = static_mode(rig)
    shape = reduction.expand(np.array([1.0]))
    assert rig.outputs["sensor"] @ shape == pytest.approx(1, abs=1e-12)
    force = rig.K @ shape
    np.testing.assert_allclose(force, rig.contact * (shape @ force) / (rig.contact @ shape), atol=1e-5)
    assert reduction.flexibility_kept == pytest.approx(1, abs=1e-8)


def test_static_mode_under_another_load(rig):
    tip = static_mode(rig, at=rig.outputs["tip"])
    assert tip.flexibility_kept < 1 - 1e-3
    unnamed = static_mode(rig.with_(outputs={}))
    assert unnamed.structure.contact[0] == pytest.approx(1)


def test_static_mode_where_nothing_moves(rig):
    with pytest.raises(ValueError, match="does not move"):
        static_mode(rig.with_(outputs={"sensor": 0 * rig.contact}))


def test_fewer_coordinates_never_lower_a_frequency(rig):
    """Rayleigh: the static mode bounds the first frequency from above, closely."""
    first = rig.modes(1).omega[0]
    assert 0 < static_mode(rig).structure.modes().omega[0] / first - 1 < 1e-4
    basis = np.random.default_rng(2).normal(size=(rig.size, 6))
    assert np.all(projection(rig, basis).structure.modes().omega >= rig.modes(6).omega)


def test_more_modes_keep_more_of_the_contact(rig):
    kept = [modal(rig, n) for n in (1, 2, 5, 10)]
    for share in ("flexibility_kept", "mobility_kept"):
        values = [getattr(reduction, share) for reduction in kept]
        assert np.all(np.diff(values) > 0)
        assert 0 < values[0] < values[-1] < 1


def test_mobility_kept_is_the_first_modes_share_of_the_impulse(rig):
    c = rig.contact @ rig.modes().shapes
    assert modal(rig, 1).mobility_kept == pytest.approx(c[0] ** 2 / np.sum(c**2), rel=1e-9)


def test_a_held_contact_interlaces_the_free_frequencies(rig):
    held = projection(rig, null_space(rig.contact[np.newaxis])).structure.modes(8).omega
    free = rig.modes(9).omega
    assert np.all(free[:-1] <= held * (1 + 1e-9))
    assert np.all(held <= free[1:] * (1 + 1e-9))
    assert held[0] > 5 * free[0]
