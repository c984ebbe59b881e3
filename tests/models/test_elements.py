import numpy as np

from vibeam_models.elements import hermite_elements

NODES = np.array([0.0, 0.01, 0.025, 0.03, 0.06, 0.1])

SECTIONS = np.array([2.0, 1.0, 5.0, 3.0, 0.5])


def closed_form(lengths, stiffness, per_length):
    """Sum of the textbook's element matrices."""
    K, M = (np.zeros((2 * len(lengths) + 2, 2 * len(lengths) + 2)) for _ in range(2))
    for e, (h, EI, rA) in enumerate(zip(lengths, stiffness, per_length, strict=True)):
        here = slice(2 * e, 2 * e + 4)
        K[here, here] += (
            EI / h**3
            * np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                        [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])
        )  # fmt: skip
        M[here, here] += (
            rA * h / 420
            * np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                        [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])
        )  # fmt: skip
    return K, M


def test_elements_with_sections_of_their_own():
    K, M = closed_form(np.diff(NODES), SECTIONS, 1 / SECTIONS)
    elements = hermite_elements(NODES)
    np.testing.assert_allclose(elements.stiffness(SECTIONS[:, None]), K, atol=1e-11 * np.max(K))
    np.testing.assert_allclose(elements.mass(1 / SECTIONS[:, None]), M, atol=1e-11 * np.max(M))


def test_one_section_is_the_same_for_every_element():
    elements = hermite_elements(NODES)
    assert np.array_equal(elements.stiffness(3.0), elements.stiffness(np.full((5, 1), 3.0)))


def test_a_mesh_is_made_ready_once():
    assert hermite_elements(NODES) is hermite_elements(NODES.copy())
    assert hermite_elements(NODES[:-1]) is not hermite_elements(NODES)


def test_rows_read_what_scikit_fem_probes():
    elements, x = hermite_elements(NODES), np.array([0.0, 0.004, 0.03, 0.0999, 0.1])
    assert np.array_equal(elements.rows(x, 0), elements.basis.probes(x[None]).toarray())
