import numpy as np
from scipy.linalg import eigh

from vibeam_models.structure import natural_modes


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
