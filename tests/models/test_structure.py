import numpy as np
import pytest

from tests.models.bench import RIG
from vibeam_models.beam import assemble


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
