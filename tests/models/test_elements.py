"""Mesh and Hermite elements of a beam: where nodes stand, the textbook's element matrices, rows."""

import numpy as np
import pytest
from refusals import answers

from vibeam_models.elements import hermite_elements
from vibeam_models.space import nodes

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


def test_a_uniform_mesh_where_nothing_is_inserted():
    np.testing.assert_allclose(nodes(0.18, 36), np.linspace(0, 0.18, 37), rtol=0, atol=1e-15)


@pytest.mark.parametrize("elements", [1, 7, 36, 101])
def test_every_inserted_position_is_a_node_and_no_element_is_needlessly_short(elements):
    inserted = [0.132, 0.1203, 0.1437]
    mesh = nodes(0.18, elements, inserted)
    assert set(inserted) <= set(mesh)
    assert (mesh[0], mesh[-1]) == (0.0, 0.18)
    assert np.min(np.diff(mesh)) >= min(0.25 * 0.18 / elements, 0.0117) * (1 - 1e-12)
    assert np.max(np.diff(mesh)) <= 1.5 * 0.18 / elements


def test_uniform_nodes_too_near_an_inserted_one_give_way():
    mesh = nodes(1.0, 10, [0.52])
    assert 0.5 not in mesh
    assert len(mesh) == 11


def test_the_same_position_twice_is_one_node():
    assert len(nodes(1.0, 4, [0.5, 0.5, 0.5 + 1e-12, 1.0])) == 5


def test_a_node_off_the_beam_and_no_elements_are_refused():
    assert answers(lambda position: nodes(1.0, 4, [position]), [-0.01, 1.01, np.nan], "no node can stand") == []
    assert answers(lambda elements: nodes(1.0, elements), [0], "at least 1") == []
